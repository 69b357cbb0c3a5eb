// The memory side of an AXI4 port, edge by edge. Edges are at multiples of 1000 ps.
#include "model/engine/rtl/axi_memory.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numeric>

#include "model/engine/rtl/slave_checker.h"

namespace fovea::rtl {
namespace {

using testing::ElementsAre;

struct Issued {
  AxiMemory::Burst burst;
  std::vector<std::uint8_t> data;
  Picoseconds at;
};

/// A master of which the test sets the wires, and a memory port that remembers.
struct Rig {
  explicit Rig(unsigned places = 16)
      : memory(places, [this](const AxiMemory::Burst& b, Picoseconds at) {
          issued.push_back({b, {b.data.begin(), b.data.end()}, at});
        }) {
    wires.r.ready = wires.b.ready = true;
  }
  /// The next edge, with what the test has put on the wires; requests and data are taken from them when heard.
  void edge() {
    now += 1000;
    memory.drive(now, wires);
    checker.clock(wires);
    memory.sample(now, wires);
    seen = wires;
    if (wires.ar.ready) wires.ar.valid = false;
    if (wires.aw.ready) wires.aw.valid = false;
    if (wires.w.ready) wires.w.valid = false;
  }
  void until(Picoseconds last) {
    while (now < last) edge();
  }
  void ask(unsigned id, std::uint32_t address, unsigned beats) {
    wires.ar = {true, false, id, address, beats - 1};
    edge();
  }
  void answer(std::size_t n, Picoseconds first, Picoseconds last, bool error = false) {
    std::vector<std::uint8_t> data(issued[n].burst.write ? 0 : issued[n].burst.bytes);
    std::iota(data.begin(), data.end(), static_cast<std::uint8_t>(issued[n].burst.address));
    memory.answered(issued[n].burst.tag, error, data, first, last);
  }
  /// Writes a burst: strobes of each beat.
  void write(std::uint32_t address, const std::vector<unsigned>& strobes) {
    wires.aw = {true, false, 0, address, static_cast<unsigned>(strobes.size()) - 1};
    for (std::size_t n = 0; n < strobes.size(); ++n) {
      wires.w = {true, false, n + 1 == strobes.size(), 0x0706050403020100u + 0x1010101010101010u * n, strobes[n]};
      edge();
    }
  }
  std::vector<Issued> issued;
  AxiMemory memory;
  AxiWires wires, seen;
  AxiAnswerChecker checker;
  Picoseconds now = 0;
};

TEST(AxiMemoryTest, AReadIsOneRequestWhoseBeatsComeStrictlyAfterTheirTimes) {
  Rig rig;
  rig.ask(1, 0x8000'0020, 4);
  ASSERT_EQ(rig.issued.size(), 1u);
  const AxiMemory::Burst& b = rig.issued[0].burst;
  EXPECT_EQ(rig.issued[0].at, 1000u);
  EXPECT_FALSE(b.write);
  EXPECT_EQ(b.id, 1u);
  EXPECT_EQ(b.address, 0x8000'0020u);
  EXPECT_EQ(b.bytes, 32u);
  rig.answer(0, 5000, 8000);  // beats at 5000, 6000, 7000, 8000
  rig.until(5000);
  EXPECT_FALSE(rig.seen.r.valid);
  std::vector<Picoseconds> edges;
  for (std::uint64_t word = 0x2726252423222120u; edges.size() < 4; rig.edge())
    if (rig.seen.r.valid) {
      edges.push_back(rig.now);
      EXPECT_EQ(rig.seen.r.data, word);
      EXPECT_EQ(rig.seen.r.id, 1u);
      EXPECT_EQ(rig.seen.r.response, kOkay);
      EXPECT_EQ(rig.seen.r.last, edges.size() == 4);
      word += 0x0808080808080808u;
    }
  EXPECT_THAT(edges, ElementsAre(6000, 7000, 8000, 9000));
  EXPECT_TRUE(rig.memory.idle());
}

TEST(AxiMemoryTest, ABeatOnePicosecondBeforeAnEdgeIsOnItAndOneAClockAtMostComes) {
  Rig rig;
  rig.ask(0, 64, 2);
  rig.answer(0, 4999, 4999);
  rig.until(5000);
  EXPECT_TRUE(rig.seen.r.valid);
  EXPECT_EQ(rig.seen.r.data, 0x4746454443424140u);
  rig.edge();
  EXPECT_TRUE(rig.seen.r.valid && rig.seen.r.last);
  rig.edge();
  EXPECT_FALSE(rig.seen.r.valid);
}

TEST(AxiMemoryTest, ABeatStaysUntilItIsTaken) {
  Rig rig;
  rig.ask(0, 0, 1);
  rig.wires.r.ready = false;
  rig.answer(0, 1500, 1500);
  for (unsigned n = 0; n < 3; ++n) {
    rig.edge();
    EXPECT_TRUE(rig.seen.r.valid);
  }
  rig.wires.r.ready = true;
  rig.edge();
  EXPECT_TRUE(rig.seen.r.valid);
  rig.edge();
  EXPECT_FALSE(rig.seen.r.valid);
}

TEST(AxiMemoryTest, AnIdentifierKeepsItsOrderAndAnotherMayOvertake) {
  Rig rig;
  rig.ask(0, 0x00, 1);
  rig.ask(0, 0x10, 1);
  rig.ask(1, 0x20, 1);
  rig.answer(1, 3100, 3100);
  rig.answer(2, 4100, 4100);
  rig.answer(0, 6100, 6100);
  std::vector<std::uint64_t> words;
  for (rig.until(3000); words.size() < 3 && rig.now < 20000;) {
    rig.edge();
    if (rig.seen.r.valid) words.push_back(rig.seen.r.data & 255);
  }
  EXPECT_THAT(words, ElementsAre(0x20, 0x00, 0x10));
}

TEST(AxiMemoryTest, AWriteIsARequestForEachRunOfItsStrobes) {
  Rig rig;
  rig.write(0x8000'0010, {0xF0, 0xFF, 0x0F, 0xF0});
  ASSERT_EQ(rig.issued.size(), 2u);
  EXPECT_TRUE(rig.issued[0].burst.write);
  EXPECT_EQ(rig.issued[0].burst.address, 0x8000'0014u);
  EXPECT_THAT(rig.issued[0].data, ElementsAre(0x04, 0x05, 0x06, 0x07, 0x10, 0x11, 0x12, 0x13, 0x14, 0x15, 0x16, 0x17,
                                              0x20, 0x21, 0x22, 0x23));
  EXPECT_EQ(rig.issued[1].burst.address, 0x8000'002Cu);
  EXPECT_THAT(rig.issued[1].data, ElementsAre(0x34, 0x35, 0x36, 0x37));
  EXPECT_EQ(rig.issued[0].at, 4000u);  // with the last data
  // Answered when both are.
  rig.answer(0, 9000, 9000);
  rig.until(10000);
  EXPECT_FALSE(rig.seen.b.valid);
  rig.answer(1, 12000, 12000);
  rig.until(12000);
  EXPECT_FALSE(rig.seen.b.valid);
  rig.edge();
  EXPECT_TRUE(rig.seen.b.valid);
  EXPECT_EQ(rig.seen.b.response, kOkay);
  EXPECT_TRUE(rig.memory.idle());
}

TEST(AxiMemoryTest, DataMayComeBeforeTheirAddressAndWithoutAByteNothingIsWritten) {
  Rig rig;
  rig.wires.w = {true, false, true, 7, 0};
  rig.edge();
  rig.wires.aw = {true, false, 0, 64, 0};
  rig.edge();
  EXPECT_FALSE(rig.seen.b.valid);
  rig.edge();
  EXPECT_TRUE(rig.seen.b.valid);
  EXPECT_TRUE(rig.issued.empty());
}

TEST(AxiMemoryTest, WithoutAPlaceNoRequestIsTakenAndAPlaceIsFreeStrictlyAfterItsEnd) {
  Rig rig(2);
  rig.ask(0, 0x000, 1);
  rig.ask(0, 0x100, 1);
  rig.wires.ar = {true, false, 0, 0x200, 0};
  rig.answer(0, 4000, 4000);
  rig.until(4000);
  EXPECT_FALSE(rig.seen.ar.ready);
  EXPECT_EQ(rig.issued.size(), 2u);
  rig.edge();
  EXPECT_TRUE(rig.seen.ar.ready);
  ASSERT_EQ(rig.issued.size(), 3u);
  EXPECT_EQ(rig.issued[2].at, 5000u);
}

TEST(AxiMemoryTest, PartsOfAWriteWaitForAPlaceAndHoldBackWhatComesAfter) {
  Rig rig(1);
  rig.write(0, {0x0F, 0x0F});
  EXPECT_EQ(rig.issued.size(), 1u);
  rig.wires.ar = {true, false, 0, 0x200, 0};
  rig.edge();
  EXPECT_FALSE(rig.seen.ar.ready);
  rig.answer(0, 4000, 4000);
  rig.until(5000);
  EXPECT_EQ(rig.issued.size(), 2u);
  EXPECT_EQ(rig.issued[1].burst.address, 8u);
  rig.answer(1, 5500, 5500);
  rig.until(6000);
  EXPECT_TRUE(rig.seen.ar.ready);
}

TEST(AxiMemoryTest, AsManyWritesAsAllowedAreUnanswered) {
  Rig rig;
  for (unsigned n = 0; n < AxiMemory::kWrites; ++n) rig.write(64 * n, {0xFF});
  EXPECT_EQ(rig.issued.size(), AxiMemory::kWrites);
  rig.wires.aw = {true, false, 0, 0x1000, 0};
  rig.edge();
  EXPECT_FALSE(rig.seen.aw.ready);
  rig.answer(0, rig.now + 1, rig.now + 1);
  rig.edge();
  EXPECT_TRUE(rig.seen.b.valid);
  rig.edge();
  EXPECT_TRUE(rig.seen.aw.ready);
}

TEST(AxiMemoryTest, ARequestThatNoSlaveAnswersIsADecodeError) {
  Rig rig;
  rig.ask(1, 0, 2);
  rig.answer(0, 1500, 1500, true);
  rig.edge();
  EXPECT_EQ(rig.seen.r.response, kDecodeError);
  EXPECT_EQ(rig.seen.r.data, 0u);
  rig.edge();
  EXPECT_EQ(rig.seen.r.response, kDecodeError);
  rig.write(64, {0x0F, 0x0F});
  rig.answer(1, rig.now, rig.now, true);
  rig.answer(2, rig.now, rig.now);
  rig.edge();
  EXPECT_TRUE(rig.seen.b.valid);
  EXPECT_EQ(rig.seen.b.response, kDecodeError);
}

TEST(AxiMemoryTest, AfterAResetAnswersFromBeforeAreIgnored) {
  Rig rig;
  rig.ask(0, 0, 1);
  rig.memory.reset();
  rig.checker = {};
  EXPECT_TRUE(rig.memory.idle());
  rig.answer(0, 1500, 1500);
  rig.ask(0, 0x40, 1);
  rig.edge();
  EXPECT_FALSE(rig.seen.r.valid);
  rig.answer(1, 3500, 3500);
  rig.until(4000);
  EXPECT_EQ(rig.seen.r.data & 255, 0x40u);
}

}  // namespace
}  // namespace fovea::rtl
