#include "model/mem/check/part_checker.h"

#include <algorithm>
#include <cstdio>

namespace fovea::mem::check {
namespace {
constexpr const char* kPostponed = "postponed REF";  // counted in refreshes, not in clocks
}

PartChecker::PartChecker(const Part& part, Frequency clock, unsigned CL)
    : part_(part), clock_(clock), checker_(in_clocks(part, clock, CL)) {
  checker_.on_complaint = [this](const Complaint& c) { complained(c); };
  check_clock(CL);
}

void PartChecker::change(Frequency clock, unsigned CL, std::uint64_t from) {
  clock_ = clock;
  checker_.change(in_clocks(part_, clock, CL), from);
  check_clock(CL);
}

void PartChecker::check_clock(unsigned CL) {
  if (!offers(part_, clock_, CL)) warnings_["tCK"].count = 1;
}

std::string PartChecker::margin(std::uint64_t clocks) const {
  char text[60];
  std::snprintf(text, sizeof text, "%llu clock%s (%.2f ns)", static_cast<unsigned long long>(clocks),
                clocks == 1 ? "" : "s", static_cast<double>(clocks) * 1e9 / clock_.hertz());
  return text;
}

void PartChecker::complained(const Complaint& c) {
  Warning& w = warnings_[c.rule];
  ++w.count;
  w.worst_clocks = std::max(w.worst_clocks, c.missing);
  if (!on_warning) return;
  const bool late = c.rule == "tREFI" || c.rule == "tRASmax";
  const std::string by = c.missing == 0 ? ""
                         : c.rule == kPostponed
                             ? ", " + std::to_string(c.missing) + " more than the 8 of"
                             : ", " + margin(c.missing) + (late ? " beyond" : " short of");
  on_warning(c, c.rule + by + (c.missing == 0 ? ", against the sheet of " : " ") + part_.name + " at " +
                    megahertz(clock_));
}

std::string PartChecker::text() const {
  std::string out;
  for (const auto& [rule, w] : warnings_) {
    const std::string worst = w.worst_clocks == 0 ? "against the sheet of "
                              : rule == kPostponed
                                  ? "at worst " + std::to_string(w.worst_clocks) + " more than the 8 of "
                                  : "at worst " + margin(w.worst_clocks) + " short of ";
    out += rule + ": " + std::to_string(w.count) + " times, " + worst + part_.name + " at " +
           megahertz(clock_) + "\n";
  }
  return out;
}

}  // namespace fovea::mem::check
