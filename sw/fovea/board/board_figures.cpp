#include "sw/fovea/board/board_figures.h"

#include <fmt/format.h>

#include "sw/fovea/results/figures.h"
#include "sw/fovea/results/names.h"
#include "sw/fovea/tools/stall_regions.h"

namespace fovea::app {
namespace {

void add_camera_stats(std::vector<StatRow>& rows,
                      const std::vector<board::CameraFrameStats>& cameras) {
  for (std::size_t n = 0; n < cameras.size(); ++n) {
    const board::CameraFrameStats& c = cameras[n];
    const std::string name = fmt::format("camera.{}.frame.", n), whose = fmt::format(" of camera {}", n);
    rows.push_back(row(name + "captured", c.captured, "1",
                       "frames captured" + whose +
                           ", from the first one shown in the window on: displayed, superseded and dropped ones"));
    rows.push_back(row(name + "displayed", c.displayed, "1", "frames" + whose + " displayed"));
    rows.push_back(row(name + "superseded", c.superseded, "1",
                       "corrected frames" + whose + " that a newer frame replaced before they were shown"));
    rows.push_back(row(name + "dropped", c.dropped, "1",
                       "captured frames" + whose + " that were not corrected"));
    rows.push_back(row(name + "pending", c.pending, "1",
                       "frames" + whose + " captured in the last two frame periods or in work at the window's end, "
                       "and not shown: no part of captured"));
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

}  // namespace

BoardFigures::BoardFigures(board::Board& board, const board::BoardParams& params)
    : board_(board), params_(params), remaps_(board) {}

void BoardFigures::open_window() {
  auto& soc = board_.dm365;
  opened_ = true;
  board_.platform.each_statistics([](StatGroup& group) { group.reset(); });
  soc.arm.core().mark_window(kernel_time());
  window_wall_ = Wall::now();
  host_at_open_ = host_instructions_.count();
  direct_at_open_ = soc.scr.memory().decided_ahead();
  queued_at_open_ = soc.scr.memory().decided_at_present();
}

void BoardFigures::close_window() {
  if (closed_) return;
  closed_ = true;
  auto& soc = board_.dm365;
  window_wall_s_ = std::chrono::duration<double>(Wall::now() - window_wall_).count();
  if (const auto now = host_instructions_.count(); now && host_at_open_) host_in_window_ = *now - *host_at_open_;
  direct_ = soc.scr.memory().decided_ahead() - direct_at_open_;
  queued_ = soc.scr.memory().decided_at_present() - queued_at_open_;
  board_.platform.each_statistics([this](const StatGroup& group) { app::collect(group, stats_); });
  for (std::size_t i = 0; i < kStatCount; ++i) {
    const std::string name(kStatNames[i]);
    add_latency_rows(latency_, name, *soc.scr.latency[i]);
    add_slowest_rows(slowest_, name, *soc.scr.latency[i], [](Master m) { return std::string(stat_name(m)); });
  }
  // The SDRAM's data bus: clocks with data over clocks of the window.
  const auto from = board_.window_start(), to = board_.window_end();
  if (from && to && *to > *from) {
    const mem::DdrController& ddr = soc.ddr.controller();
    add_ddr_shares(stats_,
                   {ddr.busy_clocks(), ddr.stats.queued_clocks.count(),
                    to_s(*to - *from) * ddr.ddr_clock().frequency().hertz()},
                   "the window");
  }
  soc.arm.core().mark_window(kernel_time());
  if (soc.arm.asleep()) asleep_at_end_ = soc.arm.core().counts_asleep(kernel_time());
}

bool BoardFigures::core_done() const {
  return closed_ && (asleep_at_end_ || board_.dm365.arm.core().mark_done());
}

void BoardFigures::add_frame_stats(std::vector<StatRow>& rows) const {
  const board::FrameStats f = board_.frame_stats();
  if (f.rate)
    rows.push_back(row(names::kRate, *f.rate, "1/s",
                       "new frames displayed / time, over the whole display frames in the window"));
  rows.push_back(row(names::kWindow, f.window, "s", "length of the measured window"));
  rows.push_back(row("frame.captured", f.captured, "1", "complete frames captured in the window"));
  rows.push_back(row(names::kRemapped, f.remapped, "1", "frames corrected (remap finished) in the window"));
  rows.push_back(row(names::kDisplayed, f.displayed, "1", "frames displayed in the window"));
  rows.push_back(row(names::kDropped, f.dropped, "1", "captured frames that were never displayed"));
  rows.push_back(row(names::kRepeated, f.repeated, "1", "displayed frames that show a camera frame again"));
  if (!board_.digital)
    rows.push_back(row(names::kRepeatedRelock, f.repeated_relock, "1",
                       "of the repeated frames, those for which no newer one could be on show yet, because the decoder "
                       "had to find a camera's syncs"));
  if (f.latencies) {
    const std::string what = "time from a frame's first captured sample to its first displayed sample, ";
    rows.push_back(row(names::kLatencyMin, to_s(f.latency_min), "s", what + "shortest"));
    rows.push_back(row(names::kLatencyMean, f.latency_mean * 1e-12, "s", what + "mean"));
    rows.push_back(row(names::kLatencyMax, to_s(f.latency_max), "s", what + "longest"));
  }
  if (f.remaps) {
    rows.push_back(row(names::kRemapRate, f.remap_rate, "1/s",
                       "remaps that ended in the window / its length; with firmware.repeat above 1 what the "
                       "remap loop manages without waiting for the camera"));
    add_remap_times(rows, to_s(f.remap_min), f.remap_mean * 1e-12, to_s(f.remap_max));
  }
  if (params_.input_count() > 1) add_camera_stats(rows, board_.camera_stats());
  const auto lut = board_.log.first(board::Phase::kLut);
  const auto idle = board_.log.first(board::Phase::kIdle);
  if (lut && idle && *idle > *lut)
    rows.push_back(row(names::kStartupLutTime, to_s(*idle - *lut), "s",
                       "time to build the look-up table, from phase 2 to phase 3 on the pins"));
  if (opened_)
    rows.push_back(row(names::kStartupFirstFrame, to_s(*board_.window_start()), "s",
                       "time from power-up to the start of the first corrected frame on the display"));
}

void BoardFigures::add_host(Result& result, double wall_seconds, bool strict) const {
  auto& h = result.host;
  const double window = board_.frame_stats().window;
  h.push_back(wall_time(wall_seconds, "the whole run"));
  h.push_back(peak_rss());
  if (window_wall_s_ > 0 && window > 0)
    h.push_back(realtime_factor(window, window_wall_s_, "in the measured window"));
  if (const StatRow* n = find(result.stats, names::kCpuInstructions); n && window_wall_s_ > 0)
    h.push_back(
        mips(std::get<std::uint64_t>(n->value), window_wall_s_, "in the measured window"));
  if (const StatRow* n = find(result.stats, names::kCpuInstructions); n && host_in_window_)
    if (const auto guest = std::get<std::uint64_t>(n->value))
      h.push_back(row("host_instructions", static_cast<double>(*host_in_window_) / static_cast<double>(guest), "1",
                      "instructions of the host, of the simulating thread, for each one of the core, in the "
                      "measured window; only where the host counts them"));
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

/// The core's figures of the window, or of the whole run if none was opened. A core that ended, or
/// comes to no instruction boundary any more, has what it has.
cpu::Counts BoardFigures::collect_core(Result& result) const {
  const auto& core = board_.dm365.arm.core();
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
  app::collect(figures, result.stats);
  remaps_.collect(figures.from, figures.to, result.stats);
  result.stalls = stall_rows(figures.from, figures.to, core.regions());
  return figures.to;
}

cpu::Counts BoardFigures::collect(Result& result) {
  add_frame_stats(stats_);
  result.stats = std::move(stats_);
  result.latency = std::move(latency_);
  result.slowest = std::move(slowest_);
  result.timeline_masters = timeline_masters();
  // Only whole intervals before the window's end: how far the path has decided beyond it depends on
  // who played it.
  board_.dm365.scr.crossbar().timeline.list_until(
      board_.window_end().value_or(kernel_time()),
      [&](Picoseconds start, Picoseconds end, const auto& row) {
        result.timeline.push_back(timeline_row(start, end, row));
      });
  return collect_core(result);
}

void take_timeline(board::Board& board, const Request& request) {
  // The window may end a little before the present time.
  constexpr Picoseconds kWhile = 200 * kPsPerMs;
  const Picoseconds now = board.window_end().value_or(kernel_time());
  if (!request.timeline_row || now < kWhile) return;
  static const std::vector<std::string> masters = timeline_masters();
  board.dm365.scr.crossbar().timeline.take_until(
      now - kWhile, [&](Picoseconds start, Picoseconds end, const auto& row) {
        request.timeline_row(masters, timeline_row(start, end, row));
      });
}

}  // namespace fovea::app
