#include "sw/fovea/gdb_session.h"

#include <fmt/format.h>

#include <algorithm>

namespace fovea::app {
namespace {

// GDB's numbers: r0 to r15, and 25 for the CPSR since the days of the FPA.
constexpr unsigned kPc = 15, kCpsr = 25, kSpsr = 26, kSystem = 27;

cpu::CoreControl::Watch watch_of(GdbTarget::Point kind) {
  using W = cpu::CoreControl::Watch;
  return kind == GdbTarget::Point::kWrite ? W::kWrite
         : kind == GdbTarget::Point::kRead ? W::kRead : W::kAccess;
}

}  // namespace

GdbSession::GdbSession(std::uint16_t port, cpu::Core& core, cpu::DebugMemory& memory,
                       GdbViews views, const std::atomic<bool>& stop, std::ostream& notes)
    : core_(core),
      debug_(core, memory),
      control_(core, debug_),
      views_(std::move(views)),
      server_(port, *this, stop) {
  for (unsigned r = 0; r <= kPc; ++r) numbers_.push_back(r);
  numbers_.push_back(kCpsr);
  numbers_.push_back(kSpsr);
  for (unsigned k = 0; k < cpu::CoreDebug::system_registers().size(); ++k)
    numbers_.push_back(kSystem + k);
  control_.on_stop = [this](const cpu::CoreControl::Stop& s) { stopped(s); };
  control_.request_halt();
  notes << fmt::format("fovea: waiting for gdb: target remote 127.0.0.1:{}\n", server_.port())
        << std::flush;
}

void GdbSession::stopped(const cpu::CoreControl::Stop& s) {
  using Reason = cpu::CoreControl::Stop::Reason;
  GdbStop stop;
  stop.address = s.address;
  switch (s.reason) {
    case Reason::kRequest: stop.reason = GdbStop::Reason::kRequest; break;
    case Reason::kStep: stop.reason = GdbStop::Reason::kStep; break;
    case Reason::kBreakpoint: {
      const auto found = breakpoints_.find(core_.reg(kPc));
      const bool hardware = found != breakpoints_.end() && found->second.software == 0;
      stop.reason = hardware ? GdbStop::Reason::kHardware : GdbStop::Reason::kSoftware;
      break;
    }
    case Reason::kWatch:
      stop.reason = s.watch == cpu::CoreControl::Watch::kWrite  ? GdbStop::Reason::kWrite
                    : s.watch == cpu::CoreControl::Watch::kRead ? GdbStop::Reason::kRead
                                                                : GdbStop::Reason::kAccess;
      break;
  }
  go_on(server_.serve(stop));
}

void GdbSession::serve_asleep() {
  control_.cancel_halt();
  go_on(server_.serve({}));
}

void GdbSession::go_on(const GdbResume& resume) {
  switch (resume.kind) {
    case GdbResume::Kind::kContinue: break;
    case GdbResume::Kind::kStep: control_.step(resume.from, resume.to); break;
    case GdbResume::Kind::kKill:
      killed_ = true;
      control_.clear();
      core_.request_stop();
      break;
  }
}

void GdbSession::look() {
  if (!control_.halt_pending() && server_.wants_halt()) control_.request_halt();
}

std::optional<std::uint32_t> GdbSession::read_register(unsigned n) const {
  if (n <= kPc) return debug_.reg(n);
  if (n == kCpsr) return debug_.cpsr();
  if (n == kSpsr) return debug_.spsr();
  const auto system = cpu::CoreDebug::system_registers();
  if (n >= kSystem && n - kSystem < system.size())
    return debug_.system_register(system[n - kSystem]);
  return std::nullopt;
}

/// SPSR and CP15 are for looking: changing them behind the program's back would need its caches and
/// TLB to follow.
bool GdbSession::write_register(unsigned n, std::uint32_t value) {
  if (n <= kPc)
    debug_.set_reg(n, value);
  else if (n == kCpsr)
    debug_.set_cpsr(value);
  else
    return false;
  return true;
}

bool GdbSession::set_point(Point kind, std::uint32_t address, std::uint32_t bytes) {
  if (kind == Point::kSoftware || kind == Point::kHardware) {
    auto& kinds = breakpoints_[address];
    (kind == Point::kSoftware ? kinds.software : kinds.hardware) = 1;
    control_.set_breakpoint(address);
    return true;
  }
  if (bytes == 0) return false;
  control_.set_watch(address, bytes, watch_of(kind));
  return true;
}

bool GdbSession::clear_point(Point kind, std::uint32_t address, std::uint32_t bytes) {
  if (kind == Point::kSoftware || kind == Point::kHardware) {
    const auto found = breakpoints_.find(address);
    if (found == breakpoints_.end()) return true;
    auto& kinds = found->second;
    (kind == Point::kSoftware ? kinds.software : kinds.hardware) = 0;
    if (kinds.software + kinds.hardware == 0) {
      breakpoints_.erase(found);
      control_.clear_breakpoint(address);
    }
    return true;
  }
  control_.clear_watch(address, bytes, watch_of(kind));
  return true;
}

void GdbSession::clear_all_points() {
  breakpoints_.clear();
  control_.clear();
}

std::string GdbSession::target_xml() const {
  std::string out =
      "<?xml version=\"1.0\"?>\n<!DOCTYPE target SYSTEM \"gdb-target.dtd\">\n<target>\n"
      "<architecture>armv5te</architecture>\n<feature name=\"org.gnu.gdb.arm.core\">\n";
  const auto reg = [&out](const std::string& name, unsigned number, const char* type) {
    out += fmt::format("<reg name=\"{}\" bitsize=\"32\" regnum=\"{}\" type=\"{}\"/>\n", name,
                       number, type);
  };
  for (unsigned r = 0; r < 13; ++r) reg(fmt::format("r{}", r), r, "uint32");
  reg("sp", 13, "data_ptr");
  reg("lr", 14, "uint32");
  reg("pc", kPc, "code_ptr");
  reg("cpsr", kCpsr, "uint32");
  out += "</feature>\n<feature name=\"fovea.arm926.system\">\n";
  reg("spsr", kSpsr, "uint32");
  unsigned number = kSystem;
  for (const auto& r : cpu::CoreDebug::system_registers()) reg(r.name, number++, "uint32");
  return out + "</feature>\n</target>\n";
}

/// All addresses, cut at the ends of the physical RAM: GDB refuses what the map leaves out, and a
/// program with its MMU on may have memory anywhere.
std::string GdbSession::memory_map_xml() const {
  constexpr std::uint64_t kEnd = std::uint64_t{1} << 32;
  std::vector<std::uint64_t> cuts = {0, kEnd};
  for (const auto& m : views_.memory) {
    cuts.push_back(m.base);
    cuts.push_back(m.end);
  }
  std::sort(cuts.begin(), cuts.end());
  cuts.erase(std::unique(cuts.begin(), cuts.end()), cuts.end());
  std::string out =
      "<?xml version=\"1.0\"?>\n<!DOCTYPE memory-map PUBLIC \"+//IDN gnu.org//DTD GDB Memory Map "
      "V1.0//EN\" \"http://sourceware.org/gdb/gdb-memory-map.dtd\">\n<memory-map>\n";
  for (std::size_t i = 0; i + 1 < cuts.size(); ++i)
    out += fmt::format("<memory type=\"ram\" start=\"0x{:x}\" length=\"0x{:x}\"/>\n", cuts[i],
                       cuts[i + 1] - cuts[i]);
  return out + "</memory-map>\n";
}

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
  for (const auto& [called, bank] : views_.blocks) {
    known += (known.empty() ? "" : " ") + called;
    if (called != block) continue;
    for (const Reg* r : bank->regs()) {
      if (!name.empty() && r->name() != name) continue;
      std::uint32_t value = 0;
      if (bank->peek(r->offset(), value) != Access::kOk) continue;
      out += fmt::format("{}.{} = 0x{:08x}", called, r->name(), value);
      if (r->fields().size() > 1)
        for (const Field* f : r->fields())
          out += fmt::format(" {}={}", f->name(), (value & f->mask()) >> f->lsb());
      out += "\n";
    }
  }
  return out.empty() ? fmt::format("no such register; blocks: {}\n", known) : out;
}

std::string GdbSession::monitor(const std::string& command) {
  const std::size_t space = command.find(' ');
  const std::string word = command.substr(0, space);
  std::string rest = space == std::string::npos ? "" : command.substr(space + 1);
  rest.erase(0, rest.find_first_not_of(' '));
  if (word == "stats") return show_stats(rest);
  if (word == "regs") return show_registers(rest);
  if (word == "time")
    return fmt::format("{} ns, core clock {}\n", ns_text(debug_.now()), core_.clock_count());
  if (word == "params") {
    std::string out;
    for (const ParamBase* p : views_.params->all())
      if (p->key().find(rest) != std::string::npos)
        out += fmt::format("{} = {}\n", p->key(), p->text());
    return out.empty() ? fmt::format("no parameter with '{}' in its key\n", rest) : out;
  }
  return "monitor stats [PART]    statistics now\n"
         "monitor params [PART]   parameters\n"
         "monitor regs BLOCK[.REGISTER]   registers of a peripheral, with fields\n"
         "monitor time            simulated time\n";
}

}  // namespace fovea::app
