#include "model/soc/platform_text.h"

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <map>

#include "model/memsys/memory_system.h"
#include "model/soc/edma_events.h"
#include "model/soc/memory_map.h"

namespace fovea::soc {
namespace {

std::string upper(std::string s) {
  std::transform(s.begin(), s.end(), s.begin(),
                 [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  return s;
}

std::string hex(std::uint32_t v) {
  char text[16];
  std::snprintf(text, sizeof text, "0x%08Xu", v);
  return text;
}

std::string define(const std::string& name, const std::string& value) {
  return "#define " + name + " " + value + "\n";
}

/// PINMUX3: stem PINMUX, number 3.
struct Numbered {
  std::string stem;
  unsigned number = 0;
};
Numbered split(const std::string& name) {
  const std::size_t last = name.find_last_not_of("0123456789");
  if (last == std::string::npos || last + 1 == name.size() || name.size() - last > 4) return {};
  return {name.substr(0, last + 1), static_cast<unsigned>(std::stoul(name.substr(last + 1)))};
}

using Series = std::map<std::string, std::vector<const Reg*>>;

/// Registers without fields that differ in their number only, three at least, at equal distances.
Series series_of(const RegBank& bank) {
  Series all;
  for (const Reg* r : bank.regs())
    if (const Numbered n = split(r->name()); !n.stem.empty()) all[n.stem].push_back(r);
  std::erase_if(all, [](const auto& entry) {
    const auto& regs = entry.second;
    if (regs.size() < 3 || !regs[0]->fields().empty()) return true;
    const std::uint32_t stride = regs[1]->offset() - regs[0]->offset();
    for (std::size_t i = 1; i < regs.size(); ++i)
      if (regs[i]->offset() - regs[i - 1]->offset() != stride || !regs[i]->fields().empty() ||
          split(regs[i]->name()).number != split(regs[i - 1]->name()).number + 1)
        return true;
    return false;
  });
  return all;
}

std::string registers_of(const std::string& block, std::uint32_t base, const RegBank& bank) {
  std::string out = define(block + "_REGISTERS", hex(base));
  const Series all = series_of(bank);
  for (const Reg* r : bank.regs()) {
    const Numbered n = split(r->name());
    if (const auto s = all.find(n.stem); !n.stem.empty() && s != all.end()) {
      const auto& regs = s->second;
      if (r != regs.front()) continue;
      const std::string index = n.number == 0 ? "(n)" : "((n) - " + std::to_string(n.number) + "u)";
      out +=
          define(block + "_" + n.stem + "(n)",
                 "(" + hex(base + r->offset()) + " + " +
                     std::to_string(regs[1]->offset() - regs[0]->offset()) + "u * " + index + ")");
      continue;
    }
    const std::string name = block + "_" + r->name();
    out += define(name, hex(base + r->offset()));
    for (const Field* f : r->fields()) out += define(name + "_" + f->name(), hex(f->mask()));
  }
  return out;
}


const char* name_of(BlockClock clock) {
  switch (clock) {
    case BlockClock::kEdma: return "SYSCLK4";
    case BlockClock::kAux: return "AUXCLK";
    case BlockClock::kUart1: return "SYSCLK4";
    case BlockClock::kVenc: return "VENC";
    case BlockClock::kNone: break;
  }
  return "–";
}

const char* name_of(Bridge bridge) {
  switch (bridge) {
    case Bridge::kCore: return "core";
    case Bridge::kVideo: return "video";
    case Bridge::kDma: break;
  }
  return "DMA";
}

std::string name_of(PrioritySource source) {
  const std::string_view name = priority_register(source);
  return name.empty() ? "a parameter" : std::string(name);
}

std::string in_hex(const char* format, std::uint32_t v) {
  char text[16];
  std::snprintf(text, sizeof text, format, v);
  return text;
}
std::string address(std::uint32_t v) { return in_hex("0x%08X", v); }
std::string size(std::uint32_t v) { return in_hex("0x%X", v); }

std::string interrupts_of(const Placement& row, const BusTarget& block) {
  const auto& irqs = row.irqs;
  const bool in_sequence = std::adjacent_find(irqs.begin(), irqs.end(), [](Irq a, Irq b) {
                             return a.second || b.second || b.input != a.input + 1;
                           }) == irqs.end();
  if (irqs.size() > 2 && in_sequence)
    return block.interrupts().front().name + "–" + block.interrupts().back().name + " " +
           std::to_string(irqs.front().input) + "–" + std::to_string(irqs.back().input);
  std::string out;
  for (std::size_t k = 0; k < row.irqs.size(); ++k) {
    out += (k ? ", " : "") + block.interrupts()[k].name + " " + std::to_string(row.irqs[k].input);
    if (row.irqs[k].second) out += " (second)";
  }
  return out.empty() ? "–" : out;
}

std::string block_row(const Placement& row, const BusTarget& block) {
  return "| `" + row.name + "` | " + row.title + " | " + address(row.base) + " | " +
         size(row.size) + " | " +
         (row.speed == bus::ConfigBus::Speed::kFast ? "fast" : "slow") + " | " +
         (block.clocks().empty() ? "–" : name_of(row.clock)) + " | " +
         (row.lpsc ? std::to_string(*row.lpsc) : "–") + " | " + interrupts_of(row, block) + " | " +
         std::to_string(block.bank().regs().size()) + (row.partly ? ", not all" : "") + " |\n";
}

const char* driver_of(const MasterInfo& m) {
  if (!m.load_allowed) return "a block";
  return m.priority == PrioritySource::kQueue    ? "a block, or a synthetic load too"
         : m.priority == PrioritySource::kImcop ? "a block with `engine`, or a synthetic load too"
                                                : "a synthetic load";
}

std::string master_rows() {
  std::string out;
  for (const MasterInfo& m : kMasters.rows) {
    out += "| " + std::to_string(index(m.id)) + " | `" + std::string(m.name) + "` | `" +
           std::string(m.statistics) + "` | " + name_of(m.bridge) + " | " + name_of(m.priority) +
           " | " + std::to_string(m.most_outstanding) + " | " +
           (m.partner ? "`" + std::string(master_info(*m.partner).name) + "`" : "–") + " | " +
           (m.on_chip ? "yes" : "no") + " | " + driver_of(m) + " |\n";
  }
  return out;
}

std::string event_rows() {
  std::string out;
  for (const EdmaEvent& e : kEdmaEvents)
    out += "| " + std::to_string(e.channel) + " | " + std::string(e.first) + " | " +
           (e.wire == EdmaEvent::Wire::kNone ? "not wired" : "yes") + " | " +
           (e.has_choice() ? std::to_string(e.bit) + ": " + std::string(e.second) : "–") + " |\n";
  return out;
}

std::string blocks_page(const Placements& rows, const std::string& block_rows) {
  std::string out = R"(# Blocks and memory masters of the DM365

Printed by `platform_text BLOCKS.md` from the rows in `dm365_blocks.cpp`, the declarations of the blocks, and
the tables in `model/common/masters.h` and `edma_events.h`; `soc.platform_text` fails when this file differs from
what they say.

## Blocks with registers

*Speed*: class of the register access (`bus.config.fast_latency`, `slow_latency`). *Clock*: of its function; `–`: none
of its own, or wired outside the rows. *Gate*: number of its power and sleep controller; `–`: always on. *Interrupts*:
inputs of the interrupt controller; *second*: where ARM_INTMUX selects between two blocks, the one of bit 1.

| name | block | base | bytes | speed | clock | gate | interrupts | registers |
|---|---|---|---|---|---|---|---|---|
)" + block_rows + R"(
## Documented, but not modelled

An access there ends in a bus error that names the block.

| base | bytes | block |
|---|---|---|
)";
  for (const MapEntry& e : memory_map(rows))
    if (e.block.empty())
      out += "| " + address(e.base) + " | " + size(e.size) + " | " + e.title + " |\n";
  out += R"(
## Memory masters

*Number*: in bus traces, and the order in which equal priorities take turns. *Statistics*: `bus.<name>.*`,
`ddr.<name>.*`. *Requests*: the most that it may have under way.

| number | name | statistics | bridge | priority | requests | partner | on chip | driven by |
|---|---|---|---|---|---|---|---|---|
)";
  out += master_rows() + R"(
## Events of the EDMA

*Event*: number of the channel. *Wired*: the source is modelled. *Second source*: the bit of EDMA_EVTMUX that selects
it; none of them is modelled, so that the channel gets no events then, with a warning.

Assumed: the inputs of the interrupt controller with which the events 8 (TINT4), 25 (GPIO9) and 47 (GPIO8) come. No
public list names them; ARM_INTMUX and the numbers of their neighbours leave one choice (`edma_events.h`).

| event | source | wired | second source |
|---|---|---|---|
)";
  return out + event_rows();
}

/// The blocks are made, but nothing runs.
struct NoHost : memsys::MemoryHost {
  void completed(MemRequest&) override {}
  Taken deliver(MemRequest&, bus::Slave, Picoseconds) override { return Taken::kRefused; }
  void rescheduled() override {}
};

}  // namespace

