#include "model/mem/check/data_sheet.h"

#include <algorithm>
#include <cstdio>
#include <stdexcept>

namespace fovea::mem::check {
namespace {

struct Grade {
  const char* word;
  const char* marking;
  bool mobile;
  std::array<Picoseconds, 8> tCK;
  Picoseconds tRCD, tRP, tRAS, tRC, tRRD, tFAW;
  unsigned tWTR_clocks;
};
// DDR2: JESD79-2 speed bins 533C, 667D, 800D, 800E as Micron sells them, x16 (2 KiB page). Mobile:
// JESD209; the -75's tRCD, tRP and tRAS vary by maker.
constexpr Grade kGrades[] = {
    {"37e", "-37E", false, {0, 0, 0, 5000, 3750}, 15000, 15000, 40000, 55000, 10000, 50000, 0},
    {"3", "-3", false, {0, 0, 0, 5000, 3750, 3000}, 15000, 15000, 40000, 55000, 10000, 50000, 0},
    {"25e", "-25E", false, {0, 0, 0, 5000, 3750, 2500, 2500}, 12500, 12500, 40000, 55000, 10000,
     45000, 0},
    {"25", "-25", false, {0, 0, 0, 5000, 3750, 3000, 2500}, 15000, 15000, 40000, 55000, 10000,
     45000, 0},
    {"5", "-5", true, {0, 0, 12000, 5000}, 15000, 15000, 40000, 55000, 10000, 0, 2},
    {"6", "-6", true, {0, 0, 12000, 6000}, 18000, 18000, 42000, 60000, 12000, 0, 1},
    {"75", "-75", true, {0, 0, 12000, 7500}, 22500, 22500, 45000, 67500, 15000, 0, 1},
};

struct Type {
  const char* word;
  const char* name;
  bool mobile;
  unsigned banks;
  unsigned mebibytes;
  Picoseconds tRFC;
  const char* grade;  // by default
};
// tRFC of a mobile part of 1 Gb is 72 to 140 ns by maker.
constexpr Type kTypes[] = {
    {"mt47h32m16", "MT47H32M16", false, 4, 64, 105'000, "37e"},
    {"mt47h64m16", "MT47H64M16", false, 8, 128, 127'500, "3"},
    {"mt47h128m16", "MT47H128M16", false, 8, 256, 195'000, "25e"},
    {"mt46h32m16lf", "MT46H32M16LF", true, 4, 64, 72'000, "6"},
    {"mt46h64m16lf", "MT46H64M16LF", true, 4, 128, 125'000, "6"},
};

using Wide = unsigned __int128;
/// Minima and maxima of time in clocks. A clock given in whole hertz may be rounded, so that 18 ns are 3
/// clocks at 166666667 Hz too.
unsigned up(Picoseconds t, Frequency given) {
  const Frequency f = given.less_1_hertz();
  const Wide unit = Wide{kPsPerSecond} * f.den;
  return static_cast<unsigned>((Wide{t} * f.num + unit - 1) / unit);
}
unsigned down(Picoseconds t, Frequency given) {
  const Frequency f = given.plus_1_hertz();
  return static_cast<unsigned>(Wide{t} * f.num / (Wide{kPsPerSecond} * f.den));
}

std::string plain(double value, int digits) {
  char text[40];
  std::snprintf(text, sizeof text, "%.*f", digits, value);
  std::string s = text;
  while (s.back() == '0') s.pop_back();
  if (s.back() == '.') s.pop_back();
  return s;
}

}  // namespace

Part find_part(const std::string& part, const std::string& grade) {
  const auto type = std::find_if(std::begin(kTypes), std::end(kTypes),
                                 [&](const Type& t) { return part == t.word; });
  if (type == std::end(kTypes)) throw std::out_of_range("no data sheet of a part " + part);
  const std::string wanted = grade == "default" ? type->grade : grade;
  const auto g = std::find_if(std::begin(kGrades), std::end(kGrades), [&](const Grade& x) {
    return wanted == x.word && x.mobile == type->mobile;
  });
  if (g == std::end(kGrades)) throw std::out_of_range(part + " does not come in grade " + grade);
  Part p;
  p.name = std::string(type->name) + g->marking;
  p.mobile = type->mobile;
  p.banks = type->banks;
  p.bytes = std::uint64_t{type->mebibytes} << 20;
  p.tCK = g->tCK;
  p.tRCD = g->tRCD;
  p.tRP = g->tRP;
  p.tRAS = g->tRAS;
  p.tRC = g->tRC;
  p.tRRD = g->tRRD;
  p.tFAW = type->banks == 8 ? g->tFAW : 0;
  p.tWR = 15'000;
  p.tRFC = type->tRFC;
  p.tWTR_clocks = g->tWTR_clocks;
  if (p.mobile) {
    p.tXSNR = 200'000;  // 120 to 200 ns by maker
    p.tXP = p.tCKE = 1;
    p.tXSRD = 0;        // no DLL that must lock
  } else {
    p.tWTR = p.tRTP = 7'500;
    p.tXSNR = p.tRFC + 10'000;
  }
  return p;
}

DataSheet in_clocks(const Part& p, Frequency clock, unsigned CL) {
  DataSheet s;
  s.mobile = p.mobile;
  s.banks = p.banks;
  s.CL = CL;
  s.tRCD = up(p.tRCD, clock);
  s.tRP = up(p.tRP, clock);
  s.tRAS = up(p.tRAS, clock);
  s.tRC = up(p.tRC, clock);
  s.tRRD = up(p.tRRD, clock);
  s.tWR = up(p.tWR, clock);
  s.tWTR = std::max(up(p.tWTR, clock), p.tWTR_clocks);
  s.tRTP = up(p.tRTP, clock);
  s.tRFC = up(p.tRFC, clock);
  s.tFAW = up(p.tFAW, clock);
  s.tXP = p.tXP;
  s.tCKE = p.tCKE;
  s.tXSNR = up(p.tXSNR, clock);
  s.tXSRD = p.tXSRD;
  s.tREFI = down(p.tREFI, clock);
  s.counts_postponed = true;
  s.refresh_before_sleep = !p.mobile;
  s.tSR = p.mobile ? s.tRFC : 0;
  s.tRASmax = down(p.tRASmax, clock);
  return s;
}

bool offers(const Part& part, Frequency given, unsigned CL) {
  const Frequency clock = given.less_1_hertz();
  const Picoseconds shortest = CL < part.tCK.size() ? part.tCK[CL] : 0;
  // Compared as a product: the period itself need not be a whole number of ps.
  return shortest != 0 && Wide{shortest} * clock.num <= Wide{kPsPerSecond} * clock.den;
}

std::string megahertz(Frequency f) { return plain(f.hertz() / 1e6, 3) + " MHz"; }
std::string nanoseconds(Picoseconds t) { return plain(static_cast<double>(t) / 1e3, 3) + " ns"; }

}  // namespace fovea::mem::check
