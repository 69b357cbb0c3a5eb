// Each row takes the clocks counted by hand, and the table of instructions states the same.
#include <gtest/gtest.h>

#include <charconv>

#include "tb/iss/isa_clocks.h"

namespace fovea::cpu::test {
namespace {

/// The first figure of a text: a number, "n" or "n + number".
unsigned stated(const IsaRow& row) {
  std::string_view text = row.kind.cycles;
  unsigned sum = 0;
  if (text.starts_with("n")) {
    sum = kListedRegisters + (row.also != 0);
    text.remove_prefix(1);
    if (!text.starts_with(" + ")) return sum;
    text.remove_prefix(3);
  }
  unsigned number = 0;
  const auto end = std::from_chars(text.data(), text.data() + text.size(), number);
  EXPECT_EQ(end.ec, std::errc{}) << row.name << ": " << row.kind.cycles;
  return sum + number;
}

TEST(IsaTimingTest, EachRowTakesTheClocksCountedByHand) {
  unsigned uses = 0;
  for (int row = 0; row < static_cast<int>(isa_rows().size()); ++row) {
    const IsaRow& form = isa_rows()[static_cast<std::size_t>(row)];
    ASSERT_EQ(isa_row(plain(row), form.thumb()), row) << form.name;
    const HandCount* const by_hand = hand_count(form.name);
    ASSERT_NE(by_hand, nullptr) << form.name << " is not counted, or twice";
    EXPECT_EQ(stated(form), by_hand->clocks) << form.name << ": " << form.kind.cycles;
    for (const std::string& wrong : wrong_clocks(row, &uses)) ADD_FAILURE() << wrong;
  }
  EXPECT_GE(uses, 120u) << "rows whose result was used";
}

TEST(IsaTimingTest, ARowWithoutAHandCountIsNoticed) {
  EXPECT_EQ(hand_count("ldr imm"), nullptr);
  EXPECT_NE(hand_count("ldr imm pre"), nullptr);
}

}  // namespace
}  // namespace fovea::cpu::test
