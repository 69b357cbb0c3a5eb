// `fovea run` on the board: loads footage and program, runs the window, gathers the figures.
#include <fmt/format.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <filesystem>

#include "model/board/board.h"
#include "model/common/host_time_slicer.h"
#include "model/video/scene/ahead.h"
#include "model/video/scene/plan_score.h"
#include "model/video/scene/quad.h"
#include "sw/fovea/board_console.h"
#include "sw/fovea/board_debug.h"
#include "sw/fovea/bus_trace_run.h"
#include "sw/fovea/camera_pictures.h"
#include "sw/fovea/command_trace.h"
#include "sw/fovea/core_semihosting.h"
#include "sw/fovea/elf_image.h"
#include "sw/fovea/exec_program.h"
#include "sw/fovea/ffmpeg.h"
#include "sw/fovea/figures.h"
#include "sw/fovea/hazard_report.h"
#include "sw/fovea/loader.h"
#include "sw/fovea/parameter_page.h"
#include "sw/fovea/perfetto/perfetto_run.h"
#include "sw/fovea/remap_time.h"
#include "sw/fovea/run_end.h"
#include "sw/fovea/run_profile.h"
#include "sw/fovea/simulation.h"
#include "sw/fovea/stall_regions.h"

namespace fovea::app {
namespace {

using Wall = std::chrono::steady_clock;

double seconds_since(Wall::time_point t) {
  return std::chrono::duration<double>(Wall::now() - t).count();
}

StatRow row(std::string name, StatBase::Value value, std::string unit, std::string sentence) {
  return {std::move(name), value, std::move(unit), std::move(sentence)};
}

double to_s(Picoseconds ps) { return static_cast<double>(ps) * 1e-12; }

// Slices only let the host look in; nothing in the model depends on where they end.
constexpr Picoseconds kSlice = 5 * kPsPerMs;

// Once the run has ended the core is let to its next instruction boundary: short slices first, long
// ones for a core that hardly runs, and an end for one that does not run at all.
constexpr unsigned kShortLooks = 20, kLooksAfterEnd = 40;
Picoseconds after_end(unsigned looks) { return looks < kShortLooks ? kPsPerUs : kSlice; }

/// The last line that has something in it.
std::string last_line(const std::string& text) {
  const std::size_t end = text.find_last_not_of("\r\n") + 1;
  const std::size_t begin = text.find_last_of("\r\n", end ? end - 1 : 0);
  return text.substr(begin == std::string::npos ? 0 : begin + 1, end - (begin == std::string::npos ? 0 : begin + 1));
}

bool kernel_stopped() { return sc_core::sc_get_status() == sc_core::SC_STOPPED; }

constexpr std::uint32_t kSdram = DDR_BASE;

/// For people, from the phases that the pins show.
std::string_view phase_name(const board::FrameLog& log) {
  switch (log.phase()) {
    case board::Phase::kReset:
    case board::Phase::kFailed: return "";
    case board::Phase::kBoot: return "boot";
    case board::Phase::kLut: return "look-up table";
    default: return log.first(board::Phase::kRemapStart) ? "frames" : "waiting for lock";
  }
}

std::string reset_text(const std::string& cause, std::size_t before) {
  std::string text = "chip reset: " + cause;
  if (before) text += fmt::format(" (after as many resets as run.resets allows: {})", before);
  return text;
}

void add_camera_stats(std::vector<StatRow>& rows,
                      const std::vector<board::CameraFrameStats>& cameras) {
  for (std::size_t n = 0; n < cameras.size(); ++n) {
    const board::CameraFrameStats& c = cameras[n];
    const std::string name = fmt::format("camera.{}.frame.", n), whose = fmt::format(" of camera {}", n);
    rows.push_back(row(name + "captured", c.captured, "1",
                       "frames captured" + whose +
                           ", from the first to the last one shown in the window: displayed, "
                           "superseded and dropped ones"));
    rows.push_back(row(name + "displayed", c.displayed, "1", "frames" + whose + " displayed"));
    rows.push_back(row(name + "superseded", c.superseded, "1",
                       "corrected frames" + whose + " that a newer frame replaced before they were shown"));
    rows.push_back(row(name + "dropped", c.dropped, "1",
                       "captured frames" + whose + " that were not corrected"));
    if (c.rate)
      rows.push_back(row(name + "rate", *c.rate, "1/s",
                         "new frames" + whose + " displayed / time, as frame.rate"));
    if (!c.displayed) continue;
    const std::string what = "from capture to display" + whose + ", as frame.latency, ";
    rows.push_back(row(name + "latency.min", to_s(c.latency_min), "s", what + "shortest"));
    rows.push_back(row(name + "latency.mean", c.latency_mean * 1e-12, "s", what + "mean"));
    rows.push_back(row(name + "latency.max", to_s(c.latency_max), "s", what + "longest"));
  }
}

/// The score of mosaics of a synthetic car park whose pictures have no marks; empty for anything else.
std::optional<video::PlanScore> plan_score(const board::BoardParams& params) {
  if (!params.firmware.view.is("birds_eye") || params.camera_count() != VIEW_CAMERAS) return std::nullopt;
  for (unsigned n = 0; n < VIEW_CAMERAS; ++n) {
    const board::CameraSetup camera = params.camera_setup(n);
    if (!camera.scene->kind.is("car_park") || camera.scene->stamp()) return std::nullopt;
  }
  const board::BirdsEyeParams& ground = params.birds_eye;
  return video::PlanScore({params.width(), params.height(), ground.width(), ground.height()}, ground.car_length(),
                          ground.car_width());
}

void add_quality(std::vector<StatRow>& rows, const video::PlanScore::Result& score) {
  const std::string what = "of the last displayed mosaic against the plan of the car park, without the car: ";
  if (std::isfinite(score.psnr_y))
    rows.push_back(row("quality.psnr_y", score.psnr_y, "dB", what + "peak signal-to-noise ratio of luma"));
  if (score.lines)
    rows.push_back(row("quality.line_error", score.line_error, "px",
                       what + "distance of the marked lines from their places, root mean square"));
  rows.push_back(row("quality.lines", score.lines, "1", what + "rows of lines that were found"));
  rows.push_back(row("quality.lines_missed", score.missed, "1", what + "rows of lines that were not"));
}

class BoardSimulation : public Simulation {
 public:
  void declare(ParamSet& set) override { params_.declare(set); }
  std::vector<std::pair<std::string, std::filesystem::path>> input_files() const override {
    return {{params_.firmware.elf.key(), program_file(params_)}};
  }
  RunResult run(const RunRequest& request) override;

