// `--waves FILE` is the key waves.file, for which there must be an RTL.
#include <fmt/format.h>

#include "model/common/check.h"
#include "sw/fovea/config/experiment.h"
#include "sw/fovea/files/checked_file.h"
#include "sw/fovea/tools/tool.h"

namespace fovea::app {
namespace {

void set_waves(const ToolValues& v, const ParamSet& params, Experiment& experiment) {
  const std::string file = v.text("--waves");
  experiment.override_with("waves.file=" + file);
  const ParamBase* engine = params.find("engine");
  if (!engine || engine->text() == "none" || engine->text() == "tlm")
    throw UserError(fmt::format("--waves '{}': it records the RTL of the remap engine, and key 'engine' is {}; "
                                "allowed: rtl, both, both_tlm",
                                one_line(file), engine ? engine->text() : "unknown"));
}

}  // namespace

ToolRow waves_tool() {
  return {.what = "the waveforms",
          .needs = ToolNeeds::kBoard,
          .lacks = "there is no remap engine",
          .options = {{"--waves", "FILE",
                       "Write the waveforms of the RTL remap engine (engine = rtl, both, both_tlm) to this FST file; "
                       "the keys waves.* choose which part",
                       "a file name is needed"}},
          .make = [](const ToolValues&, const ToolParts&) -> std::unique_ptr<Tool> { return nullptr; },
          .keys = set_waves};
}

}  // namespace fovea::app
