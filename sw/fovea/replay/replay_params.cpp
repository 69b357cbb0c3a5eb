#include "sw/fovea/replay/replay_params.h"

#include <bit>
#include <cmath>
#include <fmt/format.h>
#include <string_view>
#include <utility>

namespace fovea::app {
namespace {

mem::LowPower low_power_named(std::string_view name) {
  static constexpr std::pair<std::string_view, mem::LowPower> kModes[] = {
      {"off", mem::LowPower::kOff},
      {"self_refresh", mem::LowPower::kSelfRefresh},
      {"power_down", mem::LowPower::kPowerDown},
      {"clock_stop", mem::LowPower::kClockStop}};
  for (const auto& [word, mode] : kModes)
    if (word == name) return mode;
  FOVEA_CHECK(false, "no such mode: " + std::string(name));
}

}  // namespace

void ReplayParams::declare(ParamSet& set) {
  set.add(crossbar);
  set.add(clocks);
  set.add(chip_clocks);
  set.add(ddr);
  set.add(registers);
  set.remove(ddr.retention.key());
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
  c.timing.nXP = value(r.tXP);
  c.timing.nXSNR = value(r.tXSNR);
  c.timing.nXSRD = value(r.tXSRD);
  c.timing.nCKE = value(r.tCKE);
  c.low_power = low_power_named(r.low_power());
  c.read_latency = value(r.RL);
  c.refresh_interval = value(r.tREFI);
  c.row_intervals = value(r.row_intervals);
  c.old_count = value(r.old_count);
  c.page_log2 = static_cast<unsigned>(std::bit_width(r.page())) - 1;
  c.bank_on_top = r.bank_on_top();
  return mem::idealised(c, ddr);
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
  // What no part of this kind does at all, with 1 Hz for the rounding of ddr.clock; what a single part forbids is a
  // warning (mem::DdrCheck).
  const auto within = [&](const IntParam& p, std::uint64_t least, std::uint64_t most,
                          const char* range) {
    if (p() < least || p() > most)
      refuse(p, fmt::format("{} (ddr.part = {}, whose timings ddr.preset=data_sheet takes)", range,
                            ddr.part()));
  };
  if (ddr.mobile()) {
    within(r.clock, 1'000'000, 200'000'001, "1MHz .. 200MHz, mobile DDR");
    within(r.CL, 2, 3, "2 or 3 cycles, mobile DDR");
  } else {
    within(r.clock, 124'999'999, 533'333'334, "125MHz .. 533MHz, DDR2");
    within(r.CL, 3, 7, "3 .. 7 cycles, DDR2");
  }
  // The shortest period that any speed grade has at this CL (JESD79-2, JESD209).
  const Picoseconds shortest = ddr.mobile() && r.CL() == 2 ? 12'000
                               : ddr.mobile()              ? 5'000
                               : r.CL() == 3               ? 5'000
                               : r.CL() == 4               ? 3'750
                               : r.CL() == 5               ? 2'500
                                                           : 1'875;
  if ((r.clock() - 1) * shortest > kPsPerSecond)
    refuse(r.CL, fmt::format("more cycles at {}: no part reads so soon", r.clock.text()));
  if (!std::has_single_bit(r.page())) refuse(r.page, "powers of two");
  if (!std::has_single_bit(r.banks()) || r.banks() > ddr.banks())
    refuse(r.banks, fmt::format("powers of two up to {} (ddr.part = {}, whose banks "
                                "ddr.preset=data_sheet takes)",
                                ddr.banks(), ddr.part()));
  at_least(r.tRAS, r.tRCD(), "ddr.tRCD: a row is open when its columns are read");
  // Each of the three was rounded up to clocks by itself.
  at_least(r.tRC, r.tRAS() + r.tRP() - 1, "ddr.tRAS + ddr.tRP, rounded");
  at_least(r.tRFC, r.tRP() + 1, "more than ddr.tRP: a refresh opens and closes a row");
  if (r.tREFI() != 0)
    at_least(r.tREFI, config().timing.least_interval(),
             "a refresh and a request, twice ddr.tRFC at least, or 0 for no refresh");
}

std::vector<std::pair<std::string, std::string>> replay_keys(const ParamSet& run,
                                                             const mem::DdrConfig& c,
                                                             Frequency scr, Frequency ddr) {
  ReplayParams known;
  ParamSet set;
  known.declare(set);
  std::vector<std::pair<std::string, std::string>> out;
  for (const ParamBase* p : run.all())
    // The clocks are recorded as they are, whatever program set them.
    if (set.find(p->key()) && p->key() != known.chip_clocks.preset.key()) out.emplace_back(p->key(), p->text());
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
  cycles("tXP", c.timing.nXP);
  cycles("tXSNR", c.timing.nXSNR);
  cycles("tXSRD", c.timing.nXSRD);
  cycles("tCKE", c.timing.nCKE);
  constexpr const char* kSleeps[] = {"off", "self_refresh", "power_down", "clock_stop"};
  out.emplace_back("ddr.low_power", kSleeps[static_cast<std::size_t>(c.low_power)]);
  out.emplace_back("ddr.row_intervals", std::to_string(c.row_intervals));
  out.emplace_back("ddr.old_count", std::to_string(c.old_count));
  out.emplace_back("ddr.page", fmt::format("{}B", 1u << c.page_log2));
  out.emplace_back("ddr.banks", std::to_string(c.timing.banks));
  out.emplace_back("ddr.bank_on_top", c.bank_on_top ? "true" : "false");
  return out;
}

}  // namespace fovea::app
