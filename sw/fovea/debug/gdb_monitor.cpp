// The `monitor` commands of the debugger.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>

#include "sw/fovea/debug/gdb_session.h"

namespace fovea::app {
namespace {

constexpr unsigned kProgramCounter = 15;

/// Parses a number in C syntax; empty for anything else.
std::optional<std::uint32_t> number(std::string_view text) {
  const bool hex = text.starts_with("0x") || text.starts_with("0X");
  if (hex) return hex_number(text.substr(2));
  std::uint32_t value = 0;
  const char* const end = text.data() + text.size();
  const auto [stopped, error] = std::from_chars(text.data(), end, value);
  return error == std::errc() && stopped == end && !text.empty() ? std::optional(value)
                                                                 : std::nullopt;
}

}  // namespace

std::string GdbSession::show_stats(const std::string& part) const {
  std::string out;
  for (const auto& row : views_.stats())
    if (row.name.find(part) != std::string::npos)
      out += fmt::format("{} = {} {}\n", row.name, number_text(row.value), row.unit);
  return out.empty() ? fmt::format("no statistic with '{}' in its name\n", part) : out;
}

std::string GdbSession::show_registers(const std::string& what) const {
  const std::size_t dot = what.find('.');
  const std::string block = what.substr(0, dot);
  const std::string name = dot == std::string::npos ? "" : what.substr(dot + 1);
  std::string out, known;
  for (const auto& b : views_.blocks) {
    known += (known.empty() ? "" : " ") + b.name;
    if (b.name != block) continue;
    for (const Reg* r : b.registers->regs()) {
      if (!name.empty() && r->name() != name) continue;
      std::uint32_t value = 0;
      if (b.registers->peek(r->offset(), value) != Access::kOk) continue;
      out += fmt::format("{}.{} = 0x{:08x}", b.name, r->name(), value);
      if (r->fields().size() > 1)
        for (const Field* f : r->fields())
          out += fmt::format(" {}={}", f->name(), (value & f->mask()) >> f->lsb());
      out += "\n";
    }
  }
  return out.empty() ? fmt::format("no such register; blocks: {}\n", known) : out;
}

/// BLOCK.REGISTER[.FIELD]=VALUE: a store by the core at this time, with all its effects. If a field
/// is given, the register's other fields keep their values, except that 0 is written to those where
/// a 1 clears or starts something.
std::string GdbSession::set_register(const std::string& what) {
  std::string_view rest = what;
  std::string_view path = take_until(rest, '=');
  const auto value = number(rest);
  const std::string block(take_until(path, '.')), name(take_until(path, '.')), field(path);
  if (!value || name.empty())
    return "monitor set BLOCK.REGISTER[.FIELD]=VALUE; the value is decimal or begins with 0x\n";
  const auto b = std::find_if(views_.blocks.begin(), views_.blocks.end(),
                              [&](const auto& v) { return v.name == block; });
  if (b == views_.blocks.end()) return show_registers(block);
  const auto& regs = b->registers->regs();
  const auto r =
      std::find_if(regs.begin(), regs.end(), [&](const Reg* x) { return x->name() == name; });
  if (r == regs.end()) return fmt::format("{} has no register {}\n", block, name);
  std::uint32_t word = *value;
  if (!field.empty()) {
    const auto& fields = (*r)->fields();
    const auto f = std::find_if(fields.begin(), fields.end(),
                                [&](const Field* x) { return x->name() == field; });
    if (f == fields.end()) return fmt::format("{}.{} has no field {}\n", block, name, field);
    const std::uint32_t most = (*f)->mask() >> (*f)->lsb();
    if (*value > most) return fmt::format("{}.{}.{}: allowed: 0 to {}\n", block, name, field, most);
    b->registers->peek((*r)->offset(), word);
    for (const Field* x : fields)
      if (x == *f || x->mode() == Mode::kW1c || x->mode() == Mode::kWo) word &= ~x->mask();
    word |= *value << (*f)->lsb();
  }
  const auto write = [registers = b->registers, gated = b->gated, offset = (*r)->offset(), word] {
    if (!gated || !gated()) registers->write(offset, 4, word);
  };
  if (failed_) return "the program has failed: nothing is written any more\n";
  if (asleep_)
    return fmt::format("written when the simulation comes to {} ns\n",
                       ns_text(views_.at_next_event(write)));
  if (views_.catch_up) {
    control_.settle_bus();
    views_.catch_up();
    control_.disturb();
  }
  write();
  return b->gated && b->gated()
             ? fmt::format("the clock of {} is gated: the write is lost\n", block)
             : show_registers(block + "." + name);
}

std::string GdbSession::core_line() const {
  const auto p = debug_.pending();
  std::string out =
      failed_   ? fmt::format("core: has failed at 0x{:08x}", debug_.reg(kProgramCounter))
      : asleep_ ? fmt::format("core: waits for {} since {} ns", waits_for_, ns_text(debug_.now()))
                : fmt::format("core: at the instruction at 0x{:08x}", debug_.reg(kProgramCounter));
  if (p.irq || p.fiq)
    out += fmt::format(
        "; {} asserted{}",
        p.irq && p.fiq ? "IRQ and FIQ"
        : p.irq        ? "IRQ"
                       : "FIQ",
        (p.irq && (debug_.cpsr() & 0x80u)) || (p.fiq && (debug_.cpsr() & 0x40u)) ? ", masked" : "");
  out += "\n";
  const auto line = [&out](const char* what, std::uint32_t address, Picoseconds until) {
    out +=
        fmt::format("    {} 0x{:08x} is being filled until {} ns\n", what, address, ns_text(until));
  };
  if (p.instruction_fill) line("I-cache line", p.instruction_line, p.instruction_fill);
  if (p.data_fill) line("D-cache line", p.data_line, p.data_fill);
  if (p.operands) out += fmt::format("    a result is ready at {} ns\n", ns_text(p.operands));
  if (p.writes) out += fmt::format("    write buffer: {} of 4 entries in use\n", p.writes);
  if (p.victim_bytes)
    out += fmt::format("    victim buffer: {} bytes for 0x{:08x}\n", p.victim_bytes, p.victim);
  if (p.write_on_bus)
    out += fmt::format("    a buffered write to 0x{:08x} is on the bus\n", p.write_address);
  return out;
}

/// A sleeping core is behind the others; a core that has failed may be ahead of them.
Picoseconds GdbSession::time_now() const {
  return asleep_ && views_.now ? std::max(views_.now(), debug_.now()) : debug_.now();
}

std::string GdbSession::where() {
  const Picoseconds now = time_now();
  if (asleep_ && views_.masters) {
    views_.settle();
  } else if (views_.masters) {
    control_.settle_bus();
  }
  std::string out = fmt::format("at {} ns\n", ns_text(now)) + core_line();
  return out +
         (views_.masters ? views_.masters->where(now) : "memory answers at once: no master waits\n");
}

std::string GdbSession::show_log(const std::string& what) {
  constexpr std::size_t kTail = 20;
  if (!views_.log) return "there are no registers to log\n";
  std::string_view rest = what;
  const std::string_view word = take_until(rest, ' ');
  if (word.empty() || number(word)) {
    if (views_.log->running()) return views_.log->text(word.empty() ? kTail : *number(word));
  } else if (word == "kept") {
    const auto most = number(rest);
    if (!most || *most == 0 || *most > kRegisterLogMost)
      return fmt::format("monitor registers kept COUNT; allowed: 1 to {}\n", kRegisterLogMost);
    views_.log->keep(*most);
    return fmt::format("the last {} accesses are kept\n", *most);
  } else if (word == "log" && rest == "off") {
    views_.log->stop();
  } else if (word == "log" && !rest.empty()) {
    try {
      views_.log->start({.pattern = std::string(rest), .kept = views_.log->kept()});
    } catch (const UserError& e) {
      return std::string(e.what()) + "\n";
    }
  } else {
    return "monitor registers [COUNT]          the last accesses\n"
           "monitor registers log REGEX|off    on BLOCK.REGISTER\n"
           "monitor registers kept COUNT       how many are kept\n";
  }
  return fmt::format("the log is {}\n", views_.log->running() ? "on" : "off");
}

std::string GdbSession::watch(const std::string& what) {
  constexpr const char* kUsage =
      "monitor watch                              lists them\n"
      "monitor watch clear\n"
      "monitor watch dma 0xADDR[,LENGTH] w|r|a [MASTER]   physical address\n";
  if (!views_.masters) return "there are no other masters\n";
  auto& list = views_.masters->watches;
  if (what == "clear") {
    std::erase_if(list, [](const GdbMasters::Watch& w) { return !w.packet; });
    return "";
  }
  if (!what.empty()) {
    std::string_view rest = what;
    if (take_until(rest, ' ') != "dma") return kUsage;
    std::string_view place = take_until(rest, ' ');
    const std::string_view kind = take_until(rest, ' ');
    const auto address = number(take_until(place, ','));
    const auto bytes = place.empty() ? std::optional(1u) : number(place);
    if (!address || !bytes || *bytes == 0 || kind.size() != 1 ||
        std::string_view("wra").find(kind) == std::string_view::npos)
      return kUsage;
    GdbMasters::Watch w;
    w.pa = w.va = *address;
    w.bytes = *bytes;
    w.kind = kind == "w"   ? GdbMasters::Kind::kWrite
             : kind == "r" ? GdbMasters::Kind::kRead
                           : GdbMasters::Kind::kAccess;
    if (!rest.empty()) {
      const auto found = std::find(kMasterNames.begin(), kMasterNames.end(), rest);
      if (found == kMasterNames.end())
        return fmt::format("no such master; allowed: {}\n", fmt::join(kMasterNames, " "));
      w.only = static_cast<Master>(found - kMasterNames.begin());
    }
    list.push_back(w);
  }
  std::string out;
  for (const auto& w : list)
    if (!w.packet)
      out += fmt::format("0x{:08x},{} {} {}\n", w.pa, w.bytes,
                         w.kind == GdbMasters::Kind::kWrite  ? "w"
                         : w.kind == GdbMasters::Kind::kRead ? "r"
                                                             : "a",
                         w.only ? kMasterNames[index(*w.only)] : "any master but the core");
  return out.empty() ? "nothing is watched\n" : out;
}

std::string GdbSession::watch_masters(const std::string& what) {
  if (what == "on" || what == "off")
    watch_masters_ = what == "on";
  else if (!what.empty())
    return "monitor watch-masters [on|off]\n";
  return fmt::format("watchpoints of the debugger {} accesses of the other masters\n",
                     watch_masters_ ? "see" : "do not see");
}

std::string GdbSession::monitor(const std::string& command) {
  const std::size_t space = command.find(' ');
  const std::string word = command.substr(0, space);
  std::string rest = space == std::string::npos ? "" : command.substr(space + 1);
  rest.erase(0, rest.find_first_not_of(' '));
  if (word == "stats") return show_stats(rest);
  if (word == "regs") return show_registers(rest);
  if (word == "set") return set_register(rest);
  if (word == "registers") return show_log(rest);
  if (word == "where") return where();
  if (word == "watch") return watch(rest);
  if (word == "watch-masters") return watch_masters(rest);
  if (word == "time")
    return fmt::format("{} ns, core clock {}\n", ns_text(time_now()), core_.clock_count());
  if (word == "params") {
    std::string out;
    for (const ParamBase* p : views_.params->all())
      if (p->key().find(rest) != std::string::npos)
        out += fmt::format("{} = {}\n", p->key(), p->text());
    return out.empty() ? fmt::format("no parameter with '{}' in its key\n", rest) : out;
  }
  const bool asked = word.empty() || word == "help";
  return (asked ? "" : fmt::format("no command '{}'; allowed:\n", word)) +
         "monitor stats [PART]    statistics now\n"
         "monitor params [PART]   parameters\n"
         "monitor regs BLOCK[.REGISTER]   registers of a peripheral, with fields\n"
         "monitor set BLOCK.REGISTER[.FIELD]=VALUE   as a store of the core\n"
         "monitor registers [COUNT]|log REGEX|log off|kept COUNT   accesses to peripherals\n"
         "monitor where           which master waits for whom\n"
         "monitor watch dma 0xADDR[,LENGTH] w|r|a [MASTER]   stops for other masters\n"
         "monitor watch-masters [on|off]   whether watchpoints see other masters\n"
         "monitor time            simulated time\n";
}

}  // namespace fovea::app
