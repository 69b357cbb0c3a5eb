#include "sw/fovea/replay_params.h"

#include <bit>
#include <cmath>
#include <fmt/format.h>

namespace fovea::app {

void ReplayParams::declare(ParamSet& set) {
  set.add(crossbar);
  for (auto& port : crossbar.ports) set.add(*port);
  set.add(clocks);
  set.add(ddr);
  set.add(registers);
}

mem::DdrConfig ReplayParams::config() const {
  const auto value = [](const IntParam& p) { return static_cast<unsigned>(p()); };
  const DdrRegisterParams& r = registers;
  mem::DdrConfig c;
  c.timing.CL = value(r.CL);
  c.timing.nRFC = value(r.tRFC);
  c.timing.nRP = value(r.tRP);
  c.timing.nRCD = value(r.tRCD);
  c.timing.nWR = value(r.tWR);
  c.timing.nRAS = value(r.tRAS);
  c.timing.nRC = value(r.tRC);
  c.timing.nRRD = value(r.tRRD);
  c.timing.nWTR = value(r.tWTR);
  c.timing.nRTP = value(r.tRTP);
  c.timing.banks = value(r.banks);
  c.timing.mobile = ddr.mobile();
  c.read_latency = value(r.RL);
  c.refresh_interval = value(r.tREFI);
  c.old_count = value(r.old_count);
  c.page_log2 = static_cast<unsigned>(std::bit_width(r.page())) - 1;
  c.bank_on_top = r.bank_on_top();
  return c;
}

void ReplayParams::check() const {
  const DdrRegisterParams& r = registers;
  const auto refuse = [](const IntParam& p, const std::string& allowed) {
    throw UserError(fmt::format("key '{}': {} is not allowed; allowed: {}", p.key(), p.text(),
                                allowed));
  };
  const auto at_least = [&](const IntParam& p, std::uint64_t least, const char* what) {
    if (p() < least) refuse(p, fmt::format("{} cycles or more ({})", least, what));
  };
  if (!std::has_single_bit(r.page())) refuse(r.page, "powers of two");
  if (!std::has_single_bit(r.banks()) || r.banks() > ddr.banks())
    refuse(r.banks, fmt::format("powers of two up to {} (ddr.part = {})", ddr.banks(), ddr.part()));
  at_least(r.tRAS, r.tRCD(), "ddr.tRCD: a row is open when its columns are read");
  // Each of the three was rounded up to clocks by itself.
  at_least(r.tRC, r.tRAS() + r.tRP() - 1, "ddr.tRAS + ddr.tRP, rounded");
  at_least(r.tRFC, r.tRP() + 1, "more than ddr.tRP: a refresh opens and closes a row");
  if (r.tREFI() != 0) at_least(r.tREFI, 2 * r.tRFC(), "twice ddr.tRFC, or 0 for no refresh");
}

namespace {

/// The shortest that any speed grade has, ns: JESD79-2 with makers' tRAS and tRC, 2 KiB pages; mobile
/// DDR-400 (JESD209).
struct FastestPart {
  double tRCD, tRP, tRAS, tRC, tRRD, tWR, tWTR, tRTP;
  double tRFC[3];  // of 64, 128, 256 MiB
  double tCK[8];   // by CL; 0: no part has it
};
constexpr FastestPart kDdr2 = {12.5, 12.5, 40, 55, 10, 15, 7.5, 7.5, {105, 127.5, 195},
                               {0, 0, 0, 5, 3.75, 2.5, 2.5, 1.875}};
constexpr FastestPart kMobile = {15, 15, 40, 55, 10, 15, 0, 0, {72, 72, 72},
                                 {0, 0, 12, 5, 0, 0, 0, 0}};
constexpr double kLongestInterval = 7800;  // 8192 rows in 64 ms

}  // namespace

std::vector<std::string> ReplayParams::remarks() const {
  const DdrRegisterParams& r = registers;
  const FastestPart& part = ddr.mobile() ? kMobile : kDdr2;
  const double tck = 1e9 / static_cast<double>(r.clock());
  std::vector<std::string> out;
  const auto remark = [&](const IntParam& p, double is, const char* than, double allowed) {
    out.push_back(fmt::format("{} = {} is {:.1f} ns at ddr.clock = {}; no part like {} has {} than "
                              "{} ns",
                              p.key(), p.text(), is, r.clock.text(), ddr.part(), than, allowed));
  };
  const auto at_least = [&](const IntParam& p, double least) {
    const double is = static_cast<double>(p()) * tck;
    if (is < least - 1e-6) remark(p, is, "less", least);
  };
  at_least(r.tRCD, part.tRCD);
  at_least(r.tRP, part.tRP);
  at_least(r.tRAS, part.tRAS);
  at_least(r.tRC, part.tRC);
  at_least(r.tRRD, part.tRRD);
  at_least(r.tWR, part.tWR);
  at_least(r.tWTR, part.tWTR);
  at_least(r.tRTP, part.tRTP);
  at_least(r.tRFC, part.tRFC[ddr.part.index() % 3]);
  if (r.tREFI() == 0)
    out.push_back(r.tREFI.key() + " = 0: without refresh a part forgets");
  else if (static_cast<double>(r.tREFI()) * tck > kLongestInterval + tck)
    remark(r.tREFI, static_cast<double>(r.tREFI()) * tck, "more", kLongestInterval);
  const double shortest = part.tCK[r.CL()];
  if (shortest == 0)
    out.push_back(fmt::format("{} = {}: no part like {} has it", r.CL.key(), r.CL.text(),
                              ddr.part()));
  else if (tck < shortest - 1e-6)
    out.push_back(fmt::format(
        "{} = {} at ddr.clock = {}: no part like {} runs above {:.0f} MHz with it", r.CL.key(),
        r.CL.text(), r.clock.text(), ddr.part(), 1e3 / shortest));
  return out;
}

std::vector<std::pair<std::string, std::string>> replay_keys(const ParamSet& run,
                                                             const mem::DdrConfig& c,
                                                             Frequency scr, Frequency ddr) {
  ReplayParams known;
  ParamSet set;
  known.declare(set);
  std::vector<std::pair<std::string, std::string>> out;
  for (const ParamBase* p : run.all())
    if (set.find(p->key())) out.emplace_back(p->key(), p->text());
  const auto hertz = [](Frequency f) {
    return fmt::format("{}Hz", static_cast<std::uint64_t>(std::llround(f.hertz())));
  };
  const auto cycles = [&](const char* name, std::uint64_t n) {
    out.emplace_back(std::string("ddr.") + name, fmt::format("{}cycles", n));
  };
  out.emplace_back("bus.clock", hertz(scr));
  out.emplace_back("ddr.clock", hertz(ddr));
  cycles("CL", c.timing.CL);
  cycles("RL", c.read_latency);
  cycles("tRFC", c.timing.nRFC);
  cycles("tRP", c.timing.nRP);
  cycles("tRCD", c.timing.nRCD);
  cycles("tWR", c.timing.nWR);
  cycles("tRAS", c.timing.nRAS);
  cycles("tRC", c.timing.nRC);
  cycles("tRRD", c.timing.nRRD);
  cycles("tWTR", c.timing.nWTR);
  cycles("tRTP", c.timing.nRTP);
  cycles("tREFI", c.refresh_interval);
  out.emplace_back("ddr.old_count", std::to_string(c.old_count));
  out.emplace_back("ddr.page", fmt::format("{}B", 1u << c.page_log2));
  out.emplace_back("ddr.banks", std::to_string(c.timing.banks));
  out.emplace_back("ddr.bank_on_top", c.bank_on_top ? "true" : "false");
  return out;
}

}  // namespace fovea::app
