#include "sw/fovea/debug/gdb_masters.h"

#include <fmt/format.h>

#include <algorithm>

#include "sw/fovea/results/outputs.h"

namespace fovea::app {
namespace {

std::string_view name(Master m) { return kMasterNames[index(m)]; }

std::string_view name(mem::Cmd cmd) {
  using mem::Cmd;
  switch (cmd) {
    case Cmd::kAct:
      return "ACT";
    case Cmd::kPre:
      return "PRE";
    case Cmd::kPreAll:
      return "PREA";
    case Cmd::kRd:
      return "RD";
    case Cmd::kWr:
      return "WR";
    default:
      return "REF";
  }
}

std::string until(Picoseconds t) { return fmt::format("until {} ns", ns_text(t)); }

}  // namespace

GdbMasters::GdbMasters(bus::Crossbar& crossbar, const mem::DdrController& ddr,
                       std::uint32_t ddr_base)
    : crossbar_(crossbar), ddr_(ddr), ddr_base_(ddr_base), observing_(crossbar.observe(*this)) {}

void GdbMasters::submitted(const MemRequest& r, bool to_sdram) {
  auto& list = under_way_[index(r.master)];
  // Remove requests that were decided long ago. Masters may be ahead of the time at which where()
  // is called, so some decided requests are kept.
  constexpr std::size_t kKept = 64;
  if (list.size() >= 2 * kKept)
    list.erase(list.begin(), std::find_if(list.begin(), list.end() - kKept,
                                          [](const Request& o) { return !o.decided; }));
  list.push_back({&r, r.address, r.bytes, r.write, to_sdram, false, r.issued, 0, 0});
}

void GdbMasters::done(const MemRequest& r) {
  const bool to_sdram = r.in_path.slave == static_cast<std::uint8_t>(bus::Slave::kDdr);
  auto& list = under_way_[index(r.master)];
  const auto found = std::find_if(list.rbegin(), list.rend(),
                                  [&](const Request& o) { return o.request == &r && !o.decided; });
  if (found != list.rend()) {
    found->decided = true;
    found->first = r.first;
    found->last = r.last;
  }
  if (to_sdram && !r.error && !watches.empty()) check_watches(r);
}

void GdbMasters::check_watches(const MemRequest& r) const {
  for (const Watch& w : watches) {
    if (w.only ? *w.only != r.master : is_core(r.master)) continue;
    if (w.kind != Kind::kAccess && (w.kind == Kind::kWrite) != r.write) continue;
    const std::uint64_t from = std::max(r.address, w.pa);
    const std::uint64_t to =
        std::min(std::uint64_t{r.address} + r.bytes, std::uint64_t{w.pa} + w.bytes);
    if (from >= to || !on_hit) continue;
    const auto pa = static_cast<std::uint32_t>(from);
    on_hit({r.last, r.master, r.write, w.va + (pa - w.pa), pa,
            static_cast<std::uint32_t>(to - from), w});
  }
}

std::string GdbMasters::where(Picoseconds now) const {
  const auto bus = crossbar_.view(now);
  const auto ddr = ddr_.view();
  std::string out;
  constexpr std::size_t kShown = 8;
  for (std::size_t m = 0; m < kMasterCount; ++m) {
    std::size_t n = 0;
    for (const Request& r : under_way_[m]) {  // in the order of issue
      if (r.issued > now || (r.decided && r.last <= now)) continue;
      if (n++ == 0) out += fmt::format("{} (priority {}):\n", kMasterNames[m], bus.priority[m]);
      if (n > kShown) continue;
      out += fmt::format("    {} of {} bytes at 0x{:08x} since {} ns ({} ns): {}\n",
                         r.write ? "write" : "read", r.bytes, r.address, ns_text(r.issued),
                         ns_text(now - r.issued), position_text(r, bus, ddr, now));
    }
    if (n > kShown) out += fmt::format("    and {} more\n", n - kShown);
  }
  if (out.empty()) out = "no master has a request under way\n";
  for (std::size_t i = 0; i < ddr.items.size(); ++i) {
    const auto& e = ddr.items[i];
    out += fmt::format(
        "sdram {}: {} of {}, {} bytes at 0x{:08x}, bank {} row 0x{:x}{}{}\n", i + 1,
        e.write ? "write" : "read", name(e.master), e.bytes, ddr_base_ + e.address, e.bank, e.row,
        e.open == e.row                     ? " (open)"
        : e.open == mem::DdrDevice::kClosed ? " (bank closed)"
                                            : fmt::format(" (row 0x{:x} is open)", e.open),
        e.waiting ? ", in the input register" : e.out_of_order ? ", served, waits for older reads" : "");
  }
  if (ddr.next_at != kNever)
    out += fmt::format("sdram: next command {} for {} at {} ns\n", name(ddr.cmd),
                       ddr.next < ddr.items.size() ? name(ddr.items[ddr.next].master) : "refresh",
                       ns_text(ddr.next_at));
  return out;
}

std::string GdbMasters::position_text(const Request& r, const bus::Crossbar::View& bus,
                              const mem::DdrController::View& ddr, Picoseconds now) const {
  if (r.decided) {
    if (r.write) return "acknowledged; the answer is on its way, " + until(r.last);
    return r.first > now ? fmt::format("served; its data are on their way, from {} to {} ns",
                                       ns_text(r.first), ns_text(r.last))
                         : "its data arrive, " + until(r.last);
  }
  for (const auto& item : bus.items)
    if (item.request == r.request) return in_crossbar(item, *r.request, bus, now);
  if (!r.to_sdram)
    return fmt::format("{}; taken there at {} ns",
                       r.request->in_path.slave == static_cast<std::uint8_t>(bus::Slave::kInternalRam)
                           ? "at internal RAM"
                           : "on the configuration bus",
                       ns_text(r.request->in_path.accepted_at));
  for (std::size_t i = 0; i < ddr.items.size(); ++i)
    if (ddr.items[i].request == r.request && (!r.write || ddr.items[i].waiting))
      return in_controller(ddr, i, now);
  return "between crossbar and SDRAM controller";
}

std::string GdbMasters::in_crossbar(const bus::Crossbar::View::Item& item, const MemRequest& r,
                                    const bus::Crossbar::View& bus, Picoseconds now) const {
  const auto& slave = bus.slaves[r.in_path.slave];
  const auto of = static_cast<bus::Slave>(r.in_path.slave);
  const std::string_view what = of == bus::Slave::kDdr           ? "the SDRAM"
                                : of == bus::Slave::kInternalRam ? "internal RAM"
                                                                 : "the registers";
  if (item.crossed == kNever) return "on its port; the crossbar's clock stands";
  if (!item.head) return "on its port, behind the same master's earlier request";
  if (item.crossed > now) return "on its bridge to the crossbar, " + until(item.crossed);
  const std::string place = fmt::format("in the crossbar, for {}: waits for ", what);
  const bool others = slave.granted && *slave.granted != r.master;
  if (slave.blocked)
    return place + fmt::format("{}, whose request is in the slave's input register",
                               slave.granted ? name(*slave.granted) : "another");
  if (slave.locked_by && *slave.locked_by != r.master)
    return place + fmt::format("{}, which has locked it", name(*slave.locked_by));
  const bool loses = bus.next && *bus.next != r.master;
  const std::string winner =
      loses ? fmt::format("{} (priority {})", name(*bus.next), bus.priority[index(*bus.next)]) : "";
  if (slave.free > now)
    return place + fmt::format("{}, {}{}",
                               others ? name(*slave.granted) : "its own earlier request",
                               until(slave.free), loses ? ", then for " + winner : "");
  if (loses) return place + fmt::format("{}, which wins at {} ns", winner, ns_text(bus.next_at));
  return place + fmt::format("the clock edge at {} ns", ns_text(bus.next_at));
}

std::string GdbMasters::in_controller(const mem::DdrController::View& ddr, std::size_t i,
                                      Picoseconds now) const {
  const auto& e = ddr.items[i];
  if (e.out_of_order) return "in the SDRAM controller: its data wait for those of its master's older reads";
  if (ddr.next_at == kNever) return "in the SDRAM controller, which stands";
  const bool own = ddr.next == i, refresh = ddr.next >= ddr.items.size();
  const std::string served =
      refresh ? std::string("a refresh")
              : fmt::format("{}, which is served", name(ddr.items[ddr.next].master));
  if (e.waiting)
    return fmt::format("in the SDRAM controller's input register: waits for room for {} behind {}",
                       ddr.data_full ? "its data" : "an entry", served);
  const std::string place = "in the SDRAM queue: ";
  if (ddr.asleep != mem::LowPower::kOff) return place + "waits for the memory to wake up";
  if (e.ready > now) return place + "in the controller's pipeline " + until(e.ready);
  if (e.moving)
    return place + "in service, its last column is given at " + ns_text(ddr.next_at) + " ns";
  if (!own) return place + "waits for " + served;
  const std::string behind =
      ddr.last_master ? fmt::format(", behind the {} of {}", name(ddr.last), name(*ddr.last_master))
      : ddr.last == mem::Cmd::kRef || ddr.last == mem::Cmd::kPreAll ? ", behind a refresh"
                                                                    : "";
  switch (ddr.cmd) {
    case mem::Cmd::kPre:
      return place + fmt::format(
                         "row conflict in bank {}: row 0x{:x} wanted, 0x{:x} open; closed at "
                         "{} ns{}",
                         e.bank, e.row, e.open, ns_text(ddr.next_at), behind);
    case mem::Cmd::kAct:
      return place + fmt::format("row miss: row 0x{:x} of bank {} is opened at {} ns{}", e.row,
                                 e.bank, ns_text(ddr.next_at), behind);
    default:
      return place + fmt::format("row 0x{:x} of bank {} is open; {} at {} ns{}", e.row, e.bank,
                                 name(ddr.cmd), ns_text(ddr.next_at), behind);
  }
}

}  // namespace fovea::app
