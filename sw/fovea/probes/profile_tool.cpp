#include "sw/fovea/probes/run_profile.h"
#include "sw/fovea/tools/tool.h"

namespace fovea::app {
namespace {

void leave(ToolOutput&& profile, ToolOutput& output) {
  for (ResultFile& f : profile.files) output.files.push_back(std::move(f));
  output.table += profile.table;
}

class BoardProfileTool final : public Tool {
 public:
  explicit BoardProfileTool(const ToolParts& parts)
      : profile_(*parts.board, parts.whole_run, parts.programs), parts_(parts) {}
  void open_window() override { profile_.window(true); }
  void close_window() override { profile_.window(false); }
  void frame(const video::Frame& frame) override { profile_.frame(frame.times); }
  void finish(const cpu::Counts& end, ToolOutput& output) override {
    ToolOutput made = profile_result(profile_.finish(end, parts_.program), parts_.programs);
    made.files.push_back({"frame_parts.csv", profile_.frame_parts()});
    leave(std::move(made), output);
  }

 private:
  RunProfile profile_;
  ToolParts parts_;
};

/// Of a core without a board: one phase, the run.
class CoreProfileTool final : public Tool {
 public:
  explicit CoreProfileTool(const ToolParts& parts) : core_(*parts.core), parts_(parts) {
    core_.start_profile().stacks.set_functions(program_functions(parts.programs));
  }
  void finish(const cpu::Counts& end, ToolOutput& output) override {
    core_.finish_profile(end);
    const cpu::ClockProfile& p = *core_.profile();
    ProfileData data;
    data.program = parts_.program;
    data.regions = core_.regions().names();
    data.phases = {{"run", true, p.rows(0), p.stacks.paths_of(0)}};
    add_stacks(data, p.stacks);
    data.masked = p.mask.longest();
    leave(profile_result(data, parts_.programs), output);
  }

 private:
  cpu::Core& core_;
  ToolParts parts_;
};

std::unique_ptr<Tool> make(const ToolValues&, const ToolParts& parts) {
  if (parts.board) return std::make_unique<BoardProfileTool>(parts);
  return std::make_unique<CoreProfileTool>(parts);
}

}  // namespace

ToolRow profile_tool() {
  return {.what = "the profile",
          .needs = ToolNeeds::kCore,
          .lacks = "",
          .options = {{"--profile", "",
                       "Say where each clock of the core went, by function, line, cause and culprit: "
                       "profile.csv, .folded, .callgrind and .txt; changes no other result"}},
          .make = make};
}

}  // namespace fovea::app
