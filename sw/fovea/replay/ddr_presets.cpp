#include "sw/fovea/replay/ddr_presets.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <string_view>

namespace fovea::app {
namespace {

// Deliberately independent of the data sheets in model/mem/check, so that each can be checked
// against the other. S1 to S13 are the sources listed in model/SOURCES.md.
constexpr std::size_t kGrades = 7;
using ByGrade = std::array<Picoseconds, kGrades>;
// The first four are DDR2 (JESD79-2 533C, 667D, 800D, 800E), the others mobile DDR.
constexpr std::array<std::string_view, kGrades> kGradeWords = {"37e", "3", "25e", "25",
                                                               "5",   "6", "75"};
constexpr std::size_t kFirstMobile = 4;

struct ShortestPeriod {
  unsigned CL;
  ByGrade period;  // 0: not available
};
// DDR2: [S3]. Mobile DDR: [S11 S12].
constexpr ShortestPeriod kPeriods[] = {
    {2, {0, 0, 0, 0, 12'000, 12'000, 12'000}},
    {3, {5'000, 5'000, 5'000, 5'000, 5'000, 6'000, 7'500}},
    {4, {3'750, 3'750, 3'750, 3'750, 0, 0, 0}},
    {5, {0, 3'000, 2'500, 3'000, 0, 0, 0}},
    {6, {0, 0, 2'500, 2'500, 0, 0, 0}},
};
// JESD79-2, tCK(avg): limit of the DLL. Mobile DDR has no DLL.
constexpr Picoseconds kLongestPeriod = 8'000;

struct Timing {
  std::string_view name;
  ByGrade least;
  std::string_view assumed;  // speed grade for which the sources do not give a single figure
};
constexpr Timing kTimings[] = {
    // [S1], [S12 S13]; -75 differs by manufacturer
    {"tRCD", {15'000, 15'000, 12'500, 15'000, 15'000, 18'000, 22'500}, "75"},
    // [S1], [S12 S13]; -75 differs by manufacturer
    {"tRP", {15'000, 15'000, 12'500, 15'000, 15'000, 18'000, 22'500}, "75"},
    // Micron's figure [S2 S4], below JEDEC's 45 ns; [S12 S13]; -75 differs by manufacturer
    {"tRAS", {40'000, 40'000, 40'000, 40'000, 40'000, 42'000, 45'000}, "75"},
    // Micron's figure [S1 S2 S4]; [S12 S13]: tRAS + tRP unless given
    {"tRC", {55'000, 55'000, 55'000, 55'000, 55'000, 60'000, 67'500}, "75"},
    // Pages of 2 KiB [S2]; [S12 S13]
    {"tRRD", {10'000, 10'000, 10'000, 10'000, 10'000, 12'000, 15'000}, ""},
    // [S2], [S13]
    {"tWR", {15'000, 15'000, 15'000, 15'000, 15'000, 15'000, 15'000}, ""},
    // [S2]; for mobile parts it is given in clocks, below
    {"tWTR", {7'500, 7'500, 7'500, 7'500, 0, 0, 0}, ""},
    // [S2]; mobile parts do not have it
    {"tRTP", {7'500, 7'500, 7'500, 7'500, 0, 0, 0}, ""},
};
// [S13]; some manufacturers' -6 requires 2
constexpr std::array<unsigned, kGrades> kWriteToReadClocks = {0, 0, 0, 0, 2, 1, 1};
// Four ACT commands in parts with eight banks and pages of 2 KiB [S2].
constexpr ByGrade kFourActivates = {50'000, 50'000, 45'000, 45'000, 0, 0, 0};

struct OfPart {
  std::string_view word;
  std::size_t grade;  // grade of `default`
  Picoseconds tRFC;
  bool assumed;
};
constexpr OfPart kParts[] = {
    {"mt47h32m16", 0, 105'000, false},    // 512 Mb [S2 S3 S4]
    {"mt47h64m16", 1, 127'500, false},    // 1 Gb [S2 S3 S4]
    {"mt47h128m16", 2, 195'000, false},   // 2 Gb [S2 S3 S4]
    {"mt46h32m16lf", 5, 72'000, false},   // 512 Mb [S12 S13]
    {"mt46h64m16lf", 5, 125'000, true},   // 1 Gb: 72 to 140 ns, by manufacturer [S12 S13]
};
constexpr Picoseconds kRefresh = 7'800'000;    // up to 85 C [S2], [S11]
constexpr Picoseconds kOpenAtMost = 70'000'000;  // [S2], [S12 S13]
constexpr unsigned kPageBytes = 2'048;  // DDR2 x16 [S1 S2]; mobile: assumed

using Wide = unsigned __int128;
// ddr.clock is in whole hertz, so a period of 6 ns is 166666667Hz or 166666666Hz.
std::uint64_t rounded_up(Picoseconds t, Frequency key) {
  const Frequency f = key.less_1_hertz();
  const Wide unit = Wide{kPsPerSecond} * f.den;
  return static_cast<std::uint64_t>((Wide{t} * f.num + unit - 1) / unit);
}
std::uint64_t rounded_down(Picoseconds t, Frequency f) {
  return static_cast<std::uint64_t>(Wide{t} * f.num / (Wide{kPsPerSecond} * f.den));
}
bool no_faster(Frequency key, Picoseconds period) {
  const Frequency f = key.less_1_hertz();
  return Wide{period} * f.num <= Wide{kPsPerSecond} * f.den;
}

const OfPart& part_of(const mem::DdrParams& ddr) {
  for (const OfPart& p : kParts)
    if (p.word == ddr.part()) return p;
  FOVEA_CHECK(false, "a part of ddr.part without a preset: " + ddr.part());
}

std::size_t grade_of(const mem::DdrParams& ddr) {
  if (ddr.grade.is("default")) return part_of(ddr).grade;
  std::string offered;
  for (std::size_t g = 0; g < kGrades; ++g) {
    if ((g >= kFirstMobile) != ddr.mobile()) continue;
    if (kGradeWords[g] == ddr.grade()) return g;
    offered += (offered.empty() ? "" : ", ") + std::string(kGradeWords[g]);
  }
  throw UserError(fmt::format("key 'ddr.grade': '{}' is not allowed; ddr.part = {} comes in {}",
                              ddr.grade(), ddr.part(), offered));
}

Frequency in_force(Frequency recorded, std::uint64_t hertz) {
  const Frequency wanted(hertz);
  const bool same =
      !recorded.stopped() && std::abs(recorded.hertz() - wanted.hertz()) < 1.0;
  return same ? recorded : wanted;
}

/// The settings of a data sheet, each where the user has not set the key. They are made in this order:
/// later ones follow from earlier ones.
class SheetSettings {
 public:
  SheetSettings(const ReplayParams& params, Frequency recorded, Experiment& experiment)
      : ddr_(params.ddr),
        r_(params.registers),
        part_(part_of(ddr_)),
        grade_(grade_of(ddr_)),
        recorded_(recorded),
        experiment_(experiment),
        sheet_(fmt::format("ddr.preset: {}, grade {}", part_.word, kGradeWords[grade_])) {}

  void apply() {
    if (!of_user("ddr.clock")) set_clock();
    clock_ = in_force(recorded_, r_.clock());
    set_latencies();
    set_timings();
    set_sleep();
    set_refresh();
    set("banks", std::to_string(ddr_.banks()));
    set("page", fmt::format("{}B", kPageBytes), ddr_.mobile());
  }

 private:
  bool of_user(const std::string& key) const {
    return experiment_.origin(key).kind == ValueOrigin::Kind::kCommandLine;
  }
  void set(std::string_view name, const std::string& value, bool assumed = false) {
    const std::string key = "ddr." + std::string(name);
    if (!of_user(key)) experiment_.preset(key, value, sheet_ + (assumed ? " (assumed)" : ""));
  }
  void cycles(std::string_view name, std::uint64_t n, bool assumed = false) {
    set(name, fmt::format("{}cycles", n), assumed);
  }

  /// The recorded clock, unless the part is too slow for it.
  void set_clock() {
    Picoseconds shortest = 0;
    for (const ShortestPeriod& p : kPeriods) {
      const Picoseconds of_CL = p.period[grade_];
      if (of_CL == 0 || (of_user("ddr.CL") && p.CL != r_.CL())) continue;
      if (shortest == 0 || of_CL < shortest) shortest = of_CL;
    }
    const Frequency now = in_force(recorded_, r_.clock());
    if (shortest != 0 && !no_faster(now, shortest))
      set("clock", fmt::format("{}Hz", kPsPerSecond / shortest));
    else if (!ddr_.mobile() && r_.clock() < kPsPerSecond / kLongestPeriod)
      set("clock", fmt::format("{}Hz", kPsPerSecond / kLongestPeriod));
  }

  void set_latencies() {
    const std::uint64_t beyond_CL = r_.RL() > r_.CL() ? r_.RL() - r_.CL() : 0;
    if (!of_user("ddr.CL")) {
      const auto fits = std::find_if(std::begin(kPeriods), std::end(kPeriods), [&](const auto& p) {
        return p.period[grade_] != 0 && no_faster(clock_, p.period[grade_]);
      });
      if (fits == std::end(kPeriods))
        throw UserError(
            fmt::format("key 'ddr.clock': {} is not allowed; ddr.part = {} in grade {} "
                        "has no CL for it",
                        r_.clock.text(), part_.word, kGradeWords[grade_]));
      cycles("CL", fits->CL);
    }
    // The PHY adds clocks that depend on the board: keep that difference.
    cycles("RL", r_.CL() + beyond_CL);
  }

  void set_timings() {
    for (const Timing& t : kTimings) {
      std::uint64_t n = rounded_up(t.least[grade_], clock_);
      // TI's controller has no tFAW: make sure that four times tRRD covers it.
      if (t.name == "tRRD" && ddr_.banks() == 8)
        n = std::max(n, (rounded_up(kFourActivates[grade_], clock_) + 3) / 4);
      if (t.name == "tWTR") n = std::max<std::uint64_t>(n, kWriteToReadClocks[grade_]);
      // If a timing was set by the user to a longer value, the timings that include it follow.
      if (t.name == "tRAS") n = std::max(n, r_.tRCD());
      if (t.name == "tRC") n = std::max(n, r_.tRAS() + r_.tRP() - 1);
      if (n != 0) cycles(t.name, n, t.assumed == kGradeWords[grade_]);
    }
  }

  /// Power-down and self-refresh. DDR2 [S2 S3]. Mobile DDR [S11 S13]: the longest figure if
  /// manufacturers differ; there is no DLL that has to lock.
  void set_sleep() {
    if (ddr_.mobile()) {
      cycles("tXP", std::max<std::uint64_t>(rounded_up(25'000, clock_), 1), true);
      cycles("tCKE", 2, true);
      cycles("tXSNR", rounded_up(200'000, clock_), true);
      cycles("tXSRD", 1);
    } else {
      cycles("tXP", 2);
      cycles("tCKE", 3);
      cycles("tXSNR", rounded_up(part_.tRFC + 10'000, clock_));
      cycles("tXSRD", 200);
    }
  }

  void set_refresh() {
    // With a slow clock both would be rounded up to one clock, but a refresh opens and closes a row.
    cycles("tRFC", std::max(rounded_up(part_.tRFC, clock_), r_.tRP() + 1), part_.assumed);
    const std::uint64_t interval = rounded_down(kRefresh, clock_);
    cycles("tREFI", interval);
    const std::uint64_t open =
        rounded_down(kOpenAtMost, clock_) / std::max<std::uint64_t>(r_.tREFI(), 1);
    set("row_intervals", std::to_string(std::clamp<std::uint64_t>(open, 1, 16)));
  }

  const mem::DdrParams& ddr_;
  const DdrRegisterParams& r_;
  const OfPart& part_;
  std::size_t grade_;
  Frequency recorded_, clock_;
  Experiment& experiment_;
  std::string sheet_;
};

}  // namespace

std::vector<std::string> choose_ddr_preset(const ReplayParams& params, bool recorded, Experiment& experiment) {
  const auto of_user = [&](const ParamBase& p) {
    return experiment.origin(p.key()).kind == ValueOrigin::Kind::kCommandLine;
  };
  const DdrRegisterParams& r = params.registers;
  const std::initializer_list<const ParamBase*> deciders{&params.ddr.part, &params.ddr.grade, &r.clock,
                                                         &params.chip_clocks.preset};
  const bool other = std::ranges::any_of(deciders, [&](const ParamBase* p) { return of_user(*p); });
  if (!other || of_user(r.preset)) return {};
  if (recorded)
    return {"the timings stay as recorded, in clocks; ddr.preset=data_sheet takes the part's at this clock"};
  experiment.preset(r.preset.key(), "data_sheet", "a trace without recorded settings");
  return {"ddr.preset=data_sheet, as the trace has no recorded timings: they are those of ddr.part at ddr.clock"};
}

void apply_ddr_preset(const ReplayParams& params, Frequency recorded, Experiment& experiment) {
  if (params.registers.preset.is("data_sheet")) SheetSettings(params, recorded, experiment).apply();
}

}  // namespace fovea::app
