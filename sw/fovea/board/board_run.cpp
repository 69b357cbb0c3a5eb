// `fovea run` on the board: loads footage and program, runs the window, gathers the figures.
#include <fmt/format.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstring>
#include <filesystem>

#include "model/board/board.h"
#include "model/common/host_time_slicer.h"
#include "sw/fovea/board/board_console.h"
#include "sw/fovea/board/board_debug.h"
#include "sw/fovea/board/board_figures.h"
#include "sw/fovea/board/board_machine.h"
#include "sw/fovea/board/camera_inputs.h"
#include "sw/fovea/board/kernel_choice.h"
#include "sw/fovea/board/loader.h"
#include "sw/fovea/board/mosaic_score.h"
#include "sw/fovea/board/parameter_page.h"
#include "sw/fovea/board/picture_score.h"
#include "sw/fovea/board/run_end.h"
#include "sw/fovea/console/core_semihosting.h"
#include "sw/fovea/files/ffmpeg.h"
#include "sw/fovea/files/side_output.h"
#include "sw/fovea/machine/machine.h"
#include "sw/fovea/probes/run_profile.h"
#include "sw/fovea/program/elf_image.h"
#include "sw/fovea/program/exec_program.h"
#include "sw/fovea/tools/stall_regions.h"

namespace fovea::app {
namespace {

/// The active samples of either television standard, 720x576 or 720x480, fill a screen of 4:3.
PixelShape pixel_on_screen(const board::VideoParams& video) {
  return video.format().is_625 ? PixelShape{16, 15} : PixelShape{8, 9};
}

// Slices only let the host look in; nothing in the model depends on where they end.
constexpr Picoseconds kSlice = 5 * kPsPerMs;

// Once the run or its window has ended, the core is let to its next instruction boundary: short slices first, long
// ones for a core that hardly runs, and an end for one that does not run at all, such as one that a load of the
// highest priority leaves no access to the SDRAM.
constexpr unsigned kShortLooks = 20, kLooksAfterEnd = 40;
Picoseconds after_end(unsigned looks) { return looks < kShortLooks ? kPsPerUs : kSlice; }

/// The last line that has something in it.
std::string last_line(const std::string& text) {
  const std::size_t end = text.find_last_not_of("\r\n") + 1;
  const std::size_t begin = text.find_last_of("\r\n", end ? end - 1 : 0);
  return text.substr(begin == std::string::npos ? 0 : begin + 1, end - (begin == std::string::npos ? 0 : begin + 1));
}

bool kernel_stopped() { return sc_core::sc_get_status() == sc_core::SC_STOPPED; }


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

class BoardMachine : public Machine {
 public:
  explicit BoardMachine(bool hosted) { params_.hosted = hosted; }
  void declare(ParamSet& set) override { params_.declare(set); }
  std::vector<std::pair<std::string, std::filesystem::path>> input_files() const override {
    return {{params_.firmware.elf.key(), program_file(params_)}};
  }
  Result run(const Request& request) override;

 private:
  void open_window();
  void close_window();
  std::string failure_text(const std::string& what) const;
  std::string reset_note(const board::ChipReset& reset, std::size_t before) const;
  std::string ended_text(const RunEnd::Met& met) const;
  SemihostingSettings semihosting_settings(const Request& request) const;
  std::optional<ElfImage> loader_of(const ElfImage& program, const Request& request) const;
  void load_loader(const ElfImage& loader, const ElfImage& program, const Request& request);
  void load_page(const ElfImage& program, std::vector<std::uint8_t> page);
  ExecMap hosted_map() const;

  // The steps of run(), in their order.
  struct Session;
  std::vector<EndCondition> end_conditions(const Request& request) const;
  void build_board(const ElfImage& elf, const CameraInputs& cameras, const Request& request);
  void open_outputs(Session& s, const CameraInputs& cameras);
  void take_frame(Session& s, const CameraInputs& cameras, const video::Frame& frame);
  void attach_host(Session& s);
  Picoseconds next_slice(Session& s) const;
  bool guest_failed(Session& s) const;
  bool models_differ(Session& s) const;
  bool ended(const Session& s) const;
  bool firmware_gave_up(Session& s) const;
  bool simulate(Session& s);
  void state_end(Session& s, Result& result) const;
  void end_window(Session& s);
  void collect(Session& s, Result& result);

