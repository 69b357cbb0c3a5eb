#include "sw/fovea/tools/tool.h"

#include "sw/fovea/files/side_output.h"

namespace fovea::app {

void Tools::make(std::span<const AskedTool> asked, const ToolParts& parts) {
  for (const AskedTool& a : asked)
    if (auto tool = a.row->make(a.values, parts)) made_.push_back({a.row->what, std::move(tool)});
}

void Tools::open_window() {
  for (const Made& m : made_) m.tool->open_window();
}

void Tools::close_window() {
  for (std::size_t i = made_.size(); i-- > 0;) made_[i].tool->close_window();
}

void Tools::settle(Picoseconds until) {
  for (const Made& m : made_) m.tool->settle(until);
}

void Tools::frame(const video::Frame& frame) {
  for (const Made& m : made_) m.tool->frame(frame);
}

void Tools::finish(const cpu::Counts& end, ToolOutput& output, LostOutputs& lost) {
  for (std::size_t i = made_.size(); i-- > 0;)
    side_output(made_[i].what, lost, [&] { made_[i].tool->finish(end, output); });
}

}  // namespace fovea::app
