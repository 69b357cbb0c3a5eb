// `--writers ADDRESS`: who wrote a line of memory. The example of model/howto/add-an-option.md.
#include <fmt/format.h>

#include <array>
#include <memory>

#include "model/common/mem_observer.h"
#include "sw/fovea/program/exec_program.h"
#include "sw/fovea/tools/tool.h"

namespace fovea::app {
namespace {

constexpr std::uint32_t kLine = 32;  // bytes

std::uint32_t address_of(const ToolValues& v) { return parse_address("--writers", v.text("--writers")); }

class WritersTool final : public Tool, private MemObserver {
 public:
  WritersTool(std::uint32_t address, const ToolParts& parts)
      : line_(address / kLine), name_of_(parts.name_of), observing_(parts.observe(*this)) {}

  void finish(const cpu::Counts&, ToolOutput& output) override {
    for (const MasterInfo& m : kMasters.rows)
      if (const std::uint64_t n = writes_[index(m.id)])
        output.notes.push_back(fmt::format("{} wrote the line at 0x{:08x} {} times", name_of_(m.id), line_ * kLine, n));
  }

 private:
  void submitted(const MemRequest&, bool) override {}
  void responded(const MemRequest& r) override {
    if (r.write && r.address / kLine <= line_ && (r.address + r.bytes - 1) / kLine >= line_) ++writes_[index(r.master)];
  }

  std::uint32_t line_;
  std::function<std::string(Master)> name_of_;
  std::array<std::uint64_t, kMasterCount> writes_{};
  Subscription observing_;
};

}  // namespace

ToolRow writers_tool() {
  return {.what = "the list of writers",
          .needs = ToolNeeds::kMemory,
          .lacks = "there is no SDRAM",
          .options = {{"--writers", "ADDRESS",
                       "Say which masters wrote the 32 bytes around this address, and how often",
                       "an address is needed"}},
          .make = [](const ToolValues& v, const ToolParts& parts) -> std::unique_ptr<Tool> {
            return std::make_unique<WritersTool>(address_of(v), parts);
          },
          .check = [](const ToolValues& v, bool) { address_of(v); }};
}

}  // namespace fovea::app
