#include "sw/fovea/probes/hazard_report.h"

#include <fmt/format.h>

#include "sw/fovea/tools/tool.h"

namespace fovea::app {
namespace {

std::string ms_text(Picoseconds t) {
  return fmt::format("{}.{:06} ms", t / kPsPerMs, t % kPsPerMs / 1000);
}

/// Of bytes in a buffer: the store that made them, or else where the core was.
std::string store_text(const cpu::Hazard& h, const std::string& place) {
  return h.stored ? fmt::format(", stored at {} at {},", place, ms_text(h.stored)) : "";
}
std::string core_text(const cpu::Hazard& h, const std::string& place) {
  return h.stored ? "" : fmt::format("; the core was at {}", place);
}

}  // namespace

std::string hazard_text(const cpu::Hazard& h, const Symbols& symbols) {
  using cpu::HazardKind;
  const auto master = master_info(h.master).name;
  const std::string place = symbols.place(h.pc), before = ms_text(h.before), after = ms_text(h.after);
  switch (h.kind) {
    case HazardKind::kStaleLoad:
      return fmt::format(
          "coherency hazard: the load at {} read 0x{:08x} at {} from a D-cache line that was filled at {}; "
          "{} wrote that memory at {}{}",
          place, h.address, after, ms_text(h.filled), master, before,
          h.before < h.filled ? ", and the fill passed that write in the SDRAM controller" : "");
    case HazardKind::kStaleFetch:
      return fmt::format(
          "coherency hazard: the instruction at {}, physical 0x{:08x}, was executed at {} from an I-cache line that "
          "was filled at {}; {} wrote that memory at {}",
          place, h.address, after, ms_text(h.filled), master, before);
    case HazardKind::kDirtyRead:
      return fmt::format(
          "coherency hazard: {} read 0x{:08x} at {}, but the bytes that were stored at {} at {} were still in a "
          "dirty D-cache line",
          master, h.address, after, place, before);
    case HazardKind::kBufferedRead:
      return fmt::format(
          "coherency hazard: {} read 0x{:08x} at {}, but newer bytes{} waited in the core's write buffer{}", master,
          h.address, after, store_text(h, place), core_text(h, place));
    case HazardKind::kOverwrite:
      if (h.before == h.after)
        return fmt::format(
            "coherency hazard: {} wrote 0x{:08x} at {}, and older bytes{} that waited in the core's write buffer go "
            "over them{}",
            master, h.address, after, store_text(h, place), core_text(h, place));
      return fmt::format(
          "coherency hazard: a D-cache line, dirty since the store at {}, was written back at {} over 0x{:08x}, "
          "which {} wrote at {}",
          place, after, h.address, master, before);
    case HazardKind::kCount: break;
  }
  return {};
}

HazardReport::HazardReport(cpu::Core& core, memsys::MemorySystem& memory, const Symbols& symbols)
    : memory_(memory), checker_(core) {
  checker_.on_place = [&symbols, diagnostics = DiagnosticsRef::current()](const cpu::Hazard& h) {
    diagnostics.guest(hazard_text(h, symbols));
  };
  arrivals_ = memory_.observe_arrivals(checker_);
  checker_.follow_moves();
  commands_ = memory_.controller().observe_commands(
      [](void* self, mem::Cmd cmd, unsigned, std::uint32_t, std::uint64_t) {
        static_cast<HazardReport*>(self)->command(cmd);
      },
      this);
}

void HazardReport::command(mem::Cmd cmd) {
  if (cmd != mem::Cmd::kRd && cmd != mem::Cmd::kWr && cmd != mem::Cmd::kRda && cmd != mem::Cmd::kWra) return;
  if (const mem::QueueEntry* e = memory_.controller().beginning())
    checker_.moved(e->request.master, e->request.write, memory_.map().ddr_base + e->request.address, e->request.bytes);
}

void HazardReport::collect(std::vector<StatRow>& rows) const {
  using cpu::HazardKind;
  const auto add = [&](const char* name, std::uint64_t n, const char* sentence) {
    rows.push_back({name, n, "1", std::string(sentence) + ", in the whole run"});
  };
  add("hazard.stale_loads", checker_.count(HazardKind::kStaleLoad),
      "loads from a D-cache line of bytes that another master has written since the line's fill");
  add("hazard.dirty_reads", checker_.count(HazardKind::kDirtyRead),
      "halves of dirty D-cache lines whose memory another master read");
  add("hazard.buffered_reads", checker_.count(HazardKind::kBufferedRead),
      "reads by another master of memory whose newer bytes waited in the core's write buffer");
  add("hazard.overwrites", checker_.count(HazardKind::kOverwrite),
      "halves of D-cache lines and buffered writes that went over newer bytes of another master");
  add("hazard.stale_fetches", checker_.count(HazardKind::kStaleFetch),
      "instructions executed from an I-cache line after another master had written them in memory");
  add("hazard.places", checker_.places(), "hazards that differ in kind, program address or master");
}

std::string HazardReport::failure() const {
  const std::uint64_t n = checker_.total();
  if (n == 0) return {};
  return fmt::format("{} coherency hazard{} at {} place{} (--hazards with --strict)", n, n == 1 ? "" : "s",
                     checker_.places(), checker_.places() == 1 ? "" : "s");
}

namespace {

class HazardTool final : public Tool {
 public:
  explicit HazardTool(const ToolParts& parts)
      : report_(*parts.core, *parts.memory, *parts.symbols) {}
  void settle(Picoseconds until) override { report_.settle(until); }
  void finish(const cpu::Counts&, ToolOutput& output) override {
    report_.collect(output.stats);
    output.fault = report_.failure();
  }

 private:
  HazardReport report_;
};

}  // namespace

ToolRow hazards_tool() {
  return {.what = "the check of coherency",
          .needs = ToolNeeds::kBoard,
          .lacks = "there is no DMA",
          .options = {{"--hazards", "",
                       "Warn where the core and a DMA master see different memory, because a line of the "
                       "D-cache is stale or dirty; with --strict that is an error at the end"}},
          .make = [](const ToolValues&, const ToolParts& parts) -> std::unique_ptr<Tool> {
            return std::make_unique<HazardTool>(parts);
          }};
}

}  // namespace fovea::app
