#include "tb/dram/part_checker.h"

#include <algorithm>
#include <cstdio>
#include <stdexcept>

namespace fovea::dram {
namespace {

/// What the speed grades have in common (x16 parts have 2 KiB pages).
Part ddr2(std::string name, unsigned banks, Picoseconds tRFC) {
  Part p;
  p.name = std::move(name);
  p.banks = banks;
  p.tRFC = tRFC;
  p.tRAS = 40'000;
  p.tRC = 55'000;
  p.tRRD = 10'000;
  p.tWR = 15'000;
  p.tWTR = p.tRTP = 7'500;
  return p;
}

std::vector<Part> make_parts() {
  std::vector<Part> list;
  Part p = ddr2("MT47H32M16-37E", 4, 105'000);  // four banks: no tFAW
  p.tCK = {0, 0, 0, 5'000, 3'750};
  p.tRCD = p.tRP = 15'000;
  list.push_back(p);

  p = ddr2("MT47H64M16-3", 8, 127'500);
  p.tCK = {0, 0, 0, 5'000, 3'750, 3'000};
  p.tRCD = p.tRP = 15'000;
  p.tFAW = 50'000;
  list.push_back(p);

  p = ddr2("MT47H128M16-25E", 8, 195'000);
  p.tCK = {0, 0, 0, 5'000, 3'750, 2'500};
  p.tRCD = p.tRP = 12'500;
  p.tFAW = 45'000;
  list.push_back(p);

  p = Part();
  p.name = "MT46H64M16LF-6";
  p.mobile = true;
  p.banks = 4;
  p.tCK = {0, 0, 12'000, 6'000};
  p.tRCD = p.tRP = 18'000;
  p.tRAS = 42'000;
  p.tRC = 60'000;
  p.tRRD = 12'000;
  p.tWR = 15'000;
  p.tWTR_clocks = 1;
  p.tRFC = 125'000;  // 72 to 140 ns by maker at this density
  list.push_back(p);
  return list;
}

using Wide = unsigned __int128;
unsigned up(Picoseconds t, Frequency f) {
  const Wide unit = Wide{kPsPerSecond} * f.den;
  return static_cast<unsigned>((Wide{t} * f.num + unit - 1) / unit);
}
unsigned down(Picoseconds t, Frequency f) {
  return static_cast<unsigned>(Wide{t} * f.num / (Wide{kPsPerSecond} * f.den));
}

}  // namespace

const std::vector<Part>& parts() {
  static const std::vector<Part> list = make_parts();
  return list;
}

const Part& part(const std::string& name) {
  for (const Part& p : parts())
    if (p.name == name) return p;
  throw std::out_of_range("no data sheet of a part " + name);
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
  s.tREFI = down(p.tREFI, clock);
  return s;
}

PartChecker::PartChecker(const Part& p, Frequency clock, unsigned CL)
    : name_(p.name), clock_(clock), checker_(in_clocks(p, clock, CL)) {
  const Picoseconds shortest = CL < p.tCK.size() ? p.tCK[CL] : 0;
  // Compared as a product: the period itself need not be a whole number of ps.
  if (shortest == 0 || Wide{shortest} * clock.num > Wide{kPsPerSecond} * clock.den)
    warnings_["tCK"].count = 1;
}

void PartChecker::command(Command c, unsigned bank, std::uint32_t row, std::uint64_t clock) {
  checker_.on_complaint = [&](const Complaint& complaint) {
    Warning& w = warnings_[complaint.rule];
    ++w.count;
    w.worst_clocks = std::max(w.worst_clocks, complaint.missing);
  };
  checker_.command(c, bank, row, clock);
}

std::string PartChecker::text() const {
  std::string out;
  char line[160];
  for (const auto& [rule, w] : warnings_) {
    std::snprintf(line, sizeof line,
                  "%s: %llu times, at worst %llu clocks (%.2f ns) short of %s at %.1f MHz\n",
                  rule.c_str(), static_cast<unsigned long long>(w.count),
                  static_cast<unsigned long long>(w.worst_clocks),
                  static_cast<double>(w.worst_clocks) * 1e9 / clock_.hertz(), name_.c_str(),
                  clock_.hertz() / 1e6);
    out += line;
  }
  return out;
}

}  // namespace fovea::dram
