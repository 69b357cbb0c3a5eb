#include <memory>

#include "sw/fovea/config/run_until.h"
#include "sw/fovea/probes/perfetto_run.h"
#include "sw/fovea/program/source_lines.h"
#include "sw/fovea/tools/profile_report.h"
#include "sw/fovea/tools/tool.h"

namespace fovea::app {
namespace {

PerfettoRequest request_of(const ToolValues& v) {
  PerfettoRequest r;
  r.file = v.text("--perfetto");
  r.tracks = v.text("--perfetto-tracks", r.tracks);
  r.from = v.text("--perfetto-from", r.from);
  if (v.given("--perfetto-for")) r.duration = parse_time("--perfetto-for", v.text("--perfetto-for"));
  r.trigger = v.text("--perfetto-trigger");
  r.megabytes = v.number("--perfetto-size", r.megabytes);
  return r;
}

void check(const ToolValues& v, bool) {
  if (!v.given("--perfetto"))
    throw UserError("--perfetto-...: nothing is recorded; allowed: with --perfetto FILE");
  request_of(v);
}

class PerfettoTool final : public Tool {
 public:
  PerfettoTool(const PerfettoRequest& request, const ToolParts& parts) : run_(request, *parts.board) {
    if (!run_.wants_functions()) return;
    const bool shared = parts.core->profile();
    cpu::ClockProfile& profile = shared ? *parts.core->profile() : parts.core->start_profile();
    if (!shared) profile.stacks.set_functions(program_functions(parts.programs));
    // The names are those of the profile's files.
    const auto lines = std::make_shared<SourceLines>();
    for (const ElfImage* const program : parts.programs)
      if (program) lines->add(*program);
    run_.watch_functions(profile, [lines](std::uint32_t at) { return lines->function_text(at); });
  }
  void open_window() override { run_.window_opened(); }
  void close_window() override { run_.window_closed(); }
  void frame(const video::Frame& frame) override { run_.frame(frame); }
  void finish(const cpu::Counts&, ToolOutput& output) override {
    if (const std::string note = run_.finish(); !note.empty()) output.notes.push_back(note);
  }

 private:
  PerfettoRun run_;
};

}  // namespace

ToolRow perfetto_tool() {
  return {.what = "the Perfetto file",
          .needs = ToolNeeds::kBoard,
          .lacks = "there are no frames, transfers and interrupts",
          .options = {{"--perfetto", "FILE", "Record a trace for https://ui.perfetto.dev in this file",
                       "a file name is needed"},
                      {.name = "--perfetto-tracks",
                       .type = "REGEX",
                       .help = "Record the tracks whose GROUP/TRACK matches this regular expression",
                       .fallback = "."},
                      {.name = "--perfetto-from",
                       .type = "TIME|window",
                       .help = "Record from this time since power-up on, or from the measured window on",
                       .fallback = "window"},
                      {.name = "--perfetto-for",
                       .type = "TIME",
                       .help = "Record for this long, with --perfetto-trigger for this long after it"},
                      {.name = "--perfetto-trigger",
                       .type = "EVENT",
                       .help = "End the recording with the first displayed frame of this kind",
                       .allowed = {"dropped", "repeated", "underflow"}},
                      {.name = "--perfetto-size",
                       .type = "MIB",
                       .help = "Largest size in MiB; requests and functions end when it is full, with "
                               "--perfetto-trigger the newest events are kept",
                       .fallback = "64",
                       .least = 1,
                       .most = 4096}},
          .make = [](const ToolValues& v, const ToolParts& parts) -> std::unique_ptr<Tool> {
            return std::make_unique<PerfettoTool>(request_of(v), parts);
          },
          .check = check};
}

}  // namespace fovea::app
