// Moved code: what of a difference comes from the same code at other addresses. Expected amounts are counted by hand
// from the rows of run_maker.h.
#include "sw/fovea/compare/compare.h"
#include "tb/regression/blame_bench.h"

namespace fovea::regression {
namespace {

using testing::HasSubstr;

class LayoutTest : public BlameBench {};

TEST_F(LayoutTest, MovedCodeIsLayout) {
  replace(after.profile, "icache,.text,bridge,100", "icache,.text,bridge,140");
  replace(after.profile, "dcache,lut,bridge,150", "dcache,lut,bridge,170");
  replace(after.profile, "idle.capture,,,300", "idle.capture,,,240");
  replace(after.functions, "0x00000100", "0x00000120");
  replace(after.functions, "0x00000200", "0x00000220");
  after.elf = "22";
  Difference d = difference();
  ASSERT_EQ(d.functions.size(), 2u);
  for (const auto& f : d.functions) EXPECT_EQ(f.kind, ChangeKind::kLayout) << f.function;
  EXPECT_EQ(d.functions[0].layout + d.functions[1].layout, 60);
  EXPECT_THAT(difference_text(d, 9), HasSubstr("by layout (same code at other addresses): +60 clocks"));
  EXPECT_THAT(blame_text(d, blame_of(d, true)), HasSubstr("irq (irq.c:7) was moved (layout): +40 clocks"));
  // The same program cannot have moved.
  after.elf = "11";
  d = difference();
  for (const auto& f : d.functions) EXPECT_EQ(f.kind, ChangeKind::kWaits) << f.function;
  // With other settings the longer wait for data may come from them; a fetch of moved code still moved.
  after.elf = "22";
  after.parameters["ddr.clock"] = "216MHz";
  d = difference();
  EXPECT_EQ(d.functions[0].function, "irq");
  EXPECT_EQ(d.functions[0].kind, ChangeKind::kLayout);
  EXPECT_EQ(d.functions[1].kind, ChangeKind::kWaits);
  EXPECT_EQ(d.functions[1].layout, 0);
}

TEST_F(LayoutTest, WhatStaysInItsPlaceIsNotLayout) {
  replace(after.profile, "icache,.text,bridge,100", "icache,.text,bridge,140");
  replace(after.profile, "idle.capture,,,300", "idle.capture,,,260");
  after.elf = "22";
  Difference d = difference();
  ASSERT_EQ(d.functions.size(), 1u);
  EXPECT_EQ(d.functions[0].kind, ChangeKind::kWaits);
  EXPECT_EQ(d.functions[0].layout, 0);
  // Something else has moved, and evicts it: its clocks are layout, but it was not moved.
  replace(after.functions, "0x00000200", "0x00000220");
  d = difference();
  EXPECT_EQ(d.functions[0].kind, ChangeKind::kWaits);
  EXPECT_EQ(d.functions[0].layout, 40);
  // Other data, or other code somewhere: then it may be due to these.
  replace(after.functions, "4096,dd", "4096,de");
  EXPECT_EQ(difference().functions[0].layout, 0);
  replace(after.functions, "4096,de", "4096,dd");
  replace(after.functions, "8,cc", "8,ce");
  EXPECT_EQ(difference().functions[0].layout, 0);
  // At another address, but with other code or another size.
  replace(after.functions, "8,ce", "8,cc");
  replace(after.functions, "0x00000100,64,aa", "0x00000120,64,ab");
  d = difference();
  EXPECT_EQ(d.functions[0].kind, ChangeKind::kWaits);
  EXPECT_EQ(d.functions[0].layout, 0);
  replace(after.functions, "64,ab", "68,aa");
  EXPECT_EQ(difference().functions[0].layout, 0);
}

TEST_F(LayoutTest, MoreStepsOfMovedCodeAreLayout) {
  replace(after.profile, "22,issue,,,50,50", "22,issue,,,80,80");
  replace(after.profile, "idle.capture,,,300", "idle.capture,,,270");
  replace(after.functions, "0x00000200", "0x00001200");
  after.elf = "22";
  Difference d = difference();
  ASSERT_EQ(d.functions.size(), 1u);
  EXPECT_EQ(d.functions[0].kind, ChangeKind::kLayout);
  EXPECT_EQ(d.functions[0].layout, 30);
  replace(after.functions, "96,bb", "96,bc");
  d = difference();
  EXPECT_EQ(d.functions[0].kind, ChangeKind::kExecutes);
  EXPECT_EQ(d.functions[0].layout, 0);
}

TEST_F(LayoutTest, AnInlinedFunctionMovesWithItsHolders) {
  for (RunMaker* r : {&before, &after}) r->functions += "irq,irq.c,0x00000200,96,bb\n";
  replace(after.profile, "icache,.text,bridge,100", "icache,.text,bridge,140");
  replace(after.profile, "idle.capture,,,300", "idle.capture,,,260");
  for (int n = 0; n < 2; ++n) replace(after.functions, "0x00000200", "0x00000220");
  after.elf = "22";
  EXPECT_EQ(difference().functions[0].kind, ChangeKind::kLayout);
  replace(after.functions, "irq,irq.c,0x00000220,96,bb\n", "");  // is held once less
  EXPECT_EQ(difference().functions[0].kind, ChangeKind::kWaits);
}

TEST_F(LayoutTest, WithoutAddressesLayoutIsNotTold) {
  replace(after.profile, "icache,.text,bridge,100", "icache,.text,bridge,140");
  replace(after.profile, "idle.capture,,,300", "idle.capture,,,260");
  replace(after.functions, "0x00000100", "0x00000120");
  after.elf = "22";
  EXPECT_EQ(difference().functions[0].kind, ChangeKind::kLayout);
  before.functions.clear();
  const Difference d = difference();
  EXPECT_EQ(d.functions[0].kind, ChangeKind::kWaits);
  EXPECT_THAT(difference_text(d, 9), HasSubstr("one of the profiles has no functions.csv"));
}

TEST_F(LayoutTest, ChangedCodeIsToldFromCodeThatItMoved) {
  replace(after.profile, "22,issue,,,50,50", "22,issue,,,80,80");
  replace(after.profile, "icache,.text,bridge,100", "icache,.text,bridge,120");
  replace(after.profile, "idle.capture,,,300", "idle.capture,,,250");
  replace(after.functions, "0x00000100", "0x00000120");
  replace(after.functions, "96,bb", "104,bf");
  after.elf = "22";
  const Difference d = difference();
  ASSERT_EQ(d.functions.size(), 2u);
  EXPECT_EQ(d.functions[0].function, "remap");
  EXPECT_EQ(d.functions[0].kind, ChangeKind::kExecutes);
  EXPECT_EQ(d.functions[0].layout, 0);
  EXPECT_EQ(d.functions[1].function, "irq");
  EXPECT_EQ(d.functions[1].kind, ChangeKind::kLayout);
}

TEST_F(LayoutTest, GainsByLayoutAreSaid) {
  replace(after.profile, "icache,.text,bridge,100", "icache,.text,bridge,60");
  replace(after.profile, "idle.capture,,,300", "idle.capture,,,340");
  replace(after.functions, "0x00000100", "0x00000120");
  after.elf = "22";
  EXPECT_THAT(difference_text(difference(), 9), HasSubstr("by layout (same code at other addresses): -40 clocks"));
}

TEST_F(LayoutTest, LayoutIsTheReasonFromHalfOfAChangeOn) {
  after.elf = "22";
  after.parameters["ddr.clock"] = "216MHz";
  replace(after.functions, "0x00000100", "0x00000120");
  replace(after.profile, "icache,.text,bridge,100,0\n",
          "icache,.text,bridge,140,0\nframes,irq,irq.c,7,uncached,registers,bridge,40,0\n");
  replace(after.profile, "idle.capture,,,300", "idle.capture,,,220");
  Difference d = difference();
  EXPECT_EQ(d.functions[0].layout, 40);
  EXPECT_EQ(d.functions[0].kind, ChangeKind::kLayout);
  replace(after.profile, "uncached,registers,bridge,40", "uncached,registers,bridge,41");
  replace(after.profile, "idle.capture,,,220", "idle.capture,,,219");
  EXPECT_EQ(difference().functions[0].kind, ChangeKind::kWaits);
  replace(after.profile, "irq.c,7,issue,,,50,50", "irq.c,7,issue,,,50,51");
  d = difference();
  EXPECT_EQ(d.functions[0].layout, 0);
  EXPECT_EQ(d.functions[0].kind, ChangeKind::kExecutes);
}

}  // namespace
}  // namespace fovea::regression
