// What the ISIF writes: every byte in memory, bursts, windows, formats, overflows.
#include "tb/video/capture_bench.h"

#include <bit>
#include <set>

namespace fovea::video {
namespace {

TEST_F(CaptureTest, WeavesBothFieldsByteExact) {
  const std::uint64_t overflows = b.isif.stats.overflows.count();
  capture_frame();
  EXPECT_EQ(wrong_bytes(kBuffer), 0u);
  EXPECT_EQ(b.memory.at(kBuffer)[-1], 0xEE);
  EXPECT_EQ(b.memory.at(kBuffer)[kRows * kRowBytes], 0xEE);
  EXPECT_EQ(b.memory.log.size(), kRows * kRowBytes / 64);
  EXPECT_EQ(b.isif.stats.overflows.count(), overflows);
}

TEST_F(CaptureTest, BurstLeavesWhenItsLastByteHasArrived) {
  capture_frame();
  const Clock clock(kByteClock);
  const std::uint64_t line3 = clock.edge_at_or_after(line_time(3));
  ASSERT_FALSE(b.memory.log.empty());
  EXPECT_EQ(b.memory.log[0].time, clock.edge(line3 + 288 + 64));
  EXPECT_EQ(b.memory.log[1].time, clock.edge(line3 + 288 + 128));
  EXPECT_EQ(b.memory.log[0].address, kBuffer);
}

TEST_F(CaptureTest, RowAt32BytesIsSplitAtMultiplesOf64) {
  set_address(kBuffer + 32);
  capture_frame();
  EXPECT_EQ(wrong_bytes(kBuffer + 32), 0u);
  ASSERT_GE(b.memory.log.size(), 3u);
  EXPECT_EQ(b.memory.log[0].bytes, 32u);
  EXPECT_EQ(b.memory.log[1].bytes, 64u);
  EXPECT_EQ(b.memory.log[2].bytes, 32u);
}

TEST_F(CaptureTest, WrongPitchShearsThePictureByTheDifference) {
  b.regs.write(HSIZE, kRowBytes / 32 + 1);
  capture_frame();
  EXPECT_EQ(wrong_bytes(kBuffer, kRowBytes + 32), 0u);
  // Seen with the intended pitch, row r holds what lies 128 r bytes on: rows of 160 bytes.
  unsigned moved = 0;
  for (unsigned r = 0; r < kRows; ++r)
    for (unsigned i = 0; i < kRowBytes; ++i) {
      const unsigned at = r * kRowBytes + i, row = at / 160, x = at % 160;
      const std::uint8_t expected = x < kRowBytes ? pattern(row, x) : 0xEE;
      ASSERT_EQ(b.memory.at(kBuffer)[at], expected) << "row " << r << " byte " << i;
      moved += expected != pattern(r, i);
    }
  EXPECT_GT(moved, kRows * kRowBytes / 2);
}

TEST_F(CaptureTest, FieldInversionSwapsTheRowsOfTheFields) {
  b.regs.write(SDOFST, 0x249 | 1u << 14);
  capture_frame();
  for (unsigned r = 0; r < kRows; ++r)
    EXPECT_EQ(b.memory.at(kBuffer + r * kRowBytes)[9], pattern(r ^ 1, 9)) << "row " << r;
}

TEST_F(CaptureTest, LineOffsetsOfOneRowStackAFieldsLines) {
  // LOFTS0 = LOFTS1 = 0, one row: field 0's lines follow each other.
  b.regs.write(SDOFST, 0x009);
  b.regs.write(SLV1, 100);  // keep field 1 out
  capture_frame();
  for (unsigned r = 0; r < kRows / 2; ++r)
    EXPECT_EQ(b.memory.at(kBuffer + r * kRowBytes)[9], pattern(2 * r, 9)) << "row " << r;
}

TEST_F(CaptureTest, WindowStartsAtSphAndSlv) {
  b.regs.write(SPH, 8);
  b.regs.write(SLV0, 3);
  b.regs.write(SLV1, 3);
  b.regs.write(LNV, 1);
  capture_frame();
  for (unsigned r = 0; r < 4; ++r)
    EXPECT_EQ(b.memory.at(kBuffer + r * kRowBytes)[0], pattern(r + 4, 8)) << "row " << r;
  EXPECT_EQ(b.memory.at(kBuffer + 4 * kRowBytes)[0], 0xEE);
}

TEST_F(CaptureTest, EachSwapBitTogglesTheByteOrder) {
  enable();
  for (const std::uint32_t bit : {0x4u, 0x10u, 0x800u, 0x1000u}) {
    b.regs.write(CCDCFG, kUyvy ^ bit);
    run_until(b.wire.next_frame() + kFrame - kPsPerUs);
    EXPECT_EQ(b.memory.at(kBuffer)[0], pattern(0, 1)) << "bit " << bit;
    EXPECT_EQ(b.memory.at(kBuffer)[1], pattern(0, 0)) << "bit " << bit;
  }
}

TEST_F(CaptureTest, EitherMsbBitInvertsTheTopBitOfChromaAndBothLeaveIt) {
  enable();
  const auto check = [&](std::uint32_t ccdcfg, unsigned order, std::uint8_t change) {
    b.regs.write(CCDCFG, ccdcfg);
    run_until(b.wire.next_frame() + kFrame - kPsPerUs);
    for (unsigned r = 0; r < kRows; ++r)
      for (unsigned i = 0; i < kRowBytes; ++i) {
        const unsigned from = i ^ order;  // byte of the wire; chroma is on the even ones
        ASSERT_EQ(b.memory.at(kBuffer + r * kRowBytes)[i],
                  pattern(r, from) ^ (from % 2 == 0 ? change : 0))
            << std::hex << ccdcfg << std::dec << " row " << r << " byte " << i;
      }
  };
  check(kUyvy | 0x2000, 0, 0x80);
  check(kUyvy | 0x4000, 0, 0x80);
  check(kUyvy | 0x6000, 0, 0);
  check((kUyvy | 0x2000) ^ 0x800, 1, 0x80);  // Y first in memory
}

TEST_F(CaptureTest, InvertedFieldIdSwapsTheFields) {
  b.regs.write(MODESET, 2u << 12 | 1u << 7 | 1u << 4 | 1u << 2);
  enable();
  run_until(line_time(3) + kPsPerUs);
  EXPECT_EQ(b.regs.read(MODESET) >> 15, 1u);
  run_until(line_time(15) + kPsPerUs);
  EXPECT_EQ(b.regs.read(MODESET) >> 15, 0u);
  run_until(frame_start_ + 2 * kFrame - kPsPerUs);
  for (unsigned r = 0; r < kRows; ++r)
    EXPECT_EQ(b.memory.at(kBuffer + r * kRowBytes)[9], pattern(r ^ 1, 9)) << "row " << r;
  // The frame that counts begins with the wire's second field.
  ASSERT_EQ(b.ended.size(), 2u);
  EXPECT_FALSE(b.ended[0].complete);
  EXPECT_TRUE(b.ended[1].complete);
}

// CCDMD = 0: the rows of a field lie one behind the other, and each field is a frame.
TEST_F(CaptureTest, ProgressiveFieldsAreFrames) {
  b.regs.write(MODESET, 2u << 12 | 1u << 2);
  b.regs.write(SDOFST, 0);
  enable();
  run_until(line_time(12));
  ASSERT_EQ(b.ended.size(), 1u);
  EXPECT_TRUE(b.ended[0].complete);
  EXPECT_EQ(b.ended[0].index, 0u);
  for (unsigned r = 0; r < kRows / 2; ++r)
    for (unsigned i = 0; i < kRowBytes; ++i)
      ASSERT_EQ(b.memory.at(kBuffer + r * kRowBytes)[i], pattern(2 * r, i)) << r << ' ' << i;
  EXPECT_EQ(b.memory.at(kBuffer + kRows / 2 * kRowBytes)[0], 0xEE) << "no row beyond";
  set_address(kOther);
  run_until(frame_start_ + kFrame - kPsPerUs);
  ASSERT_EQ(b.ended.size(), 2u);
  EXPECT_TRUE(b.ended[1].complete);
  EXPECT_EQ(b.ended[1].index, 1u);
  EXPECT_EQ(b.started.size(), 2u);
  for (unsigned r = 0; r < kRows / 2; ++r) EXPECT_EQ(b.memory.at(kOther + r * kRowBytes)[5], pattern(2 * r + 1, 5));
}

TEST_F(CaptureTest, WholeLineIsAWindowAndOneSampleMoreIsCut) {
  Diagnostics& d = b.diagnostics;
  d.clear();
  b.regs.write(HSIZE, kActiveBytes / 32);
  b.regs.write(LNH, kActiveBytes - 1);
  capture_frame();
  EXPECT_TRUE(d.counts().empty());
  for (unsigned i = 0; i < kActiveBytes; ++i)
    ASSERT_EQ(b.memory.at(kBuffer + kActiveBytes)[i], pattern(1, i)) << i;
  // Two samples further the last two do not exist; whole pairs of four samples are captured.
  std::fill(b.memory.bytes.begin(), b.memory.bytes.end(), 0xEE);
  b.regs.write(SPH, 2);
  run_until(frame_start_ + 2 * kFrame - kPsPerUs);
  ASSERT_EQ(d.counts().size(), 1u);
  EXPECT_EQ(d.counts().begin()->first.second,
            "ISIF window leaves the active part of the line; cut");
  EXPECT_EQ(b.memory.at(kBuffer)[kActiveBytes - 5], pattern(0, kActiveBytes - 3));
  EXPECT_EQ(b.memory.at(kBuffer)[kActiveBytes - 4], 0xEE);
  d.clear();
}

TEST_F(CaptureTest, FramesCountTheBurstsThatTheyLost) {
  const std::uint64_t before = b.isif.stats.overflows.count();
  b.memory.latency = 10 * kLine;  // in each field two rows find places, six find none
  enable();
  run_until(frame_start_ + kFrame - kPsPerUs);
  b.memory.latency = 100 * kPsPerNs;
  run_until(frame_start_ + 2 * kFrame - kPsPerUs);
  ASSERT_EQ(b.ended.size(), 2u);
  EXPECT_EQ(b.ended[0].overflows, 2u * 2 * (8 - 2));
  EXPECT_EQ(b.ended[1].overflows, 0u);
  EXPECT_EQ(b.isif.stats.overflows.count() - before, 2u * 2 * (8 - 2));
}

TEST_F(CaptureTest, StalledMemoryOverflowsAndLosesExactlyTheBurstsWithoutAPlace) {
  // Two bursts a line, 64 us apart in pairs; answers after 10 lines: 4 places hold two lines, all
  // later lines of the field lose theirs.
  const std::uint64_t before = b.isif.stats.overflows.count();
  b.memory.latency = 10 * kLine;
  b.top_regs.write(0x10, 0x1F1F1F00);
  b.regs.write(VDINT0, 9);
  enable();
  run_until(line_time(12));
  EXPECT_EQ(b.isif.stats.overflows.count() - before, 2u * (8 - 2));
  EXPECT_TRUE(b.isif.overflowed());
  EXPECT_EQ(b.edges[0].rises.size(), 1u) << "interrupts go on";
  EXPECT_EQ(b.memory.at(kBuffer)[0], pattern(0, 0));
  EXPECT_EQ(b.memory.at(kBuffer + 4 * kRowBytes)[0], 0xEE);
}

TEST_F(CaptureTest, SmallerWriteBufferLosesMore) {
  const std::uint64_t before = b.isif.stats.overflows.count();
  b.params.write_buffer_bursts.set("2");
  b.memory.latency = 10 * kLine;
  enable();
  run_until(line_time(12));
  b.params.write_buffer_bursts.set("4");
  EXPECT_EQ(b.isif.stats.overflows.count() - before, 2u * (8 - 1));
}

TEST_F(CaptureTest, SmallerBurstParameterGivesSmallerBursts) {
  b.params.burst.set("32B");
  capture_frame();
  b.params.burst.set("64B");
  EXPECT_EQ(wrong_bytes(kBuffer), 0u);
  EXPECT_EQ(b.memory.log.size(), kRows * kRowBytes / 32);
}

TEST_F(CaptureTest, PlaceFreedAtABurstsTimeServesOnlyLaterBursts) {
  // With one line of 5 bursts and four places, the fifth burst (4 x 64 samples after the first)
  // finds a place if the first was acknowledged before, and none if at that very time.
  const Clock clock(kByteClock);
  b.regs.write(LNH, 5 * 64 - 1);
  b.regs.write(HSIZE, 10);
  b.regs.write(LNV, 0);
  b.regs.write(SLV1, 100);
  const std::uint64_t s = clock.edge_at_or_after(line_time(3)) + 288;
  const Picoseconds first = clock.edge(s + 64), fifth = clock.edge(s + 320);
  const std::uint64_t before = b.isif.stats.overflows.count();
  b.memory.latency = fifth - first - 1;
  capture_frame();
  EXPECT_EQ(b.isif.stats.overflows.count() - before, 0u);
  const std::uint64_t s2 = s + kSmall.frame_bytes();
  b.memory.latency = clock.edge(s2 + 320) - clock.edge(s2 + 64);
  run_for(kFrame);
  EXPECT_EQ(b.isif.stats.overflows.count() - before, 1u);
}

TEST_F(CaptureTest, SingleBitErrorsInTheCodesAreCorrected) {
  const std::uint64_t before = b.isif.stats.corrected_codes.count();
  b.wire.damage = [](unsigned line, std::uint8_t xy) {
    return static_cast<std::uint8_t>(xy ^ 1u << line % 8);
  };
  capture_frame();
  EXPECT_EQ(wrong_bytes(kBuffer), 0u);
  EXPECT_GE(b.isif.stats.corrected_codes.count() - before, 23u);
}

TEST(WrongBitsTest, EachOfTheSevenAndEachPairOfThemHasItsTurn) {
  for (const unsigned bits : {1u, 2u}) {
    const unsigned count = bits == 1 ? 7 : 21;
    std::set<unsigned> seen;
    for (unsigned n = 0; n < count; ++n) {
      seen.insert(wrong_bits(bits, n));
      EXPECT_EQ(wrong_bits(bits, n), wrong_bits(bits, n + count));
    }
    EXPECT_EQ(seen.size(), count);
    for (const unsigned mask : seen) {
      EXPECT_LT(mask, 0x80u) << "bit 7 is always 1";
      EXPECT_EQ(static_cast<unsigned>(std::popcount(mask)), bits);
    }
  }
}

TEST_F(CaptureTest, EveryWrongBitIsCorrectedWhereverTheLineIs) {
  for (unsigned n = 0; n < 7; ++n) {
    const std::uint64_t before = b.isif.stats.corrected_codes.count();
    b.wire.damage = [n](unsigned, std::uint8_t xy) {
      return static_cast<std::uint8_t>(xy ^ wrong_bits(1, n));
    };
    enable();
    std::fill(b.memory.bytes.begin(), b.memory.bytes.end(), 0xEE);
    run_until(b.wire.next_frame() + kFrame - kPsPerUs);
    EXPECT_EQ(wrong_bytes(kBuffer), 0u) << "bit " << n;
    EXPECT_GE(b.isif.stats.corrected_codes.count() - before, 24u) << "bit " << n;
  }
}

// The last good field and blanking bits hold where a code is beyond correction.
TEST_F(CaptureTest, EveryPairOfWrongBitsIsFoundAndMattersOnlyWhereThePictureBegins) {
  for (const unsigned at : {6u, 3u})
    for (unsigned n = 0; n < 21; ++n) {
      const std::uint64_t bad = b.isif.stats.bad_codes.count();
      const std::uint64_t corrected = b.isif.stats.corrected_codes.count();
      b.wire.damage = [=](unsigned line, std::uint8_t xy) {
        return static_cast<std::uint8_t>(line == at ? xy ^ wrong_bits(2, n) : xy);
      };
      enable();
      const Picoseconds start = b.wire.next_frame();
      run_until(start - kPsPerUs);
      std::fill(b.memory.bytes.begin(), b.memory.bytes.end(), 0xEE);
      run_until(start + kFrame - kPsPerUs);
      EXPECT_GE(b.isif.stats.bad_codes.count() - bad, 1u);
      EXPECT_EQ(b.isif.stats.corrected_codes.count(), corrected);
      if (at == 6) {
        EXPECT_EQ(wrong_bytes(kBuffer), 0u) << "pair " << n;
        continue;
      }
      // Line 3 is where V falls: the first field begins a line late, and its rows lie one too high.
      for (unsigned r = 0; r + 2 < kRows; ++r)
        EXPECT_EQ(b.memory.at(kBuffer + r * kRowBytes)[9], pattern(r % 2 ? r : r + 2, 9))
            << "pair " << n << " row " << r;
    }
}

TEST_F(CaptureTest, OnlyBytesOfLinesThatAreCapturedAreTaken) {
  b.regs.write(SLV0, 2);
  b.regs.write(SLV1, 6);
  b.regs.write(LNV, 2);
  capture_frame();
  EXPECT_EQ(b.wire.taken, (std::vector<unsigned>{4, 5, 6, 20, 21, 22})) << "the ISIF's line 1 is line 3 or 15";
  b.wire.taken.clear();
  b.regs.write(SYNCEN, 1);
  run_until(frame_start_ + 2 * kFrame);
  EXPECT_EQ(b.wire.taken, std::vector<unsigned>{}) << "none is written";
}

TEST_F(CaptureTest, OfAShortLineOnlyWhatCameIsWritten) {
  b.wire.missing = [](unsigned line) { return line == 5 ? kActiveBytes - 100u : 0u; };
  capture_frame();
  b.wire.missing = nullptr;
  for (unsigned r = 0; r < kRows; ++r)
    for (unsigned i = 0; i < kRowBytes; ++i)  // line 5 carries row 4
      ASSERT_EQ(b.memory.at(kBuffer + r * kRowBytes)[i], r == 4 && i >= 100 ? 0xEE : pattern(r, i))
          << "row " << r << " byte " << i;
}

TEST_F(CaptureTest, ALastLineOfWhichNothingCameEndsTheFrame) {
  b.wire.missing = [](unsigned line) { return line == 22 ? kActiveBytes : 0u; };
  capture_frame();
  b.wire.missing = nullptr;
  ASSERT_EQ(b.ended.size(), 1u);
  EXPECT_TRUE(b.ended[0].complete);
  EXPECT_EQ(b.memory.at(kBuffer + (kRows - 1) * kRowBytes)[0], 0xEE);
}

TEST_F(CaptureTest, WithoutCorrectionTheSameErrorsSpoilTheCapture) {
  b.regs.write(REC656IF, 1);
  b.wire.damage = [](unsigned line, std::uint8_t xy) {
    return static_cast<std::uint8_t>(line == 6 ? xy ^ 0x20 : xy);  // V set for one line
  };
  capture_frame();
  EXPECT_GT(wrong_bytes(kBuffer), 0u);
}

}  // namespace
}  // namespace fovea::video

int sc_main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  fovea::video::CaptureBench bench;
  fovea::video::capture_bench = &bench;
  return RUN_ALL_TESTS();
}