 private:
  void open_window();
  void close_window();
  void collect_all(std::vector<StatRow>& rows);
  void add_frame_stats(std::vector<StatRow>& rows) const;
  void add_host(RunResult& result, bool strict) const;
  std::string failure_text(const std::string& what) const;
  std::string reset_note(const board::ChipReset& reset, std::size_t before) const;
  cpu::Counts collect_core(RunResult& result) const;
  void collect_profile(RunResult& result, const cpu::Counts& end, const RunRequest& request,
                       const ElfImage& program);
  std::string ended_text(const RunEnd::Met& met) const;
  SemihostingSettings semihosting_settings(const RunRequest& request) const;
  std::optional<ElfImage> loader_of(const ElfImage& program, const RunRequest& request) const;
  void load_loader(const ElfImage& loader, const ElfImage& program, const RunRequest& request);
  void load_page(const ElfImage& program, std::vector<std::uint8_t> page);
  ExecMap hosted_map() const;

  board::BoardParams params_;
  std::unique_ptr<board::Board> board_;
  Symbols symbols_;
  std::unique_ptr<BusTraceRun> trace_;
  std::unique_ptr<CommandTrace> commands_;
  std::unique_ptr<PerfettoRun> perfetto_;
  std::unique_ptr<RemapTime> remaps_;
  std::optional<video::PlanScore> score_;
  video::Picture mosaic_;  ///< the last one that was displayed, if there is a score
  std::vector<LatencyRow> latency_;
  std::unique_ptr<RunProfile> profile_;
  std::vector<StatRow> stats_;
  std::vector<FrameRow> frames_;
  Wall::time_point started_, window_wall_;
  double window_wall_s_ = 0;
  std::uint64_t window_instructions_ = 0, direct_at_open_ = 0, queued_at_open_ = 0;
  std::uint64_t direct_ = 0, queued_ = 0;
  bool opened_ = false, closed_ = false;
  std::optional<cpu::Counts> asleep_at_end_;  // of a core that may not wake up any more
};

void BoardSimulation::open_window() {
  auto& soc = board_->dm365;
  opened_ = true;
  board_->platform.each_statistics([](StatGroup& group) { group.reset(); });
  soc.arm.core().mark_window(kernel_time());
  if (profile_) profile_->window(true);
  if (trace_) trace_->open();
  if (perfetto_) perfetto_->window_opened();
  if (commands_) commands_->begin(soc.ddr.controller(), kernel_time());
  window_wall_ = Wall::now();
  direct_at_open_ = soc.scr.memory().decided_ahead();
  queued_at_open_ = soc.scr.memory().decided_at_present();
}

void BoardSimulation::close_window() {
  if (closed_) return;
  closed_ = true;
  auto& soc = board_->dm365;
  if (trace_) trace_->close();
  if (commands_) commands_->end();
  if (perfetto_) perfetto_->window_closed();
  window_wall_s_ = seconds_since(window_wall_);
  direct_ = soc.scr.memory().decided_ahead() - direct_at_open_;
  queued_ = soc.scr.memory().decided_at_present() - queued_at_open_;
  board_->platform.each_statistics([this](const StatGroup& group) { collect(group, stats_); });
  for (std::size_t i = 0; i < kStatCount; ++i)
    add_latency_rows(latency_, std::string(kStatNames[i]), *soc.scr.latency[i]);
  // The SDRAM's data bus: clocks with data over clocks of the window.
  const auto from = board_->window_start(), to = board_->window_end();
  if (from && to && *to > *from) {
    const mem::DdrController& ddr = soc.ddr.controller();
    add_ddr_shares(stats_,
                   {ddr.busy_clocks(), ddr.stats.queued_clocks.count(),
                    to_s(*to - *from) * ddr.ddr_clock().frequency().hertz()},
                   "the window");
  }
  soc.arm.core().mark_window(kernel_time());
  if (profile_) profile_->window(false);
  if (soc.arm.asleep()) asleep_at_end_ = soc.arm.core().counts_asleep(kernel_time());
}

void BoardSimulation::add_frame_stats(std::vector<StatRow>& rows) const {
  const board::FrameStats f = board_->frame_stats();
  if (f.rate)
    rows.push_back(row("frame.rate", *f.rate, "1/s",
                       "new frames displayed / time, over the whole display frames in the window"));
  rows.push_back(row("frame.window", f.window, "s", "length of the measured window"));
  rows.push_back(row("frame.captured", f.captured, "1", "complete frames captured in the window"));
  rows.push_back(row("frame.remapped", f.remapped, "1", "frames corrected (remap finished) in the window"));
  rows.push_back(row("frame.displayed", f.displayed, "1", "frames displayed in the window"));
  rows.push_back(row("frame.dropped", f.dropped, "1", "captured frames that were never displayed"));
  rows.push_back(row("frame.repeated", f.repeated, "1", "displayed frames that show a camera frame again"));
  if (f.latencies) {
    const std::string what = "time from a frame's first captured sample to its first displayed sample, ";
    rows.push_back(row("frame.latency.min", to_s(f.latency_min), "s", what + "shortest"));
    rows.push_back(row("frame.latency.mean", f.latency_mean * 1e-12, "s", what + "mean"));
    rows.push_back(row("frame.latency.max", to_s(f.latency_max), "s", what + "longest"));
  }
  if (f.remaps) {
    rows.push_back(row("frame.remap_rate", f.remap_rate, "1/s",
                       "remaps that ended in the window / its length; with firmware.repeat above 1 what the "
                       "remap loop manages without waiting for the camera"));
    add_remap_times(rows, to_s(f.remap_min), f.remap_mean * 1e-12, to_s(f.remap_max));
  }
  const auto cameras = board_->camera_stats();
  if (params_.input_count() > 1) add_camera_stats(rows, cameras);
  // A camera that has not been shown yet leaves its part black.
  if (score_ && std::all_of(cameras.begin(), cameras.end(), [](const auto& c) { return c.displayed > 0; }))
    add_quality(rows, (*score_)(mosaic_));
  const auto lut = board_->log.first(board::Phase::kLut);
  const auto idle = board_->log.first(board::Phase::kIdle);
  if (lut && idle && *idle > *lut)
    rows.push_back(row("startup.lut_time", to_s(*idle - *lut), "s",
                       "time to build the look-up table, from phase 2 to phase 3 on the pins"));
  if (opened_)
    rows.push_back(row("startup.first_frame", to_s(*board_->window_start()), "s",
                       "time from power-up to the start of the first corrected frame on the display"));
}

void BoardSimulation::add_host(RunResult& result, bool strict) const {
  auto& h = result.host;
  const double window = board_->frame_stats().window;
  h.push_back(wall_time(seconds_since(started_), "the whole run"));
  h.push_back(peak_rss());
  if (window_wall_s_ > 0 && window > 0)
    h.push_back(realtime_factor(window, window_wall_s_, "in the measured window"));
  if (const StatRow* n = find(result.stats, "cpu.instructions"); n && window_wall_s_ > 0)
    h.push_back(
        mips(std::get<std::uint64_t>(n->value), window_wall_s_, "in the measured window"));
  h.push_back(row("sync.direct", direct_, "1",
                  "SDRAM accesses decided ahead of the kernel, in the window"));
  h.push_back(row("sync.queued", queued_, "1",
                  "SDRAM accesses decided by a kernel event, in the window"));
  if (direct_ + queued_ > 0)
    h.push_back(row("sync.direct_share",
                    static_cast<double>(direct_) / static_cast<double>(direct_ + queued_), "ratio",
                    "share of the direct path"));
  h.push_back(row("sync.strict", std::uint64_t{strict ? 1u : 0u}, "1", "--sync=strict"));
}

std::string BoardSimulation::failure_text(const std::string& what) const {
  const auto& core = board_->dm365.arm.core();
  std::string text =
      fmt::format("{} at pc {}, {:.6f} s after power-up", what,
                  symbols_.place(core.current_pc()), to_s(kernel_time()));
  for (const auto& a : core.last_accesses())
    text += fmt::format("\n  {} {} bytes at 0x{:08x} from pc {}", a.write ? "wrote" : "read", a.bytes,
                        a.address, symbols_.place(a.pc));
  return text;
}

std::string BoardSimulation::reset_note(const board::ChipReset& reset, std::size_t before) const {
  return fmt::format("the chip was reset at pc {}, {:.6f} s after power-up, and booted again ({} of "
                     "run.resets = {}): {}",
                     symbols_.place(reset.pc), to_s(reset.at), before + 1, params_.run.resets(),
                     reset.cause);
}

std::vector<std::string> timeline_masters() { return {kStatNames.begin(), kStatNames.end()}; }

TimelineRow timeline_row(Picoseconds start, Picoseconds end, const bus::Timeline::Row& row) {
  TimelineRow out{start, end, std::vector<std::uint64_t>(kStatCount),
                  std::vector<std::uint64_t>(kStatCount)};
  for (std::size_t m = 0; m < kMasterCount; ++m) {
    out.read_bytes[stat_index(static_cast<Master>(m))] += row.read[m];
    out.write_bytes[stat_index(static_cast<Master>(m))] += row.write[m];
  }
  return out;
}

/// Hands over the rows of the timeline that are final: those of a while ago, as the window may end a
/// little before the present time.
void take_timeline(board::Board& board, const RunRequest& request) {
  constexpr Picoseconds kWhile = 200 * kPsPerMs;
  const Picoseconds now = board.window_end().value_or(kernel_time());
  if (!request.timeline_row || now < kWhile) return;
  static const std::vector<std::string> masters = timeline_masters();
  board.dm365.scr.crossbar().timeline.take_until(
      now - kWhile, [&](Picoseconds start, Picoseconds end, const auto& row) {
        request.timeline_row(masters, timeline_row(start, end, row));
      });
}

std::string BoardSimulation::ended_text(const RunEnd::Met& met) const {
  return fmt::format("{} after {:.6f} s, {} instructions, at pc {}", met.what, to_s(met.at),
                     board_->dm365.arm.core().instructions_executed(), symbols_.place(met.pc));
}

/// The core's figures of the window, or of the whole run if none was opened. A core that ended, or
/// comes to no instruction boundary any more, has what it has.
cpu::Counts BoardSimulation::collect_core(RunResult& result) const {
  const auto& core = board_->dm365.arm.core();
  cpu::CoreStats figures;
  if (opened_) figures.from = core.window_stats().from;
  if (closed_ && core.mark_done() && core.window_stats().to.cycles) {
    figures.to = core.window_stats().to;
  } else if (asleep_at_end_) {
    figures.to = *asleep_at_end_;
  } else {
    figures.to = core.counts();
    figures.to.cycles = core.clock_count();
  }
  // The clock's first edge after power-up is number 1; a core that never ran has no clocks either.
  if (!opened_ && figures.to.cycles) --figures.to.cycles;
  collect(figures, result.stats);
  remaps_->collect(figures.from, figures.to, result.stats);
  result.stalls = stall_rows(figures.from, figures.to, core.regions());
  return figures.to;
}

void BoardSimulation::collect_profile(RunResult& result, const cpu::Counts& end,
                                      const RunRequest& request, const ElfImage& program) {
  const ProfileData data = profile_->finish(end, program_file(params_).filename().string());
  const ElfImage* const programs[] = {&program, request.symbols};
  result.profile = profile_result(data, programs);
  result.profile.files.push_back({"frame_parts.csv", profile_->frame_parts()});
}

ExecMap BoardSimulation::hosted_map() const {
  return ExecProgram::elf(program_file(params_)).map(params_.soc.ddr.size_bytes(), kSdram);
}

/// A program that lies in SDRAM alone needs a loader that sets up clocks and SDRAM before it; any other
/// brings its own and starts as the chip does at power-up.
std::optional<ElfImage> BoardSimulation::loader_of(const ElfImage& program,
                                                   const RunRequest& request) const {
  const auto& segments = program.segments();
  if (!request.hosted || std::any_of(segments.begin(), segments.end(),
                                     [](const ElfSegment& s) { return s.address < kSdram; }))
    return std::nullopt;
  return ElfImage::load(built_program("board_loader.elf"));
}

/// The loader leaves the registers in `start_state` (sw/firmware/boot/loader.h) when it jumps.
void BoardSimulation::load_loader(const ElfImage& loader, const ElfImage& program,
                                  const RunRequest&) {
  const ElfSymbol* state = loader.find("start_state");
  FOVEA_CHECK(state && loader.segments().size() == 1, "the board's loader is the one of this build");
  const ElfSegment& segment = loader.segments().front();
  board::LoadImage image{segment.address, segment.data};
  image.bytes.resize(segment.memory_size);  // the registers may lie behind the segment's data
  const std::uint32_t words[] = {0, 0, 0, hosted_map().free_end, program.entry()};
  std::memcpy(image.bytes.data() + (state->address - segment.address), words, sizeof words);
  board_->load(image);
}

/// The page stands for one of the boot image. A program that has something of its own at that place keeps it.
void BoardSimulation::load_page(const ElfImage& program, std::vector<std::uint8_t> page) {
  const auto overlaps = [&](const ElfSegment& s) {
    const std::uint32_t at = s.address >= INTERNAL_RAM_DATA_BASE ? s.address - INTERNAL_RAM_DATA_BASE : s.address;
    return s.address < DDR_BASE && at < PARAM_PAGE_BASE + page.size() && at + s.memory_size > PARAM_PAGE_BASE;
  };
  if (std::none_of(program.segments().begin(), program.segments().end(), overlaps))
    board_->load({PARAM_PAGE_BASE, std::move(page)});
}

/// Heap and stack take the largest piece of SDRAM that the program leaves free.
SemihostingSettings BoardSimulation::semihosting_settings(const RunRequest& request) const {
  const ExecMap map = hosted_map();
  SemihostingSettings s;
  std::vector<std::string> line = {program_file(params_).filename().string()};
  if (request.hosted) {
    s.root = request.hosted->root;
    line.insert(line.end(), request.hosted->arguments.begin(), request.hosted->arguments.end());
  }
  s.command_line = guest_command_line(line);
  s.heap_base = map.free_base;
  s.heap_limit = s.stack_limit = map.heap_limit();
  s.stack_base = map.free_end;
  return s;
}

RunResult BoardSimulation::run(const RunRequest& request) {
  started_ = Wall::now();
  const ElfImage elf = ElfImage::load(program_file(params_));
  check_fits(elf, memory_regions(params_));
  symbols_ = Symbols(&elf, request.symbols);
  const std::vector<EndCondition> until = parse_run_until(params_.run.until(), symbols_);
  const auto wanted = [&](EndCondition::Kind kind) {
    return std::any_of(until.begin(), until.end(), [&](const auto& c) { return c.kind == kind; });
  };
  if (request.gdb_port && wanted(EndCondition::Kind::kPc))
    throw UserError("key 'run.until': pc is not possible with --gdb; use a breakpoint");
  if (!request.bus_trace.empty() && !wanted(EndCondition::Kind::kFrames))
    throw UserError("--bus-trace records the window of displayed frames; allowed: with frames in "
                    "'run.until'");
  std::optional<Dialogue> dialogue;
  if (!params_.uart0.input().empty()) dialogue = Dialogue::load(params_.uart0.input());
  complete_params(params_);
  sc_core::sc_report_handler::set_actions("/OSCI/SystemC", sc_core::SC_INFO,
                                          sc_core::SC_DO_NOTHING);
  RunResult result;
  std::vector<std::unique_ptr<video::StampedSource>> views;
  std::vector<std::unique_ptr<video::AheadSource>> ahead;
  std::vector<std::unique_ptr<CameraPictures>> pictures;  // only if they are wanted
  std::vector<const video::StampedSource*> sources;
  std::vector<video::PictureSource*> cameras;
  for (unsigned n = 0; n < params_.camera_count(); ++n) {
    views.push_back(camera_source(params_, n, &request.stop, &result.notes));
    ahead.push_back(std::make_unique<video::AheadSource>(*views.back()));
    sources.push_back(views.back().get());
    cameras.push_back(ahead.back().get());
    if (!request.camera) continue;
    pictures.push_back(std::make_unique<CameraPictures>(*cameras.back()));
    cameras.back() = pictures.back().get();
  }
  std::optional<video::QuadSource> quad;
  if (params_.cameras.quad()) {
    quad.emplace(std::array<video::PictureSource*, 4>{ahead[0].get(), ahead[1].get(), ahead[2].get(), ahead[3].get()});
    cameras = {&*quad};
    pictures.clear();
    if (request.camera) cameras[0] = pictures.emplace_back(std::make_unique<CameraPictures>(*quad)).get();
  }
  const std::optional<ElfImage> loader = loader_of(elf, request);
  board_ = std::make_unique<board::Board>("board", params_, cameras,
                                          loader ? loader->entry() : elf.entry(),
                                          request.strict_sync);
  for (const auto& s : elf.segments()) {
    board_->load({s.address, s.data, s.memory_size - s.data.size()});
  }
  if (loader) load_loader(*loader, elf, request);
  cpu::RegionMap regions = board_->dm365.arm.core().regions();
  add_program_regions(regions, elf, memory_regions(params_));
  board_->dm365.arm.core().set_regions(std::move(regions));
  board_->dm365.arm.core().describe = [this](std::uint32_t pc) { return symbols_.describe(pc); };
  load_page(elf, parameter_page(params_, sources));

  if (!request.bus_trace.empty())
    trace_ = std::make_unique<BusTraceRun>(request.bus_trace, request.params, *board_);
  if (!request.command_trace.empty()) commands_ = std::make_unique<CommandTrace>(request.command_trace);
  remaps_ = std::make_unique<RemapTime>(*board_);
  if (!request.perfetto.file.empty()) perfetto_ = std::make_unique<PerfettoRun>(request.perfetto, *board_);
  score_ = plan_score(params_);
  std::exception_ptr failure;
  board_->on_window_open = [this] { open_window(); };
  board_->on_window_close = [this] { close_window(); };
  std::optional<BoardConsole> console;
  if (request.console || dialogue)
    console.emplace(*board_, request.console, std::move(dialogue));
  board_->on_frame = [&](const video::DisplayFrame& f, const board::FrameRecord& r) {
    if (score_) {
      mosaic_ = video::Picture(params_.width(), params_.height());
      const unsigned x = (f.picture.width - mosaic_.width) / 2, y = (f.picture.height - mosaic_.height) / 2;
      for (unsigned v = 0; v < mosaic_.height; ++v)
        std::copy_n(f.picture.row(y + v) + 2 * x, mosaic_.row_bytes(), mosaic_.row(v));
    }
    FrameRow out;
    out.index = r.index;
    out.camera = r.camera;
    out.captured = r.captured;
    out.capture_start = r.capture_start;
    out.capture_end = r.capture_end;
    out.remap_start = r.remap_start;
    out.remap_end = r.remap_end;
    out.display_start = r.display_start;
    out.display_end = r.display_end;
    out.dropped = r.dropped;
    out.repeated = r.repeated;
    // An error of a writer must not unwind through the kernel: keep it and stop.
    if (failure) return;
    if (profile_) profile_->frame(out);
    try {
      if (perfetto_) perfetto_->frame(f, r);
      if (request.frame_row)
        request.frame_row(out);
      else
        frames_.push_back(out);
      if (request.frame)
        request.frame({r.index, f.picture.width, f.picture.height, f.picture.uyvy});
      if (request.camera && r.capture_start && r.camera < pictures.size())
        if (const video::Picture* sent =
                pictures[r.camera]->frame(board_->decoder.cameras()[r.camera], *r.capture_start))
          request.camera({r.index, sent->width, sent->height, sent->uyvy});
    } catch (...) {
      failure = std::current_exception();
    }
  };

  auto& arm = board_->dm365.arm;
  std::optional<HazardReport> hazards;
  if (request.hazards) hazards.emplace(arm.core(), board_->dm365.scr.memory(), symbols_);
  BoardDebugMemory debug_memory(board_->dm365);
  const auto log = register_log(register_blocks(board_->platform), board_->dm365.config, arm.core(),
                                [this](std::uint32_t pc) { return symbols_.describe(pc); });
  log->keep(request.registers.kept);
  if (!request.registers.pattern.empty()) log->start(request.registers);
  RunEnd run_end(*board_, debug_memory, until);
  if (!run_end.wants(EndCondition::Kind::kFrames)) board_->measure_whole_run();
  if (request.profile) {
    const ElfImage* const programs[] = {&elf, request.symbols};
    profile_ = std::make_unique<RunProfile>(*board_, !run_end.wants(EndCondition::Kind::kFrames),
                                            programs);
  }
  std::optional<CoreSemihosting> semihosting;
  if (request.semihosting && run_end.wants(EndCondition::Kind::kExit))
    semihosting.emplace(arm.core(), debug_memory, semihosting_settings(request),
                        *request.semihosting, [&] {
                          if (semihosting->exit_code()) run_end.program_exited();
                          return run_end.core_ended() || request.semihosting->lost();
                        });
  std::unique_ptr<GdbSession> gdb;
  if (request.gdb_port)
    gdb = std::make_unique<GdbSession>(*request.gdb_port, arm.core(), debug_memory,
                                       board_views(*board_, request.params, log.get()),
                                       request.stop, *request.notes);
  const auto lost = [&] {
    return (request.console && request.console->lost()) ||
           (request.semihosting && request.semihosting->lost());
  };
  window_wall_ = Wall::now();
  HostTimeSlicer slicer;
  std::string guest;
  unsigned behind_end = 0;
  for (;;) {
    slicer.run(run_end.met()                    ? after_end(behind_end++)
               : gdb && gdb->hit_pending() ? kPsPerUs
                                           : request.limits.next_slice(
                                                 kSlice, kernel_time(),
                                                 arm.core().instructions_executed()));
    take_timeline(*board_, request);
    if (hazards) hazards->settle(board_->window_end().value_or(kernel_time()));
    const std::uint64_t executed = arm.core().instructions_executed();
    request.progress.update({kernel_time(), board_->frames_in_window(),
                             run_end.wants(EndCondition::Kind::kFrames) ? params_.run.frames() : 0,
                             executed, phase_name(board_->log)});
    const bool left = console && console->look();
    if (!arm.failure().empty()) {
      guest = failure_text(arm.failure());
      if (gdb) gdb->failed(guest);
      break;
    }
    if (board_->chip_reset() && !run_end.met()) {
      guest = failure_text(reset_text(board_->chip_reset()->cause, board_->resets().size()));
      if (gdb) gdb->failed(guest);
      break;
    }
    const bool asleep = run_end.met() && asleep_at_end_;
    if ((closed_ && (arm.core().mark_done() || asleep)) || (run_end.core_ended() && kernel_stopped()) ||
        behind_end > kLooksAfterEnd)
      break;
    if (failure || request.stop.load() || left || lost() || (gdb && gdb->killed())) {
      result.complete = false;
      break;
    }
    if (gdb) gdb->look(arm.asleep());
    if (const auto option = request.limits.reached(kernel_time(), executed); !option.empty())
      run_end.limit(option);
    if (run_end.wants(EndCondition::Kind::kFrames) && board_->log.phase() == board::Phase::kFailed &&
        arm.asleep() && !run_end.met()) {
      guest = failure_text("the firmware stopped: " + last_line(board_->uart_text()));
      break;
    }
    if (run_end.only_frames() && !board_->window_start() &&
        kernel_time() > params_.run.start_limit()) {
      guest = failure_text(fmt::format("the firmware showed no frame within {} of simulated time "
                                       "(run.start_limit); it stands",
                                       params_.run.start_limit.text()));
      break;
    }
  }
  if (failure) std::rethrow_exception(failure);
  if (run_end.met() && run_end.met()->limit)
    guest = failure_text(fmt::format("run.until = {} not met within {}", params_.run.until(),
                                     run_end.met()->what));
  else if (run_end.met())
    result.ended = ended_text(*run_end.met());
  if (result.complete && guest.empty())
    result.ended_by = run_end.met() ? run_end.met()->what : "frames";
  else
    result.complete = false;
  // A stopped run closes its window a slice from here: the masters may have worked ahead of this
  // time, but not past the display's next line. The core's own part follows at its next boundary,
  // which a failed core does not reach any more.
  if (!closed_ && !kernel_stopped()) {
    board_->close_window(kernel_time() + kSlice);
    for (int i = 0; i < 20 && !(closed_ && (arm.core().mark_done() || asleep_at_end_)); ++i)
      slicer.run(kSlice);
  }
  board_->close_window_now();
  if (console) {
    console->look();
    result.typed = console->typed();
    result.untyped = console->open_step();
  }
  if (semihosting) result.exit_code = semihosting->exit_code();
  if (trace_) trace_->finish();
  if (commands_) commands_->finish();
  if (perfetto_)
    if (const std::string note = perfetto_->finish(); !note.empty()) result.notes.push_back(note);
  add_frame_stats(stats_);
  result.guest_failure = guest;
  result.stats = std::move(stats_);
  const cpu::Counts counted = collect_core(result);
  if (profile_) collect_profile(result, counted, request, elf);
  if (hazards) {
    hazards->settle(board_->window_end().value_or(kernel_time()));
    hazards->collect(result.stats);
    result.hazards = hazards->failure();
  }
  result.frames = std::move(frames_);
  result.timeline_masters = timeline_masters();
  // Only whole intervals before the window's end: how far the path has decided beyond it depends on
  // who played it.
  board_->dm365.scr.crossbar().timeline.list_until(
      board_->window_end().value_or(kernel_time()),
      [&](Picoseconds start, Picoseconds end, const auto& row) {
        result.timeline.push_back(timeline_row(start, end, row));
      });
  result.latency = std::move(latency_);
  result.uart = board_->uart_text();
  for (std::size_t i = 0; i < board_->resets().size(); ++i)
    result.notes.push_back(reset_note(board_->resets()[i], i));
  if (!request.registers.pattern.empty()) result.registers = log->text();
  add_host(result, request.strict_sync);
  const bool stopped = !result.complete && guest.empty();
  if (gdb) gdb->exited(stopped ? SIGTERM : guest.empty() ? 0 : 3, stopped);
  return result;
}

}  // namespace

std::unique_ptr<Simulation> make_simulation() { return std::make_unique<BoardSimulation>(); }

}  // namespace fovea::app
