// How a transfer is divided into commands: SPRUH82C, section 17.2.11.1.2 with its examples, and
// SPRUH73H, table 11-21.
#include "model/dma/core/commands.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

namespace fovea::dma {

bool operator==(const Command& a, const Command& b) {
  return a.address == b.address && a.bytes == b.bytes;
}
void PrintTo(const Command& c, std::ostream* os) { *os << c.bytes << " at " << c.address; }

namespace {

using List = std::vector<Command>;

List commands(unsigned acnt, unsigned bcnt, std::uint32_t address, int index, unsigned burst,
              unsigned constant_width = 0) {
  TransferRequest r;
  r.acnt = static_cast<std::uint16_t>(acnt);
  r.bcnt = static_cast<std::uint16_t>(bcnt);
  r.source = {address, index, constant_width != 0};
  r.fifo_bytes = static_cast<std::uint8_t>(constant_width);
  List out;
  for (Commands c(r, r.source, burst); !c.done(); c.pop()) {
    out.push_back(c.next());
    if (out.size() > 100'000) break;
  }
  return out;
}
std::vector<unsigned> sizes(const List& list) {
  std::vector<unsigned> out;
  for (const Command& c : list) out.push_back(c.bytes);
  return out;
}
using Sizes = std::vector<unsigned>;

TEST(Commands, FirstExampleOfTheGuide) {
  EXPECT_EQ(commands(8, 8, 64, 8, 32), (List{{64, 32}, {96, 32}}));
  // Not joined: eight commands of 8 bytes. Those at 191 and 251 cross a multiple of 64, where the
  // crossbar's bursts end.
  EXPECT_EQ(commands(8, 8, 191, 10, 32), (List{{191, 1},
                                               {192, 7},
                                               {201, 8},
                                               {211, 8},
                                               {221, 8},
                                               {231, 8},
                                               {241, 8},
                                               {251, 5},
                                               {256, 3},
                                               {261, 8}}));
  EXPECT_EQ(sizes(commands(8, 4, 192, 10, 32)), Sizes(4, 8));
}

TEST(Commands, SecondExampleOfTheGuide) {
  EXPECT_EQ(commands(64, 1, 31, 0, 32), (List{{31, 1}, {32, 32}, {64, 31}}));
  EXPECT_EQ(commands(64, 1, 513, 0, 32), (List{{513, 31}, {544, 32}, {576, 1}}));
}

TEST(Commands, NeverMoreThanTheBurstSize) {
  for (unsigned burst : {16u, 32u, 64u}) {
    EXPECT_EQ(sizes(commands(128, 1, 0, 0, burst)), Sizes(128 / burst, burst));
    EXPECT_EQ(sizes(commands(burst, 1, 0, 0, burst)), Sizes{burst});
    EXPECT_EQ(sizes(commands(burst + 1, 1, 0, 0, burst)), (Sizes{burst, 1}));
    EXPECT_EQ(sizes(commands(burst + 1, 1, burst - 1, 0, burst)), (Sizes{1, burst}));
    EXPECT_EQ(sizes(commands(burst - 1, 1, 0, 0, burst)), Sizes{burst - 1});
  }
}

TEST(Commands, ShortArraysAreOneCommandWhereverTheyBegin) {
  EXPECT_EQ(commands(8, 1, 30, 0, 32), (List{{30, 8}}));
  EXPECT_EQ(commands(32, 1, 16, 0, 32), (List{{16, 32}}));
  EXPECT_EQ(commands(32, 1, 48, 0, 32), (List{{48, 16}, {64, 16}}));  // a multiple of 64
}

TEST(Commands, EachArrayOfALongTransferIsAlignedAlone) {
  EXPECT_EQ(commands(40, 2, 16, 100, 32), (List{{16, 16}, {32, 24}, {116, 12}, {128, 28}}));
}

TEST(Commands, JoinedAreContiguousPowersOfTwoUpToTheBurstSize) {
  EXPECT_EQ(sizes(commands(4, 16, 0, 4, 32)), Sizes(2, 32));
  EXPECT_EQ(sizes(commands(32, 2, 0, 32, 32)), Sizes(2, 32));
  EXPECT_EQ(sizes(commands(1, 64, 0, 1, 32)), Sizes(2, 32));
  EXPECT_EQ(commands(4, 16, 30, 4, 32), (List{{30, 2}, {32, 32}, {64, 30}}));
  EXPECT_EQ(sizes(commands(3, 4, 0, 3, 32)), Sizes(4, 3));  // not a power of two
  EXPECT_EQ(sizes(commands(4, 4, 0, 5, 32)), Sizes(4, 4));  // not contiguous
  EXPECT_EQ(sizes(commands(4, 4, 0, -4, 32)), Sizes(4, 4));
  EXPECT_EQ(sizes(commands(4, 4, 0, 0, 32)), Sizes(4, 4));
}

TEST(Commands, JoinedUpToABurstSizeAndNotBeyond) {
  // An array of 64 bytes from 16 on: joined, its commands are aligned once; alone, in every array.
  EXPECT_EQ(sizes(commands(64, 2, 16, 64, 64)), (Sizes{48, 64, 16}));
  EXPECT_EQ(sizes(commands(64, 2, 16, 64, 32)), (Sizes{16, 32, 16, 16, 32, 16}));
  EXPECT_EQ(sizes(commands(32, 2, 16, 32, 16)), Sizes(4, 16));
}

TEST(Commands, AtMost1023ArraysAreJoined) {
  EXPECT_EQ(sizes(commands(2, 1023, 0, 2, 64)), [] {
    Sizes s(31, 64);
    s.push_back(62);
    return s;
  }());
  EXPECT_EQ(sizes(commands(2, 1024, 0, 2, 64)), Sizes(1024, 2));
}

TEST(Commands, NegativeIndices) {
  EXPECT_EQ(commands(4, 3, 100, -8, 32), (List{{100, 4}, {92, 4}, {84, 4}}));
  EXPECT_EQ(commands(1, 2, 0, -1, 32), (List{{0, 1}, {0xFFFF'FFFF, 1}}));
}

TEST(Commands, ConstantAddressingRepeatsThePort) {
  EXPECT_EQ(commands(10, 1, 96, 0, 32, 4), (List{{96, 4}, {96, 4}, {96, 2}}));
  EXPECT_EQ(commands(4, 2, 96, 32, 32, 4), (List{{96, 4}, {128, 4}}));
  EXPECT_EQ(commands(4, 2, 96, 4, 32, 4), (List{{96, 4}, {100, 4}}));  // never joined
  EXPECT_EQ(commands(64, 1, 96, 0, 32, 32), (List{{96, 32}, {96, 32}}));
}

/// A port wider than the burst size takes several commands, each of another part of it.
TEST(Commands, AWidePortTakesSmallBursts) {
  EXPECT_EQ(commands(80, 1, 96, 0, 16, 32),
            (List{{96, 16}, {112, 16}, {96, 16}, {112, 16}, {96, 16}}));
}

/// Any transfer: all bytes once and in order, no command larger than the burst size, none across a
/// multiple of 64, and of one array no more than needed.
TEST(Commands, CoverEveryTransfer) {
  std::mt19937 random(5);
  const auto below = [&](unsigned n) { return static_cast<unsigned>(random() % n); };
  for (int i = 0; i < 20'000; ++i) {
    const unsigned burst = 16u << below(3), acnt = 1 + below(200), bcnt = 1 + below(6);
    const std::uint32_t address = 0x1000 + below(300);
    const int index = below(2) ? static_cast<int>(acnt) : static_cast<int>(below(600)) - 300;
    std::vector<std::uint32_t> want, got;
    for (unsigned b = 0; b < bcnt; ++b)
      for (unsigned a = 0; a < acnt; ++a)
        want.push_back(address + static_cast<std::uint32_t>(index * static_cast<int>(b)) + a);
    const List list = commands(acnt, bcnt, address, index, burst);
    for (const Command& c : list) {
      ASSERT_GT(c.bytes, 0u);
      ASSERT_LE(c.bytes, burst);
      ASSERT_EQ(c.address / 64, (c.address + c.bytes - 1) / 64);
      for (unsigned a = 0; a < c.bytes; ++a) got.push_back(c.address + a);
    }
    ASSERT_EQ(got, want) << acnt << " x " << bcnt << " at " << address << ", index " << index
                         << ", burst " << burst;
    const std::size_t pieces = acnt <= burst ? 2 : (acnt + burst - 2) / burst + 1;
    ASSERT_LE(list.size(), pieces * bcnt);
  }
}

}  // namespace
}  // namespace fovea::dma