PlatformText platform_text(const Placements& rows) {
  PlatformText out;
  out.registers_h =
      "/* Registers of the DM365 that the model has: addresses, fields (as masks), power gates and\n"
      " * interrupts. Printed by the program platform_text from the declarations of the blocks; do not\n"
      " * edit. */\n"
      "#ifndef FOVEA_FIRMWARE_REGISTERS_H\n"
      "#define FOVEA_FIRMWARE_REGISTERS_H\n";
  ParamTree tree;
  BlockParams params(tree);
  for (const Placement& row : rows) row.declare(params);
  const bus::CrossbarParams crossbar;
  NoHost host;
  memsys::MemorySystem memory(crossbar, params.get<mem::DdrParams>(), {}, host, {});
  const PlacedBlocks placed(rows, params, memory);
  std::string block_rows;
  for (std::size_t i = 0; i < placed.size(); ++i) {
    const Placement& row = placed.row(i);
    const BusTarget& block = placed.block(i);
    const std::string name = upper(row.name);
    out.registers_h += "\n/* " + row.title + " */\n" + registers_of(name, row.base, block.bank());
    if (row.lpsc) out.registers_h += define("LPSC_" + name, std::to_string(*row.lpsc) + "u");
    for (std::size_t k = 0; k < row.irqs.size(); ++k)
      out.registers_h += define(
          "IRQ_" + name + (row.irqs.size() > 1 ? "_" + upper(block.interrupts()[k].name) : ""),
          std::to_string(row.irqs[k].input) + "u");
    block_rows += block_row(row, block);
  }
  out.registers_h += "\n#endif\n";
  out.blocks_md = blocks_page(rows, block_rows);
  return out;
}

}  // namespace fovea::soc