  board::BoardParams params_;
  std::unique_ptr<board::Board> board_;
  Subscription window_;
  Symbols symbols_;
  Tools tools_;
  std::unique_ptr<BoardFigures> figures_;
  std::unique_ptr<MosaicScore> mosaic_score_;
  std::unique_ptr<PictureScore> picture_score_;
};

void BoardMachine::open_window() {
  figures_->open_window();
  tools_.open_window();
}

void BoardMachine::close_window() {
  if (figures_->closed()) return;
  tools_.close_window();
  figures_->close_window();
}

std::string BoardMachine::failure_text(const std::string& what) const {
  const auto& core = board_->dm365.arm.core();
  std::string text =
      fmt::format("{} at pc {}, {:.6f} s after power-up", what,
                  symbols_.place(core.current_pc()), to_s(kernel_time()));
  for (const auto& a : core.last_accesses())
    text += fmt::format("\n  {} {} bytes at 0x{:08x} from pc {}", a.write ? "wrote" : "read", a.bytes,
                        a.address, symbols_.place(a.pc));
  return text;
}

std::string BoardMachine::reset_note(const board::ChipReset& reset, std::size_t before) const {
  return fmt::format("the chip was reset at pc {}, {:.6f} s after power-up, and booted again ({} of "
                     "run.resets = {}): {}",
                     symbols_.place(reset.pc), to_s(reset.at), before + 1, params_.run.resets(),
                     reset.cause);
}

std::string BoardMachine::ended_text(const RunEnd::Met& met) const {
  return fmt::format("{} after {:.6f} s, {} instructions, at pc {}", met.what, to_s(met.at),
                     board_->dm365.arm.core().instructions_executed(), symbols_.place(met.pc));
}

ExecMap BoardMachine::hosted_map() const {
  return ExecProgram::elf(program_file(params_)).map(params_.soc.ddr.size_bytes(), DDR_BASE);
}

/// A program that lies in SDRAM alone needs a loader that sets up clocks and SDRAM before it; any other
/// brings its own and starts as the chip does at power-up.
std::optional<ElfImage> BoardMachine::loader_of(const ElfImage& program,
                                                   const Request& request) const {
  const auto& segments = program.segments();
  if (!request.program || std::any_of(segments.begin(), segments.end(),
                                     [](const ElfSegment& s) { return s.address < DDR_BASE; }))
    return std::nullopt;
  refuse_mobile_memory(params_.soc.ddr, "the boot loader of exec --board");
  return ElfImage::load(built_program("board_loader.elf"));
}

/// The loader leaves the registers in `start_state` (sw/firmware/boot/loader.h) when it jumps.
void BoardMachine::load_loader(const ElfImage& loader, const ElfImage& program,
                                  const Request&) {
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
void BoardMachine::load_page(const ElfImage& program, std::vector<std::uint8_t> page) {
  const auto overlaps = [&](const ElfSegment& s) {
    const std::uint32_t at = s.address >= INTERNAL_RAM_DATA_BASE ? s.address - INTERNAL_RAM_DATA_BASE : s.address;
    return s.address < DDR_BASE && at < PARAM_PAGE_BASE + page.size() && at + s.memory_size > PARAM_PAGE_BASE;
  };
  if (std::none_of(program.segments().begin(), program.segments().end(), overlaps))
    board_->load({PARAM_PAGE_BASE, std::move(page)});
}

/// Heap and stack take the largest piece of SDRAM that the program leaves free.
SemihostingSettings BoardMachine::semihosting_settings(const Request& request) const {
  const ExecMap map = hosted_map();
  SemihostingSettings s;
  std::vector<std::string> line = {program_file(params_).filename().string()};
  if (request.program) {
    s.root = request.program->root;
    line.insert(line.end(), request.program->arguments.begin(), request.program->arguments.end());
  }
  s.command_line = guest_command_line(line);
  s.heap_base = map.free_base;
  s.heap_limit = s.stack_limit = map.heap_limit();
  s.stack_base = map.free_end;
  return s;
}

/// What is attached to the board for one run, in the order in which it is made.
struct BoardMachine::Session {
  Session(board::Board& board, const Request& run, const ElfImage& elf,
          const std::vector<EndCondition>& until, const Symbols& symbols)
      : request(run), program(elf), debug_memory(board.dm365), run_end(board, debug_memory, until) {
    auto& soc = board.dm365;
    log = register_log(register_blocks(board.platform), soc.config, soc.arm.core(),
                       [&symbols](std::uint32_t pc) { return symbols.describe(pc); });
  }
  bool wants_frames() const { return run_end.wants(EndCondition::Kind::kFrames); }
  /// The output that the program writes to has gone.
  bool lost() const {
    return (request.console && request.console->lost()) ||
           (request.semihosting && request.semihosting->lost());
  }
  void guest_fails(std::string why) {
    guest = std::move(why);
    if (gdb) gdb->failed(guest);
  }

  const Request& request;
  const ElfImage& program;
  std::exception_ptr failure;  ///< of a writer: it must not unwind through the kernel
  std::string guest;           ///< why the guest failed
  std::string difference;      ///< between two models of a block
  std::optional<BoardConsole> console;
  BoardDebugMemory debug_memory;
  std::unique_ptr<RegisterLog> log;
  RunEnd run_end;
  std::optional<CoreSemihosting> semihosting;
  std::unique_ptr<GdbSession> gdb;
  HostTimeSlicer slicer;
  unsigned behind_end = 0;  ///< slices since an end condition was met or the window was closed
};

/// When the run is to end. @throws UserError for a condition that does not go with the request
std::vector<EndCondition> BoardMachine::end_conditions(const Request& request) const {
  std::vector<EndCondition> until = parse_run_until(params_.run.until(), symbols_);
  const auto wanted = [&](EndCondition::Kind kind) {
    return std::any_of(until.begin(), until.end(), [&](const auto& c) { return c.kind == kind; });
  };
  if (request.gdb_port && wanted(EndCondition::Kind::kPc))
    throw UserError("key 'run.until': pc is not possible with --gdb; use a breakpoint");
  return until;
}

/// The board with everything that is in its memories at power-up.
void BoardMachine::build_board(const ElfImage& elf, const CameraInputs& cameras,
                                  const Request& request) {
  const std::optional<ElfImage> loader = loader_of(elf, request);
  board_ = std::make_unique<board::Board>("board", params_, cameras.sources(),
                                          loader ? loader->entry() : elf.entry(),
                                          request.strict_sync);
  for (const auto& s : elf.segments()) {
    board_->load({s.address, s.data, s.memory_size - s.data.size()});
  }
  if (loader) load_loader(*loader, elf, request);
  cpu::Core& core = board_->dm365.arm.core();
  cpu::RegionMap regions = core.regions();
  add_program_regions(regions, elf, memory_regions(params_));
  core.set_regions(std::move(regions));
  core.describe = [this](std::uint32_t pc) { return symbols_.describe(pc); };
  load_page(elf, parameter_page(params_, cameras.views()));
}

/// The figures, the scores, and what the tools write beside them.
void BoardMachine::open_outputs(Session& s, const CameraInputs& cameras) {
  auto& soc = board_->dm365;
  figures_ = std::make_unique<BoardFigures>(*board_, params_);
  tools_.make(s.request.tools, {.params = s.request.params,
                                .core = &soc.arm.core(),
                                .program = program_file(params_).filename().string(),
                                .symbols = &symbols_,
                                .programs = {&s.program, s.request.symbols},
                                .whole_run = !s.wants_frames(),
                                .controller = &soc.ddr.controller(),
                                .observe = [&soc](MemObserver& o) { return soc.scr.crossbar().observe(o); },
                                .name_of = [](Master m) { return std::string(stat_name(m)); },
                                .now = [] { return kernel_time(); },
                                .log = s.log.get(),
                                .memory = &soc.scr.memory(),
                                .board = board_.get()});
  mosaic_score_ = MosaicScore::of(params_);
  picture_score_ = PictureScore::of(params_, cameras.views());
  window_ = board_->observe_window([this](bool open) { open ? open_window() : close_window(); });
}

/// A displayed frame goes to the scores, the tools and the sinks. An error of a writer is kept and stops the run.
void BoardMachine::take_frame(Session& s, const CameraInputs& cameras, const video::Frame& frame) {
  if (mosaic_score_) mosaic_score_->displayed(frame);
  const CameraInputs::Sent sent = cameras.sent(*board_, frame.times);
  if (picture_score_) picture_score_->displayed(frame, sent);
  if (s.failure) return;
  const PixelShape pixel = pixel_on_screen(params_.video);
  try {
    tools_.frame(frame);
    for (FrameSink* sink : s.request.frames) sink->displayed(frame, pixel);
    for (FrameSink* sink : s.request.frames)
      if (sent.picture && sink->wants_sent())
        sink->sent(frame.times.index, *sent.picture, params_.video.format().digital ? PixelShape{} : pixel);
  } catch (...) {
    s.failure = std::current_exception();
  }
}

/// Semihosting and the debugger.
void BoardMachine::attach_host(Session& s) {
  const Request& request = s.request;
  cpu::Core& core = board_->dm365.arm.core();
  if (request.semihosting && s.run_end.wants(EndCondition::Kind::kExit))
    s.semihosting.emplace(core, s.debug_memory, semihosting_settings(request), *request.semihosting, [&s] {
      if (s.semihosting->exit_code()) s.run_end.program_exited();
      return s.run_end.core_ended() || s.request.semihosting->lost();
    });
  if (request.gdb_port)
    s.gdb = std::make_unique<GdbSession>(*request.gdb_port, core, s.debug_memory,
                                         board_views(*board_, request.params, s.log.get()), request.stop,
                                         *request.notes);
}

Picoseconds BoardMachine::next_slice(Session& s) const {
  if (s.run_end.met() || figures_->closed()) return after_end(s.behind_end++);
  if (s.gdb && s.gdb->hit_pending()) return kPsPerUs;
  return s.request.limits.next_slice(kSlice, kernel_time(),
                                     board_->dm365.arm.core().instructions_executed());
}

/// The core stands for good, or the chip was reset and does not boot again.
bool BoardMachine::guest_failed(Session& s) const {
  const auto& arm = board_->dm365.arm;
  if (!arm.failure().empty()) {
    s.guest_fails(failure_text(arm.failure()));
    return true;
  }
  if (board_->chip_reset() && !s.run_end.met()) {
    s.guest_fails(failure_text(reset_text(board_->chip_reset()->cause, board_->resets().size())));
    return true;
  }
  return false;
}

/// A block found its two models to differ, and paused the kernel.
bool BoardMachine::models_differ(Session& s) const {
  for (const auto& [name, block] : board_->platform.blocks())
    if (s.difference.empty()) s.difference = block->difference();
  return !s.difference.empty();
}

/// The run has ended, and the core's counters are those of its end, as far as they will be.
bool BoardMachine::ended(const Session& s) const {
  const bool asleep = s.run_end.met() && figures_->asleep_at_end();
  return (figures_->closed() && (board_->dm365.arm.core().mark_done() || asleep)) ||
         (s.run_end.core_ended() && kernel_stopped()) || s.behind_end > kLooksAfterEnd;
}

/// The firmware has stopped by itself, or shows no frame.
bool BoardMachine::firmware_gave_up(Session& s) const {
  if (s.wants_frames() && board_->log.phase() == board::Phase::kFailed && board_->dm365.arm.asleep() &&
      !s.run_end.met()) {
    s.guest = failure_text("the firmware stopped: " + last_line(board_->uart_text()));
    return true;
  }
  if (s.run_end.only_frames() && !board_->window_start() && kernel_time() > params_.run.start_limit()) {
    s.guest = failure_text(fmt::format("the firmware showed no frame within {} of simulated time "
                                       "(run.start_limit); it stands",
                                       params_.run.start_limit.text()));
    return true;
  }
  return false;
}

/// False: it was stopped before its end.
bool BoardMachine::simulate(Session& s) {
  const Request& request = s.request;
  auto& arm = board_->dm365.arm;
  for (;;) {
    s.slicer.run(next_slice(s));
    take_timeline(*board_, request);
    tools_.settle(board_->window_end().value_or(kernel_time()));
    const std::uint64_t executed = arm.core().instructions_executed();
    request.progress.update({kernel_time(), board_->frames_in_window(),
                             s.wants_frames() ? params_.run.frames() : 0, executed,
                             phase_name(board_->log)});
    const bool left = s.console && s.console->look();
    if (models_differ(s) || guest_failed(s) || ended(s)) return true;
    if (s.failure || request.stop.load() || left || s.lost() || (s.gdb && s.gdb->killed())) return false;
    if (s.gdb) s.gdb->look(arm.asleep());
    if (const auto option = request.limits.reached(kernel_time(), executed); !option.empty())
      s.run_end.limit(option);
    if (firmware_gave_up(s)) return true;
  }
}

/// Why the run is over, and whether that is the end that was wanted.
void BoardMachine::state_end(Session& s, Result& result) const {
  const auto& met = s.run_end.met();
  if (met && met->limit)
    s.guest = failure_text(
        fmt::format("run.until = {} not met within {}", params_.run.until(), met->what));
  else if (met)
    result.ended = ended_text(*met);
  if (result.complete && s.guest.empty() && s.difference.empty())
    result.ended_by = met ? met->what : "frames";
  else
    result.complete = false;
}

/// A stopped run closes its window a slice from here: the masters may have worked ahead of this time,
/// but not past the display's next line. The core's own part follows at its next boundary, which a
/// failed core does not reach any more.
void BoardMachine::end_window(Session& s) {
  if (!figures_->closed() && !kernel_stopped()) {
    board_->close_window(kernel_time() + kSlice);
    for (int i = 0; i < 20 && !figures_->core_done(); ++i) s.slicer.run(kSlice);
  }
  board_->close_window_now();
}

/// What the console and the writers have, and the figures of the window.
void BoardMachine::collect(Session& s, Result& result) {
  if (s.console) {
    s.console->look();
    result.typed = s.console->typed();
    result.untyped = s.console->open_step();
  }
  if (s.semihosting) result.exit_code = s.semihosting->exit_code();
  result.killed = s.gdb && s.gdb->killed();
  result.guest_failure = s.guest;
  result.difference = s.difference;
  const cpu::Counts counted = figures_->collect(result);
  if (mosaic_score_) mosaic_score_->add(result.stats, board_->camera_stats());
  if (picture_score_) picture_score_->add(result.stats);
  tools_.settle(board_->window_end().value_or(kernel_time()));
  tools_.finish(counted, result, result.lost);
  result.uart = board_->uart_text();
  result.kernel = kernel_that_ran(params_, result.uart);
  for (std::size_t i = 0; i < board_->resets().size(); ++i)
    result.notes.push_back(reset_note(board_->resets()[i], i));
}

Result BoardMachine::run(const Request& request) {
  const auto started = std::chrono::steady_clock::now();
  const ElfImage elf = ElfImage::load(program_file(params_));
  check_fits(elf, memory_regions(params_));
  symbols_ = Symbols(&elf, request.symbols);
  const std::vector<EndCondition> until = end_conditions(request);
  std::optional<Dialogue> dialogue;
  if (!params_.uart0.input().empty()) dialogue = Dialogue::load(params_.uart0.input());
  complete_params(params_);
  sc_core::sc_report_handler::set_actions("/OSCI/SystemC", sc_core::SC_INFO,
                                          sc_core::SC_DO_NOTHING);
  Result result;
  const bool keep = std::ranges::any_of(request.frames, &FrameSink::wants_sent) || PictureScore::possible(params_);
  const CameraInputs cameras(params_, keep, request.stop, result.notes);
  build_board(elf, cameras, request);
  Session session(*board_, request, elf, until, symbols_);
  open_outputs(session, cameras);
  if (request.console || dialogue)
    session.console.emplace(*board_, request.console, std::move(dialogue));
  const Subscription frames =
      board_->observe_frames([&](const video::Frame& frame) { take_frame(session, cameras, frame); });
  if (!session.wants_frames()) {
    board_->measure_whole_run();
    tools_.open_window();
  }
  attach_host(session);

  result.complete = simulate(session);
  if (session.failure) std::rethrow_exception(session.failure);
  state_end(session, result);
  end_window(session);
  collect(session, result);
  figures_->add_host(
      result, std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count(),
      request.strict_sync);
  const bool stopped = !result.complete && session.guest.empty();
  if (session.gdb)
    session.gdb->exited(stopped ? SIGTERM : session.guest.empty() ? 0 : 3, stopped);
  return result;
}

}  // namespace

std::unique_ptr<Machine> make_board(bool for_program) { return std::make_unique<BoardMachine>(for_program); }

}  // namespace fovea::app
