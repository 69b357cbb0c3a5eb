#include "sw/fovea/limits/relaxations.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "model/board/clock_presets.h"
#include "model/common/check.h"
#include "model/common/masters.h"
#include "sw/fovea/config/clock_setting.h"
#include "sw/fovea/files/checked_file.h"

namespace fovea::limits {
namespace {

struct Setting {
  const char* key;
  const char* value;
};
/// `when` is how the name of a master begins that must have traffic; empty: always.
struct Row {
  const char *name, *resource, *how, *when;
  std::vector<Setting> settings;
};

/// Relaxations by a parameter of a run. The values are the best that the parameter allows.
const std::vector<Row>& rows_of_runs() {
  static const std::vector<Row> rows = {
      {"ahb_clock", "the clock of the core's AHB", "at the core's own clock", "", {{"cpu.ahb_ratio", "1"}}},
      {"dcache", "the size of the data cache", "with 128 KiB", "", {{"cpu.dcache.size", "128KiB"}}},
      {"icache", "the size of the instruction cache", "with 128 KiB", "", {{"cpu.icache.size", "128KiB"}}},
      {"bridge_arm_d", "the bridge of the core's data port", "without its latency", "",
       {{"bus.arm_d.request_latency", "0 cycles"}, {"bus.arm_d.response_latency", "0 cycles"}}},
      {"bridge_arm_i", "the bridge of the core's instruction port", "without its latency", "",
       {{"bus.arm_i.request_latency", "0 cycles"}, {"bus.arm_i.response_latency", "0 cycles"}}},
      {"width_arm_d", "the width of the core's data port", "with 64 bits", "", {{"bus.arm_d.width", "64bit"}}},
      {"bridge_vpfe", "the camera's way to the crossbar", "without its latency", "vpfe",
       {{"bus.vpfe.request_latency", "0 cycles"}, {"bus.vpfe.response_latency", "0 cycles"}}},
      {"bridge_vpbe", "the display's way to the crossbar", "without its latency", "vpbe",
       {{"bus.vpbe.request_latency", "0 cycles"}, {"bus.vpbe.response_latency", "0 cycles"}}},
      {"buffer_vpfe", "the camera's write buffer", "with 32 bursts", "vpfe", {{"vpss.write_buffer_bursts", "32"}}},
      {"buffer_vpbe", "the display's read-ahead", "with 4 lines and 16 reads under way", "vpbe",
       {{"vpss.read_ahead_lines", "4"}, {"vpss.read_outstanding", "16"}}},
      {"edma_depth", "the EDMA's requests under way", "with 16", "edma_tc", {{"edma.tc.outstanding", "16"}}},
      {"edma_start", "the EDMA's start of a transfer", "in 1 clock each", "edma_tc",
       {{"edma.request_clocks", "1"}, {"edma.event_clocks", "1"}, {"edma.completion_clocks", "1"}}},
      {"config_bus", "the registers' latency", "as 1 ns", "",
       {{"bus.config.fast_latency", "1ns"}, {"bus.config.slow_latency", "1ns"}}},
      {"ddr_latency", "the latency of the SDRAM controller", "without it", "",
       {{"ddr.request_latency", "0 cycles"}, {"ddr.return_latency", "0 cycles"}}},
      {"ddr_queues", "the queues of the SDRAM controller", "with 16 commands and 512 bytes each way", "",
       {{"ddr.command_fifo", "16"}, {"ddr.read_fifo", "512B"}, {"ddr.write_fifo", "512B"}}},
      {"ddr_scheduler", "the order of the SDRAM controller", "ready rows first, whatever the priority", "",
       {{"ddr.scheduler", "frfcfs"}}},
      {"row_timing", "the row timing of the SDRAM", "with rows opened and closed in 1 clock", "",
       {{"ddr.ideal", "row_timing"}}},
      {"cas_latency", "the SDRAM's latency to the first data", "with CL and RL of 4 clocks", "",
       {{"ddr.ideal", "cas_latency"}}},
      {"turnaround", "the SDRAM's change from writing to reading", "in 1 clock", "", {{"ddr.ideal", "turnaround"}}},
      {"refresh", "the SDRAM's refresh", "without it, and without the rows that it closes", "",
       {{"ddr.ideal", "refresh"}}},
  };
  return rows;
}

bool busy(const points::PointResult& plain, std::string_view master) {
  if (master.empty()) return true;
  return std::any_of(plain.stats.begin(), plain.stats.end(), [&](const auto& s) {
    return s.second > 0 && s.first.starts_with("bus." + std::string(master)) &&
           s.first.ends_with(".transactions");
  });
}

/// Settings at both ends of what is believed of a parameter.
void add_belief(const ParamBase& p, Relaxation& r) {
  const auto rank = [](Origin o) { return o == Origin::kAssumed ? 2 : o == Origin::kFamily ? 1 : 0; };
  if (rank(p.origin()) > rank(r.origin)) r.origin = p.origin();
  if (rank(p.origin()) == 0) return;
  r.low.push_back(fmt::format("{}={}", p.key(), p.belief().low));
  r.high.push_back(fmt::format("{}={}", p.key(), p.belief().high));
}

/// The settings of a row whose keys this program has, without those that are so already.
void add_row(const Row& row, const ParamSet& params, const points::PointResult& plain, std::vector<Relaxation>& out) {
  Relaxation r{row.name, row.resource, row.how, false, {}, {}, {}};
  bool known = false;
  for (const Setting& s : row.settings) {
    const ParamBase* p = params.find(s.key);
    if (!p) continue;
    known = true;
    add_belief(*p, r);
    if (p->text() != s.value) r.settings.push_back(fmt::format("{}={}", s.key, s.value));
  }
  if (!known) return;
  if (!busy(plain, row.when)) r.idle = "no traffic";
  else if (r.settings.empty()) r.idle = "it is so already";
  out.push_back(std::move(r));
}

/// The clocks of an experiment, and the highest that the PLLs can give while the other one stays.
struct Clocks {
  Frequency core, ddr, crossbar;
  bool apart = false;                         // the crossbar's has been set
  std::uint64_t best_core = 0, best_ddr = 0;  // MHz
};

std::uint64_t best_clock(const Clocks& now, bool core) {
  const Frequency most = board::most(core ? +[](const board::ClockPreset& p) { return p.core(); }
                                          : +[](const board::ClockPreset& p) { return p.ddr(); });
  constexpr std::uint64_t kStep = 1'000'000;
  std::uint64_t best = static_cast<std::uint64_t>(most.hertz()) / kStep * kStep;
  const auto possible = [&](std::uint64_t f) {
    return app::find_setting(core ? Frequency(f) : now.core, core ? now.ddr : Frequency(f)).has_value();
  };
  while (static_cast<double>(best) > (core ? now.core : now.ddr).hertz() && !possible(best)) best -= kStep;
  return best / kStep;
}

std::optional<Clocks> clocks_of(const ParamSet& params) {
  const auto* arm = dynamic_cast<const IntParam*>(params.find("clocks.arm"));
  const auto* ddr = dynamic_cast<const IntParam*>(params.find("clocks.ddr"));
  const auto* crossbar = dynamic_cast<const IntParam*>(params.find("clocks.crossbar"));
  const ParamBase* preset = params.find("clocks.preset");
  if (!arm || !ddr || !crossbar || !preset) return std::nullopt;
  const board::ClockPreset& of = board::clock_preset(preset->text());
  Clocks out;
  out.core = (*arm)() ? Frequency((*arm)()) : of.core();
  out.ddr = (*ddr)() ? Frequency((*ddr)()) : of.ddr();
  out.crossbar = (*crossbar)() ? Frequency((*crossbar)()) : board::ClockSetting::half(out.ddr);
  out.apart = (*crossbar)() != 0;
  out.best_core = best_clock(out, true);
  out.best_ddr = best_clock(out, false);
  return out;
}

/// The clock of the core, and those of the memory: on the chip one PLL gives the SDRAM's and, as half of it, the
/// crossbar's. Apart from each other they say which of the two binds.
void add_clocks(const ParamSet& params, std::vector<Relaxation>& out) {
  const auto now = clocks_of(params);
  if (!now) return;
  const auto add = [&](const char* name, const char* resource, std::string how, std::vector<std::string> settings,
                       bool higher) {
    Relaxation r{name, resource, std::move(how), false, std::move(settings), {}, {}};
    if (!higher) {
      r.how = "raised";
      r.idle = "the PLLs give no higher one beside the other clock";
    }
    out.push_back(std::move(r));
  };
  const auto above = [](std::uint64_t megahertz, Frequency f) {
    return static_cast<double>(megahertz) * 1e6 > f.hertz();
  };
  const auto half = [](std::uint64_t megahertz) { return static_cast<double>(megahertz) / 2; };
  const bool faster = above(now->best_ddr, now->ddr);
  std::vector<std::string> together = {fmt::format("clocks.ddr={}MHz", now->best_ddr)};
  if (now->apart) together.push_back("clocks.crossbar=0Hz");
  add("core_clock", "the core's clock", fmt::format("at {} MHz", now->best_core),
      {fmt::format("clocks.arm={}MHz", now->best_core)}, above(now->best_core, now->core));
  add("pll1_clocks", "the PLL of SDRAM (SYSCLK7), crossbar (SYSCLK4) and video",
      fmt::format("with the SDRAM at {} MHz and the crossbar at half of it, as the chip can", now->best_ddr),
      together, faster);
  add("sdram_clock", "the SDRAM's clock (SYSCLK7) alone",
      fmt::format("at {} MHz, its timing kept in ns and the crossbar's clock as it is, which no chip can",
                  now->best_ddr),
      {fmt::format("clocks.ddr={}MHz", now->best_ddr),
       fmt::format("clocks.crossbar={}Hz", std::llround(now->crossbar.hertz()))},
      faster);
  add("crossbar_clock", "the clock of crossbar, EDMA and registers (SYSCLK4) alone",
      fmt::format("at {:g} MHz and the SDRAM's as it is, which no chip can", half(now->best_ddr)),
      {fmt::format("clocks.crossbar={:g}MHz", half(now->best_ddr))},
      faster && half(now->best_ddr) * 1e6 > now->crossbar.hertz());
}

void add_priorities(const ParamSet& params, const points::PointResult& plain, std::vector<Relaxation>& out) {
  for (const ParamBase* p : params.all()) {
    if (!p->key().starts_with("priority.")) continue;
    const std::string master = p->key().substr(sizeof("priority.") - 1);
    Relaxation r{"priority_" + master, fmt::format("the priority of {}", master), "as the highest",
                 false, {p->key() + "=0"}, {}, {}};
    if (!busy(plain, master)) r.idle = "no traffic";
    else if (p->text() == "0") r.idle = "it is so already";
    out.push_back(std::move(r));
  }
}

void add_loads(const ParamSet& params, std::vector<Relaxation>& out) {
  for (const char* group : {"load", "load.1", "load.2", "load.3"}) {
    const auto* outstanding = dynamic_cast<const IntParam*>(params.find(std::string(group) + ".outstanding"));
    if (!outstanding || (*outstanding)() == 0) continue;
    out.push_back({group, fmt::format("the synthetic load '{}'", group), "without it", false,
                   {std::string(group) + ".outstanding=0"}, {}, {}});
  }
}

/// "the remap engine" without its article.
std::string noun(std::string_view who) {
  constexpr std::string_view kThe = "the ";
  return std::string(who.starts_with(kThe) ? who.substr(kThe.size()) : who);
}

/// Each master but the core, whose traffic is left out of a replay: by what people call it, or by its own
/// name where several are called the same. Synthetic loads have relaxations by parameter. A replay refuses to leave
/// out transfers that others wait for.
void add_masters(const points::PointResult& plain, std::vector<Relaxation>& out) {
  for (std::size_t stat = 0; stat < kStatCount; ++stat) {
    const MasterInfo& row = master_info(master_of_stat(stat));
    if (is_core(row.id) || row.synthetic) continue;
    const bool shared = std::any_of(kMasters.rows.begin(), kMasters.rows.end(), [&](const MasterInfo& r) {
      return r.who == row.who && r.statistics != row.statistics;
    });
    std::string name = shared ? std::string(row.statistics) : noun(row.who);
    std::replace(name.begin(), name.end(), ' ', '_');
    Relaxation r{name,
                 shared ? fmt::format("the traffic of {} controller {}", noun(row.who), row.unit)
                        : fmt::format("{}'s traffic", row.who),
                 "without it", true, {}, {"--without", std::string(row.statistics)}, {}};
    if (!busy(plain, row.statistics)) r.idle = "no traffic";
    else if (row.pace == Pace::kTransfers) r.idle = "the core waits for its transfers: no replay can leave them out";
    out.push_back(std::move(r));
  }
}

}  // namespace

std::vector<Relaxation> relaxations(const ParamSet& params, const points::PointResult& plain) {
  std::vector<Relaxation> out;
  add_clocks(params, out);
  for (const Row& row : rows_of_runs()) add_row(row, params, plain, out);
  add_priorities(params, plain, out);
  add_loads(params, out);
  add_masters(plain, out);
  return out;
}

void check_names(const std::vector<std::string>& names, const std::vector<Relaxation>& among) {
  std::vector<std::string> known;
  for (const Relaxation& r : among) known.push_back(r.name);
  for (const std::string& name : names)
    if (std::find(known.begin(), known.end(), name) == known.end())
      throw UserError(fmt::format("--relax '{}': allowed here: {}", app::one_line(name), fmt::join(known, ", ")));
}

}  // namespace fovea::limits
