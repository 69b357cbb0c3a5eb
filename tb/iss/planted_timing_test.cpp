// A core with one clock too many in one class of instructions fails the hand counts.
#include <gtest/gtest.h>

#include <algorithm>
#include <iomanip>
#include <iostream>

#include "tb/iss/isa_clocks.h"
#include "tb/iss/planted.h"
#include "tb/iss/timing_cases.h"

int fovea_planted = 0;

namespace fovea::cpu::test {
namespace {

/// What the hand counts of a class say against the core as it is now.
std::vector<std::string> complaints(InsnClass c) {
  std::vector<std::string> out;
  for (int row = 0; row < static_cast<int>(isa_rows().size()); ++row) {
    if (isa_rows()[static_cast<std::size_t>(row)].kind.insn_class != c) continue;
    const auto wrong = wrong_clocks(row);
    out.insert(out.end(), wrong.begin(), wrong.end());
  }
  return out;
}

bool case_is_wrong(const std::string& name) {
  const auto* const found = std::find_if(std::begin(kTimingCases), std::end(kTimingCases),
                                         [&](const TimingCase& c) { return name == c.name; });
  EXPECT_NE(found, std::end(kTimingCases)) << name;
  const auto clocks = clocks_by_place(*found);
  return std::any_of(clocks.begin(), clocks.end(),
                     [&](std::uint64_t n) { return n != found->clocks; });
}

TEST(PlantedTimingTest, AClockTooManyInEachClassIsNoticed) {
  std::vector<bool> seen(static_cast<std::size_t>(InsnClass::kCount));
  for (std::size_t c = 0; c < seen.size(); ++c)
    ASSERT_TRUE(complaints(static_cast<InsnClass>(c)).empty()) << "nothing is planted yet";
  int number = static_cast<int>(std::size(kDefects));
  for (const TimingDefect& d : kTimingDefects) {
    seen[static_cast<std::size_t>(d.insn_class)] = true;
    const bool by_case = *d.timing_case;
    ASSERT_FALSE(by_case && case_is_wrong(d.timing_case)) << d.timing_case;
    fovea_planted = ++number;
    const auto wrong = by_case ? std::vector<std::string>{} : complaints(d.insn_class);
    const bool noticed = by_case ? case_is_wrong(d.timing_case) : !wrong.empty();
    fovea_planted = 0;
    std::cout << std::setw(24) << class_name(d.insn_class) << ": " << d.what
              << (noticed ? ", noticed" : ", NOT noticed");
    if (!wrong.empty()) std::cout << ", first " << wrong.front();
    std::cout << "\n";
    EXPECT_TRUE(noticed) << class_name(d.insn_class) << ": " << d.what;
  }
  for (std::size_t c = 0; c < seen.size(); ++c)
    EXPECT_TRUE(seen[c]) << class_name(static_cast<InsnClass>(c));
}

}  // namespace
}  // namespace fovea::cpu::test
