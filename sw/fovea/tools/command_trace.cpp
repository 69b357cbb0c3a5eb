#include "sw/fovea/tools/command_trace.h"

#include <algorithm>
#include <charconv>
#include <string>

#include "sw/fovea/tools/tool.h"

namespace fovea::app {
namespace {

/// What a line shows of a command.
struct Shown {
  std::string_view name;
  bool bank = false, row = false;
};

Shown shown(mem::Cmd cmd) {
  switch (cmd) {
    case mem::Cmd::kAct: return {"ACT", true, true};
    case mem::Cmd::kPre: return {"PRE", true, false};
    case mem::Cmd::kPreAll: return {"PREA"};
    case mem::Cmd::kRd: return {"RD", true, true};
    case mem::Cmd::kWr: return {"WR", true, true};
    case mem::Cmd::kRda: return {"RDA", true, true};
    case mem::Cmd::kWra: return {"WRA", true, true};
    case mem::Cmd::kPde: return {"PDE"};
    case mem::Cmd::kPdx: return {"PDX"};
    case mem::Cmd::kSre: return {"SRE"};
    case mem::Cmd::kSrx: return {"SRX"};
    default: return {"REF"};
  }
}

}  // namespace

CommandTrace::CommandTrace(const std::filesystem::path& file)
    : file_(file, "--command-trace", "a command trace",
            [](std::string_view first) { return first.starts_with(kHeader); }) {
  file_.write(kHeader);
}

void CommandTrace::begin(mem::DdrController& controller, Picoseconds at) {
  const mem::DdrDevice& device = controller.device();
  const std::uint64_t next = controller.running() ? controller.ddr_clock().edge_after(at) : 0;
  for (unsigned bank = 0; bank < mem::DdrDevice::kMaxBanks; ++bank)
    if (device.row(bank) != mem::DdrDevice::kClosed)
      line(next ? next - 1 : 0, "OPEN", true, bank, true, device.row(bank));
  listening_ = controller.observe_commands(&CommandTrace::hook, this);
}

void CommandTrace::end() { listening_.reset(); }

void CommandTrace::finish() {
  end();
  if (failure_) std::rethrow_exception(failure_);
  file_.commit();
}

void CommandTrace::hook(void* self, mem::Cmd cmd, unsigned bank, std::uint32_t row,
                        std::uint64_t clock) {
  const Shown s = shown(cmd);
  static_cast<CommandTrace*>(self)->line(clock, s.name, s.bank, bank, s.row, row);
}

void CommandTrace::line(std::uint64_t clock, std::string_view command, bool bank,
                        unsigned bank_number, bool row, std::uint32_t row_number) {
  if (failure_) return;
  char text[64];
  char* const end_of_text = text + sizeof text;
  char* to = std::to_chars(text, end_of_text, clock).ptr;
  *to++ = ',';
  to = std::copy(command.begin(), command.end(), to);
  *to++ = ',';
  if (bank) to = std::to_chars(to, end_of_text, bank_number).ptr;
  *to++ = ',';
  if (row) to = std::to_chars(to, end_of_text, row_number).ptr;
  *to++ = '\n';
  try {
    file_.write(std::string_view(text, static_cast<std::size_t>(to - text)));
  } catch (...) {
    failure_ = std::current_exception();
  }
}

namespace {

class CommandTraceTool final : public Tool {
 public:
  CommandTraceTool(const std::string& file, const ToolParts& parts) : trace_(file), parts_(parts) {}
  void open_window() override { trace_.begin(*parts_.controller, parts_.now()); }
  void close_window() override { trace_.end(); }
  void finish(const cpu::Counts&, ToolOutput&) override { trace_.finish(); }

 private:
  CommandTrace trace_;
  ToolParts parts_;
};

}  // namespace

ToolRow command_trace_tool() {
  return {.what = "the command trace",
          .needs = ToolNeeds::kMemory,
          .lacks = "there is no SDRAM",
          .options = {{"--command-trace", "FILE",
                       "Write the commands on the SDRAM's bus to this file: clock,command,bank,row",
                       "a file name is needed"}},
          .make = [](const ToolValues& v, const ToolParts& parts) -> std::unique_ptr<Tool> {
            return std::make_unique<CommandTraceTool>(v.text("--command-trace"), parts);
          }};
}

}  // namespace fovea::app
