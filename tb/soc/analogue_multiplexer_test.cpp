// The analogue multiplexer alone, and what model and firmware agree on about its lines.
#include "model/board/analogue_multiplexer.h"

#include <gtest/gtest.h>

#include <vector>

#include "model/contract/phases.h"
#include "model/contract/switches.h"
#include "tb/periph/bench.h"

namespace fovea::board {
namespace {

struct Watched {
  std::vector<unsigned> led;
  AnalogueMultiplexer part{[this](unsigned channel) { led.push_back(channel); }};
};
using Channels = std::vector<unsigned>;

TEST(AnalogueMultiplexer, LeadsTheChannelOfItsSelectLinesThrough) {
  Watched w;
  EXPECT_EQ(w.part.channel(), 0u) << "lines that no output drives are low";
  for (unsigned channel = 0; channel < MULTIPLEXER_CHANNELS; ++channel) {
    w.part.select(channel);
    EXPECT_EQ(w.part.channel(), channel);
  }
  EXPECT_EQ(w.led, (Channels{1, 2, 3, 4, 5, 6, 7})) << "each change is said once";
  w.part.select(7);
  EXPECT_EQ(w.led.size(), 7u) << "the same again is no change";
  w.part.select(8 | 2);
  EXPECT_EQ(w.part.channel(), 2u) << "there is no fourth line";
}

TEST(AnalogueMultiplexer, AStuckLineKeepsItsLevel) {
  Watched w;
  w.part.select(2);
  w.part.stick(0, true);
  EXPECT_EQ(w.part.channel(), 3u) << "at once";
  w.part.select(4);
  w.part.select(5);
  EXPECT_EQ(w.part.channel(), 5u);
  w.part.stick(2, false);
  w.part.stick(0, std::nullopt);
  w.part.select(6);
  EXPECT_EQ(w.part.channel(), 2u);
  w.part.stick(2, std::nullopt);
  EXPECT_EQ(w.part.channel(), 6u) << "whole again, it has the level that drives it";
  EXPECT_EQ(w.led, (Channels{2, 3, 5, 1, 2, 6}));
  EXPECT_THROW(w.part.stick(MULTIPLEXER_LINES, true), std::out_of_range);
}

TEST(AnalogueMultiplexer, ItsPinsBelongToNoOtherPart) {
  for (unsigned channel = 0; channel < MULTIPLEXER_CHANNELS; ++channel)
    EXPECT_EQ(MULTIPLEXER_CHANNEL(MULTIPLEXER_WORD(channel) | ~MULTIPLEXER_PIN_MASK), channel);
  const unsigned first = 32 * MULTIPLEXER_BANK + MULTIPLEXER_LOW;
  EXPECT_EQ(first, 40u);
  EXPECT_GE(first, SWITCH_COUNT);
  EXPECT_NE(MULTIPLEXER_BANK, PHASE_BANK) << "phase marks write the whole word of their bank";
  EXPECT_LE(MULTIPLEXER_LOW + MULTIPLEXER_LINES, 32u);
}

}  // namespace
}  // namespace fovea::board

FOVEA_SC_TEST_MAIN
