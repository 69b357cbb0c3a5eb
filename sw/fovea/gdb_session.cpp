#include "sw/fovea/gdb_session.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace fovea::app {
namespace {

// GDB's numbers: r0 to r15, and 25 for the CPSR since the days of the FPA.
constexpr unsigned kPc = 15, kCpsr = 25, kSpsr = 26, kSystem = 27, kBanked = 64;

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
  for (unsigned k = 0; k < cpu::CoreDebug::banked_registers().size(); ++k)
    numbers_.push_back(kBanked + k);
  if (views_.masters) views_.masters->on_hit = [this](const GdbMasters::Hit& h) { noticed(h); };
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
    case Reason::kTime:
      stop = take_hit();
      break;
    case Reason::kWatch:
      stop.reason = s.watch == cpu::CoreControl::Watch::kWrite  ? GdbStop::Reason::kWrite
                    : s.watch == cpu::CoreControl::Watch::kRead ? GdbStop::Reason::kRead
                                                                : GdbStop::Reason::kAccess;
      break;
  }
  go_on(serve(stop));
}

GdbResume GdbSession::serve(const GdbStop& stop) {
  serving_ = true;
  const GdbResume resume = server_.serve(stop);
  serving_ = false;
  return resume;
}

/// A debugger that finds its watchpoint hit steps over the instruction that it takes for the cause.
/// A sleeping core has none: that step ends where it began.
void GdbSession::serve_asleep(const GdbStop& stop) {
  const bool watched = stop.reason != GdbStop::Reason::kRequest;
  control_.cancel_halt();
  asleep_ = true;
  GdbResume resume = serve(stop);
  if (watched && resume.kind == GdbResume::Kind::kStep)
    resume = serve({.reason = GdbStop::Reason::kStep});
  asleep_ = false;
  go_on(resume);
}

/// Of several accesses the first one stops.
void GdbSession::noticed(const GdbMasters::Hit& hit) {
  if (hit_ && hit_->at <= hit.at) return;
  hit_ = hit;
  control_.stop_after(hit.at);
  views_.pause_at(hit.at);
}

GdbStop GdbSession::take_hit() {
  const GdbMasters::Hit h = *std::exchange(hit_, std::nullopt);
  control_.stop_after(kNever);
  GdbStop stop{.reason = GdbStop::Reason::kOther, .address = h.va};
  stop.note = fmt::format("{} {} 0x{:08x} at {} ns\n", kMasterNames[index(h.master)],
                          h.write ? "wrote" : "read", h.pa, ns_text(h.at));
  if (h.watch.packet)
    stop.reason = h.watch.kind == GdbMasters::Kind::kWrite  ? GdbStop::Reason::kWrite
                  : h.watch.kind == GdbMasters::Kind::kRead ? GdbStop::Reason::kRead
                                                            : GdbStop::Reason::kAccess;
  return stop;
}

/// Other masters know physical addresses only: a watchpoint is where its pages are when the core
/// goes on.
void GdbSession::arm_watches() {
  if (!views_.masters) return;
  auto& list = views_.masters->watches;
  std::erase_if(list, [](const GdbMasters::Watch& w) { return w.packet; });
  constexpr std::uint32_t kTinyPage = 1024;
  for (const Range& r : watch_masters_ ? watched_ : std::vector<Range>()) {
    bool extend = false;
    for (std::uint32_t done = 0; done < r.bytes;) {
      const std::uint32_t va = r.va + done;
      const std::uint32_t n = std::min(r.bytes - done, kTinyPage - (va & (kTinyPage - 1)));
      done += n;
      const auto pa = debug_.physical(va);
      if (!pa) {
        extend = false;
        continue;
      }
      if (extend && list.back().pa + list.back().bytes == *pa) {
        list.back().bytes += n;
        continue;
      }
      list.push_back({*pa, n, va, watch_of(r.kind), std::nullopt, true});
      extend = true;
    }
  }
  control_.follow_bus(!list.empty());
}

void GdbSession::go_on(const GdbResume& resume) {
  arm_watches();
  switch (resume.kind) {
    case GdbResume::Kind::kContinue: break;
    case GdbResume::Kind::kStep: control_.step(resume.from, resume.to); break;
    case GdbResume::Kind::kKill:
      killed_ = true;
      clear_all_points();
      core_.request_stop();
      break;
  }
}

void GdbSession::look(bool asleep) {
  if (serving_) return;  // a command lets the others catch up
  // Also a core that comes to no boundary for a whole turn stands where it is.
  const bool stuck = halt_seen_ && control_.halt_pending();
  if (!control_.halt_pending() && server_.wants_halt()) control_.request_halt();
  halt_seen_ = control_.halt_pending();
  if (asleep && hit_ && hit_->at <= views_.now())
    serve_asleep(take_hit());
  else if (halt_seen_ && (asleep || stuck))
    serve_asleep({});
  else
    return;
  halt_seen_ = false;
}

std::optional<std::uint32_t> GdbSession::read_register(unsigned n) const {
  if (n <= kPc) return debug_.reg(n);
  if (n == kCpsr) return debug_.cpsr();
  if (n == kSpsr) return debug_.spsr();
  const auto system = cpu::CoreDebug::system_registers();
  if (n >= kSystem && n - kSystem < system.size())
    return debug_.system_register(system[n - kSystem]);
  const auto banked = cpu::CoreDebug::banked_registers();
  if (n >= kBanked && n - kBanked < banked.size())
    return debug_.banked_register(banked[n - kBanked]);
  return std::nullopt;
}

bool GdbSession::write_register(unsigned n, std::uint32_t value) {
  const auto system = cpu::CoreDebug::system_registers();
  const auto banked = cpu::CoreDebug::banked_registers();
  if (n <= kPc)
    debug_.set_reg(n, value);
  else if (n == kCpsr)
    debug_.set_cpsr(value);
  else if (n == kSpsr)
    return debug_.set_spsr(value);
  else if (n >= kSystem && n - kSystem < system.size())
    debug_.set_system_register(system[n - kSystem], value);
  else if (n >= kBanked && n - kBanked < banked.size())
    debug_.set_banked_register(banked[n - kBanked], value);
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
  watched_.push_back({address, bytes, kind});
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
  const auto found = std::find(watched_.begin(), watched_.end(), Range{address, bytes, kind});
  if (found != watched_.end()) watched_.erase(found);
  return true;
}

void GdbSession::clear_all_points() {
  breakpoints_.clear();
  watched_.clear();
  if (views_.masters) views_.masters->watches.clear();
  hit_.reset();
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
  out += "</feature>\n<feature name=\"fovea.arm926.banked\">\n";
  number = kBanked;
  for (const auto& r : cpu::CoreDebug::banked_registers()) reg(r.name, number++, "uint32");
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

}  // namespace fovea::app
