#include "sw/fovea/probes/bus_trace_run.h"

#include <string>
#include <string_view>

#include "model/trace/core/text_trace.h"
#include "model/trace/core/trace_file.h"
#include "sw/fovea/replay/replay_params.h"
#include "sw/fovea/tools/tool.h"

namespace fovea::app {
namespace {

bool is_trace(std::string_view first_bytes) {
  return trace::TraceFile::recognises(first_bytes) || trace::TextTrace::recognises(first_bytes);
}

}  // namespace

BusTraceRun::BusTraceRun(const std::filesystem::path& file, const ParamSet& params,
                         board::Board& board)
    : file_(file, "--bus-trace", "a bus trace", is_trace),
      params_(params),
      board_(board),
      recorder_(board.dm365.record_bus()),
      pins_(board.dm365.gpio.observe_outputs([this](unsigned bank, std::uint32_t out, Picoseconds at) {
        if (bank == PHASE_BANK) recorder_->mark(out, at);
      })) {}

void BusTraceRun::open() {
  const trace::BusTap& tap = board_.dm365.tap;
  core_ = tap.core();
  scr_ = tap.scr();
  ddr_ = tap.ddr();
  refresh_ = board_.dm365.ddr.controller().interval_start(kernel_time());
  recorder_->open(kernel_time(), core_.frequency, core_.start, scr_);
  opened_ = true;
}

void BusTraceRun::close() {
  if (!opened_) return;
  const trace::BusTap& tap = board_.dm365.tap;
  if (!(core_ == tap.core() && scr_ == tap.scr() && ddr_ == tap.ddr()))
    board_.dm365.diagnostics().not_modelled("a clock that changes inside a bus trace");
  recorder_->close(kernel_time());
  closed_ = true;
}

std::string BusTraceRun::finish() {
  if (!opened_ || !closed_) return "the bus trace: nothing was recorded; the measured window did not open";
  trace::TraceInfo info;
  info.scr = scr_;
  info.ddr = ddr_;
  info.refresh = refresh_;
  info.params = replay_keys(params_, board_.dm365.ddr.programmed(), scr_.frequency,
                            ddr_.frequency);
  recorder_->finish(std::move(info), [this](std::string_view bytes) { file_.write(bytes); });
  file_.commit();
  return "";
}

namespace {

class BusTraceTool final : public Tool {
 public:
  BusTraceTool(const std::string& file, const ToolParts& parts) : trace_(file, parts.params, *parts.board) {}
  void open_window() override { trace_.open(); }
  void close_window() override { trace_.close(); }
  void finish(const cpu::Counts&, ToolOutput& output) override {
    if (std::string note = trace_.finish(); !note.empty()) output.notes.push_back(std::move(note));
  }

 private:
  BusTraceRun trace_;
};

}  // namespace

ToolRow bus_trace_tool() {
  return {.what = "the bus trace",
          .needs = ToolNeeds::kBoard,
          .lacks = "there is no window of displayed frames (frames in 'run.until')",
          .options = {{"--bus-trace", "FILE", "Write all requests to the SDRAM in the measured window to this file",
                       "a file name is needed"}},
          .make = [](const ToolValues& v, const ToolParts& parts) -> std::unique_ptr<Tool> {
            if (parts.whole_run)
              throw UserError(
                  "--bus-trace records the window of displayed frames; allowed: with frames in 'run.until'");
            return std::make_unique<BusTraceTool>(v.text("--bus-trace"), parts);
          }};
}

}  // namespace fovea::app
