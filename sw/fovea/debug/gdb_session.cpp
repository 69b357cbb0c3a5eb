#include "sw/fovea/debug/gdb_session.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "model/common/check.h"

namespace fovea::app {
namespace {

// GDB's register numbers: r0 to r15 and, for historical reasons (FPA), 25 for the CPSR.
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
  if (views_.masters) views_.masters->on_hit = [this](const GdbMasters::Hit& h) { add_hit(h); };
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
  const bool no_instruction = s.reason == Reason::kTime && stop.reason != GdbStop::Reason::kOther;
  const bool over_watched = s.reason == Reason::kWatch && !s.past;
  GdbResume resume = serve(stop);
  if (no_instruction && resume.kind == GdbResume::Kind::kStep)
    resume = serve({.reason = GdbStop::Reason::kStep});
  go_on(resume, over_watched && resume.kind == GdbResume::Kind::kStep);
}

/// When a watchpoint is hit, a debugger removes all watchpoints and steps over the instruction that
/// it takes for the cause. After another master's access there is no such instruction, so this step
/// ends at once, both at an instruction boundary and for a sleeping core.
GdbResume GdbSession::serve(const GdbStop& stop) {
  serving_ = true;
  watched_at_stop_ = watched_;
  const GdbResume resume = server_.serve(stop);
  serving_ = false;
  return resume;
}

void GdbSession::serve_asleep(const GdbStop& stop) {
  using Reason = GdbStop::Reason;
  const bool watched = stop.reason == Reason::kWrite || stop.reason == Reason::kRead ||
                       stop.reason == Reason::kAccess;
  control_.cancel_halt();
  asleep_ = true;
  GdbResume resume = serve(stop);
  if (watched && resume.kind == GdbResume::Kind::kStep) resume = serve({.reason = Reason::kStep});
  asleep_ = false;
  go_on(resume);
}

void GdbSession::failed(const std::string& why) {
  if (!server_.attached() || killed_) return;
  control_.clear();
  debug_.back_to_failure();
  asleep_ = failed_ = true;
  if (serve({.reason = GdbStop::Reason::kFailed, .note = why + "\n"}).kind ==
      GdbResume::Kind::kKill)
    killed_ = true;
}

/// Hits are kept until they are reported: more may become known before the first one stops the
/// core.
void GdbSession::add_hit(const GdbMasters::Hit& hit) {
  const bool first = hit.at < next_hit();
  hits_.push_back(hit);
  if (first) wait_for_hit();
}

Picoseconds GdbSession::next_hit() const {
  Picoseconds at = kNever;
  for (const auto& h : hits_) at = std::min(at, h.at);
  return at;
}

void GdbSession::wait_for_hit() {
  const Picoseconds at = next_hit();
  control_.stop_after(at);
  if (at != kNever) views_.pause_at(at);
}

/// Removes the earliest hit. The debugger reads memory as the core sees it. If the core's view does
/// not show the write, the debugger would find no change, so a different stop reason is reported,
/// and a text on its console explains it.
GdbStop GdbSession::take_hit() {
  FOVEA_CHECK(!hits_.empty(), "a stop for another master's access has its access");
  const auto first = std::min_element(hits_.begin(), hits_.end(),
                                      [](const auto& a, const auto& b) { return a.at < b.at; });
  const GdbMasters::Hit h = *first;
  hits_.erase(first);
  // The debugger attributes an address to all its watchpoints that contain it.
  if (h.watch.packet)
    std::erase_if(hits_, [&](const GdbMasters::Hit& o) {
      return o.watch.packet && o.at == h.at && o.master == h.master &&
             h.va - o.watch.va < o.watch.bytes;
    });
  control_.stop_after(kNever);
  GdbStop stop{.reason = GdbStop::Reason::kOther, .address = h.va};
  stop.note = fmt::format("{} {} 0x{:08x} at {} ns\n", kMasterNames[index(h.master)],
                          h.write ? "wrote" : "read", h.pa, ns_text(h.at));
  const bool hidden = h.write && hidden_from_core(h);
  if (hidden)
    stop.note += "the core does not see it: its D-cache or buffers hold other bytes there\n";
  if (h.watch.packet && !(hidden && h.watch.kind == GdbMasters::Kind::kWrite))
    stop.reason = h.watch.kind == GdbMasters::Kind::kWrite  ? GdbStop::Reason::kWrite
                  : h.watch.kind == GdbMasters::Kind::kRead ? GdbStop::Reason::kRead
                                                            : GdbStop::Reason::kAccess;
  return stop;
}

bool GdbSession::hidden_from_core(const GdbMasters::Hit& h) {
  if (!h.watch.packet) return false;  // a physical address
  std::vector<std::uint8_t> seen(h.bytes), behind(h.bytes);
  return debug_.read(h.va, seen) && debug_.read_behind(h.pa, behind) && seen != behind;
}

/// Other masters use physical addresses only: a watchpoint applies to the pages as they are mapped
/// when the core continues. While the debugger steps over a hit with all its watchpoints removed,
/// they remain active for the other masters.
void GdbSession::arm_watches(bool over_watched) {
  if (!views_.masters) return;
  const auto& ranges = over_watched && watched_.empty() ? watched_at_stop_ : watched_;
  auto& list = views_.masters->watches;
  std::erase_if(list, [](const GdbMasters::Watch& w) { return w.packet; });
  constexpr std::uint32_t kTinyPage = 1024;
  for (const Range& r : watch_masters_ ? ranges : std::vector<Range>()) {
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
  std::erase_if(hits_, [&](const GdbMasters::Hit& h) {
    return std::find(list.begin(), list.end(), h.watch) == list.end();
  });
}

void GdbSession::go_on(const GdbResume& resume, bool over_watched) {
  arm_watches(over_watched);
  switch (resume.kind) {
    case GdbResume::Kind::kContinue: break;
    case GdbResume::Kind::kStep: control_.step(resume.from, resume.to); break;
    case GdbResume::Kind::kKill:
      killed_ = true;
      clear_all_points();
      core_.request_stop();
      return;
  }
  if (over_watched)
    control_.stop_after(kNever);  // the step ends with this instruction; further hits are reported
                                  // then
  else
    wait_for_hit();
}

void GdbSession::look(bool asleep) {
  if (serving_) return;  // a command of the debugger lets the others act
  // A core that has reached no boundary since the last call is stopped where it is.
  const bool stuck = halt_seen_ && control_.halt_pending();
  if (!control_.halt_pending() && server_.wants_halt()) control_.request_halt();
  halt_seen_ = control_.halt_pending();
  if (asleep && !hits_.empty() && next_hit() <= views_.now())
    serve_asleep(take_hit());
  else if (halt_seen_ && (asleep || stuck))
    serve_asleep({});
  else
    return;
  halt_seen_ = false;
}

void GdbSession::poll_during_input() {
  waits_for_ = "console input";
  look(true);
  waits_for_ = "an interrupt";
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
  hits_.clear();
  control_.clear();
}

std::string GdbSession::target_xml() const {
  std::string out =
      "<?xml version=\"1.0\"?>\n<!DOCTYPE target SYSTEM \"gdb-target.dtd\">\n<target>\n"
      "<architecture>armv5te</architecture>\n<feature name=\"org.gnu.gdb.arm.core\">\n";
  // The group is the argument of `info registers GROUP`.
  const auto reg = [&out](const std::string& name, unsigned number, const char* type,
                          const char* group = nullptr) {
    out += fmt::format("<reg name=\"{}\" bitsize=\"32\" regnum=\"{}\" type=\"{}\"{}/>\n", name,
                       number, type, group ? fmt::format(" group=\"{}\"", group) : "");
  };
  for (unsigned r = 0; r < 13; ++r) reg(fmt::format("r{}", r), r, "uint32");
  reg("sp", 13, "data_ptr");
  reg("lr", 14, "uint32");
  reg("pc", kPc, "code_ptr");
  reg("cpsr", kCpsr, "uint32");
  out += "</feature>\n<feature name=\"fovea.arm926.system\">\n";
  reg("spsr", kSpsr, "uint32");
  unsigned number = kSystem;
  for (const auto& r : cpu::CoreDebug::system_registers()) reg(r.name, number++, "uint32", "cp15");
  out += "</feature>\n<feature name=\"fovea.arm926.banked\">\n";
  number = kBanked;
  for (const auto& r : cpu::CoreDebug::banked_registers())
    reg(r.name, number++, "uint32", "banked");
  return out + "</feature>\n</target>\n";
}

/// All addresses, divided at the bounds of physical RAM: GDB refuses addresses that the map does
/// not contain, and a program with its MMU on may map memory anywhere.
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
