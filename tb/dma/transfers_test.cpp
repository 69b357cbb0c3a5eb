// What a request transfers and what it leaves in the parameter RAM: the update tables of SPRUEE4A
// (sections 2.3.2 to 2.3.7) and SPRUH82C (17.2.3.2 to 17.2.3.7), with sequences computed by hand.
#include "tb/dma/channel_bench.h"

namespace fovea::dma {
namespace {

struct DmaTransfers : ChannelBench {
  /// One request of channel 5 takes these addresses; the set then has these addresses and counts.
  struct Step {
    std::uint32_t source, destination;  // of the request
    std::uint32_t next_source, next_destination;
    unsigned bcnt, ccnt;  // left in the set
  };
  void expect_step(const Step& s, unsigned bcnt_of_request) {
    trigger_and_run(5);
    EXPECT_EQ(last().source.address, s.source);
    EXPECT_EQ(last().destination.address, s.destination);
    EXPECT_EQ(last().bcnt, bcnt_of_request);
    const auto w = words(5);
    EXPECT_EQ(w[1], s.next_source);
    EXPECT_EQ(w[3], s.next_destination);
    EXPECT_EQ(w[2] >> 16, s.bcnt);
    EXPECT_EQ(w[7], s.ccnt);
  }
};

TEST_F(DmaTransfers, ASyncAddsBidxWithinAFrameAndCidxToTheLastArray) {
  const Set set{.source = 0x1000,
                .destination = 0x2000,
                .acnt = 4,
                .bcnt = 2,
                .ccnt = 2,
                .source_b = 16,
                .destination_b = 4,
                .source_c = 100,
                .destination_c = -20,
                .reload = 2};
  fill(5, set);
  expect_step({0x1000, 0x2000, 0x1010, 0x2004, 1, 2}, 1);
  expect_step({0x1010, 0x2004, 0x1074, 0x1FF0, 2, 1}, 1);  // 0x1010 + 100, 0x2004 - 20
  expect_step({0x1074, 0x1FF0, 0x1084, 0x1FF4, 1, 1}, 1);
  trigger_and_run(5);
  EXPECT_EQ(last().source.address, 0x1084u);
  EXPECT_EQ(last().destination.address, 0x1FF4u);
  EXPECT_EQ(last().acnt, 4u);
  EXPECT_EQ(words(5), kNullLinked);
  EXPECT_EQ(submitted.size(), 4u);
}

// Activity of the parameter RAM. A set of two arrays is filled (8 words over the bus) and served twice: read and
// updated, read and replaced by the set that it links to, which is read too (8 more words were written there).
TEST_F(DmaTransfers, AccessesToTheParameterRamAreCounted) {
  fill(100, {.source = 0x9000});
  fill(5, {.bcnt = 2, .link = 32 * 100});
  const auto& n = core.counts();
  EXPECT_EQ(n.words_written, 16u);
  EXPECT_EQ(n.words_read, 0u);
  trigger_and_run(5);
  EXPECT_EQ(n.sets_read, 1u);
  EXPECT_EQ(n.sets_written, 1u);
  trigger_and_run(5);
  EXPECT_EQ(n.sets_read, 3u);
  EXPECT_EQ(n.sets_written, 2u);
  words(5);
  EXPECT_EQ(n.words_read, 8u);
  // A static set is read only; the null set behind the last one is written without a read of another.
  fill(5, {.opt = kStatic});
  trigger_and_run(5);
  EXPECT_EQ(n.sets_read, 4u);
  EXPECT_EQ(n.sets_written, 2u);
  fill(5, {});
  trigger_and_run(5);
  EXPECT_EQ(n.sets_read, 5u);
  EXPECT_EQ(n.sets_written, 3u);
  EXPECT_EQ(regs.write(kPaRam + 10, 2, 7), Access::kOk);  // half a word is an access
  EXPECT_EQ(n.words_written, 33u);
  EXPECT_EQ(n.words_read, 8u);
}

TEST_F(DmaTransfers, AbSyncAddsCidxToTheFirstArrayAndKeepsBcnt) {
  fill(5, {.opt = kAbSync,
           .source = 0x1000,
           .destination = 0x2000,
           .acnt = 4,
           .bcnt = 2,
           .ccnt = 3,
           .source_b = 16,
           .destination_b = -4,
           .source_c = 100,
           .destination_c = -20,
           .reload = 7});
  expect_step({0x1000, 0x2000, 0x1064, 0x1FEC, 2, 2}, 2);
  EXPECT_EQ(last().source.index, 16);
  EXPECT_EQ(last().destination.index, -4);
  expect_step({0x1064, 0x1FEC, 0x10C8, 0x1FD8, 2, 1}, 2);
  trigger_and_run(5);
  EXPECT_EQ(last().source.address, 0x10C8u);
  EXPECT_EQ(words(5), kNullLinked);
  EXPECT_EQ(submitted.size(), 3u);
}

TEST_F(DmaTransfers, BcntrldIsTheNextFramesBcnt) {
  fill(5, {.acnt = 1, .bcnt = 1, .ccnt = 2, .source_b = 1, .source_c = 10, .reload = 3});
  trigger_and_run(5);
  EXPECT_EQ(words(5)[2], 0x0003'0001u);
  for (int i = 0; i < 3; ++i) trigger_and_run(5);
  EXPECT_EQ(last().source.address, 0x100Cu);
  EXPECT_EQ(words(5), kNullLinked);
}

TEST_F(DmaTransfers, ReloadingZeroMakesADummySet) {
  fill(5, {.acnt = 1, .bcnt = 1, .ccnt = 2, .reload = 0});
  trigger_and_run(5);
  EXPECT_EQ(words(5)[2], 1u);
  trigger_and_run(5);
  EXPECT_EQ(submitted.size(), 1u);
  EXPECT_EQ(words(5), kNullLinked);
  EXPECT_EQ(read(kEmr), 0u);
}

TEST_F(DmaTransfers, IndicesAreSignedAndAddressesWrap) {
  fill(5, {.source = 0x4000,
           .destination = 0xFFFF'FFF0,
           .bcnt = 2,
           .source_b = -32768,
           .destination_b = 32767});
  trigger_and_run(5);
  EXPECT_EQ(words(5)[1], 0x4000u - 32768u);
  EXPECT_EQ(words(5)[3], 0x0000'7FEFu);
}

TEST_F(DmaTransfers, CountsAreUnsignedWithSixteenBits) {
  fill(5, {.opt = kAbSync, .acnt = 65535, .bcnt = 65535, .ccnt = 65535});
  trigger_and_run(5);
  EXPECT_EQ(last().acnt, 65535u);
  EXPECT_EQ(last().bcnt, 65535u);
  EXPECT_EQ(last().bytes(), 65535u * 65535u);
  EXPECT_EQ(words(5)[7], 65534u);
}

TEST_F(DmaTransfers, OtherFieldsStayAsTheyAre) {
  Set set{.opt = tcc(9) | kItcinten,
          .acnt = 8,
          .bcnt = 3,
          .ccnt = 2,
          .source_b = 8,
          .link = 0x4040,
          .reload = 5};
  fill(5, set);
  write(kPaRam + 32 * 5 + 28, 0xABCD'0002);  // the upper half of CCNT's word is reserved
  trigger_and_run(5);
  const auto before = set.words(), after = words(5);
  for (unsigned w : {0, 4, 5, 6}) EXPECT_EQ(after[w], before[w]) << w;
  EXPECT_EQ(after[7], 0xABCD'0002u);
}

TEST_F(DmaTransfers, OptReachesTheRequest) {
  fill(5, {.opt = kSam | fwid(3) | tcc(63) | kTcinten});
  trigger_and_run(5);
  EXPECT_TRUE(last().source.constant);
  EXPECT_FALSE(last().destination.constant);
  EXPECT_EQ(last().fifo_bytes, 8u);
  EXPECT_EQ(last().tcc, 63u);
  EXPECT_TRUE(last().interrupt);
  EXPECT_FALSE(last().chain);
  for (const auto& [field, bytes] : {std::pair{0u, 1u}, {1u, 2u}, {2u, 4u}, {4u, 16u}, {5u, 32u}}) {
    fill(5, {.opt = kDam | fwid(field)});
    trigger_and_run(5);
    EXPECT_EQ(last().fifo_bytes, bytes);
    EXPECT_TRUE(last().destination.constant);
  }
}

TEST_F(DmaTransfers, StaticSetsAreNeitherUpdatedNorLinked) {
  const Set set{.opt = kStatic, .acnt = 4, .bcnt = 2, .ccnt = 1, .source_b = 4, .link = 0x4040};
  fill(5, set);
  for (int i = 0; i < 3; ++i) trigger_and_run(5);
  EXPECT_EQ(words(5), set.words());
  EXPECT_EQ(submitted.size(), 3u);
  const Set final{.opt = kStatic | kTcinten, .link = 0x4040};
  fill(5, final);
  trigger_and_run(5);
  EXPECT_EQ(words(5), final.words());
  EXPECT_TRUE(last().interrupt);
}

struct Link : ChannelBench {
  const Set other{.opt = tcc(17),
                  .source = 0x7000,
                  .destination = 0x8000,
                  .acnt = 3,
                  .bcnt = 4,
                  .ccnt = 5,
                  .source_b = 6,
                  .destination_b = 7,
                  .source_c = 8,
                  .destination_c = 9,
                  .link = 0x1234,
                  .reload = 11};
  std::array<std::uint32_t, 8> after_link(unsigned link) {
    fill(5, {.link = link});
    trigger_and_run(5);
    EXPECT_EQ(core.counts().requests, submitted.size());
    return words(5);
  }
};

TEST_F(Link, BothFormsOfTheAddressNameTheSameSet) {
  fill(100, other);
  EXPECT_EQ(after_link(0x4000 + 32 * 100), other.words());
  EXPECT_EQ(after_link(32 * 100), other.words());
  EXPECT_EQ(words(100), other.words());
  EXPECT_EQ(core.counts().links, 2u);
}

TEST_F(Link, UpperTwoAndLowerFiveBitsDoNotCount) {
  fill(100, other);
  for (unsigned link : {0x8000u + 3200, 0xC000u + 3200, 0x4000u + 3200 + 31, 3200u + 1})
    EXPECT_EQ(after_link(link), other.words()) << link;
}

TEST_F(Link, FirstAndLastSetAreAllowed) {
  fill(0, other);
  EXPECT_EQ(after_link(0), other.words());
  fill(255, other);
  EXPECT_EQ(after_link(255 * 32), other.words());
  EXPECT_TRUE(warnings.empty());
}

TEST_F(Link, BeyondTheLastSetIsReportedAndEndsTheTransfer) {
  for (unsigned link : {256u * 32, 0xFFE0u, 0xFFFEu}) {
    warnings.clear();
    EXPECT_EQ(after_link(link), kNullLinked);
    ASSERT_EQ(warnings.size(), 1u) << link;
    EXPECT_NE(warnings[0].find("PARAM5 links to set"), std::string::npos) << warnings[0];
  }
}

TEST_F(Link, ToItselfRepeatsTheLastArray) {
  fill(5, {.acnt = 4, .bcnt = 2, .source_b = 16, .destination_b = 8, .link = 0x4000 + 32 * 5});
  trigger_and_run(5);
  for (int i = 0; i < 3; ++i) {
    trigger_and_run(5);
    EXPECT_EQ(last().source.address, 0x1010u);
    EXPECT_EQ(last().destination.address, 0x2008u);
  }
  EXPECT_EQ(words(5)[2], 0x0001'0004u);
}

TEST_F(Link, OnlyExhaustedSetsAreReplaced) {
  fill(100, other);
  fill(5, {.bcnt = 2, .link = 32 * 100});
  trigger_and_run(5);
  EXPECT_NE(words(5), other.words());
  trigger_and_run(5);
  EXPECT_EQ(words(5), other.words());
}

TEST_F(Link, ByCountsOfASynchronisation) {
  fill(100, other);
  fill(5, {.opt = kAbSync, .bcnt = 9, .ccnt = 1, .link = 32 * 100});  // CCNT alone counts
  trigger_and_run(5);
  EXPECT_EQ(words(5), other.words());
}

/// SPRUH82C, "Dummy Versus Null Transfer Comparison".
struct Empty : ChannelBench {
  const std::uint32_t channel = 1u << 5;
};

TEST_F(Empty, NullSetIsAnErrorThatBlocksTheChannel) {
  fill(5, {.opt = tcc(9) | kTcinten, .acnt = 0, .bcnt = 0, .ccnt = 0, .link = 3200});
  const Set other{.opt = tcc(17), .source = 0x9000};
  fill(100, other);
  trigger_and_run(5);
  EXPECT_TRUE(submitted.empty());
  EXPECT_EQ(read(kEmr), channel);
  EXPECT_EQ(get(kSer), channel);  // remains set
  EXPECT_EQ(error_pulses, 1);
  EXPECT_EQ(words(5), other.words());  // linked
  EXPECT_EQ(get(kIpr), 1u << 9);       // reported as in early completion
  EXPECT_EQ(read(kEmr), channel);
  trigger_and_run(5);  // ignored until SER is cleared
  EXPECT_TRUE(submitted.empty());
  EXPECT_EQ(get(kEsr), channel);
  write(kEmcr, channel);
  run();
  EXPECT_TRUE(submitted.empty());
  put(kSecr, channel);
  run();
  ASSERT_EQ(submitted.size(), 1u);
  EXPECT_EQ(last().source.address, 0x9000u);
}

TEST_F(Empty, NullSetThatIsStaticStays) {
  const Set null{.opt = kStatic, .acnt = 0, .bcnt = 0, .ccnt = 0, .link = 3200};
  fill(5, null);
  trigger_and_run(5);
  EXPECT_EQ(words(5), null.words());
  EXPECT_EQ(read(kEmr), channel);
}

TEST_F(Empty, DummySetsAreLegalTransfersOfNothing) {
  for (unsigned zeros = 1; zeros < 7; ++zeros) {  // one or two of the three counts are 0
    fill(5, {.opt = tcc(9) | kTcinten,
             .acnt = zeros & 1 ? 0u : 2u,
             .bcnt = zeros & 2 ? 0u : 2u,
             .ccnt = zeros & 4 ? 0u : 2u,
             .link = 3200});
    const Set other{.source = 0x9000 + zeros};
    fill(100, other);
    trigger_and_run(5);
    EXPECT_TRUE(submitted.empty()) << zeros;
    EXPECT_EQ(read(kEmr), 0u) << zeros;
    EXPECT_EQ(get(kSer), 0u) << zeros;
    EXPECT_EQ(words(5), other.words()) << zeros;
    EXPECT_EQ(get(kIpr), 1u << 9) << zeros;
    put(kIcr, 1u << 9);
  }
  EXPECT_EQ(error_pulses, 0);
}

TEST_F(Empty, DummySetChains) {
  fill(5, {.opt = tcc(6) | kTcchen, .bcnt = 0});
  fill(6, {.source = 0x9000});
  trigger_and_run(5);
  ASSERT_EQ(submitted.size(), 1u);
  EXPECT_EQ(last().source.address, 0x9000u);
}

/// SPRUH82C, OPT: FWID is 0 to 5, 8 to 256 bits, and acts with constant addressing only.
TEST_F(DmaTransfers, AReservedWidthIsReportedWhereItActs) {
  for (unsigned width = 0; width < 8; ++width)
    for (const std::uint32_t constant : {0u, std::uint32_t{kSam}, std::uint32_t{kDam}, kSam | kDam}) {
      warnings.clear();
      submitted.clear();
      fill(5, {.opt = fwid(width) | constant, .acnt = 64});
      trigger_and_run(5);
      ASSERT_EQ(submitted.size(), 1u);
      EXPECT_EQ(last().fifo_bytes, width < 5 ? 1u << width : 32u);
      if (width < 6 || !constant) {
        EXPECT_TRUE(warnings.empty()) << width;
        continue;
      }
      ASSERT_EQ(warnings.size(), 1u) << width << ' ' << constant;
      EXPECT_EQ(warnings[0], "PARAM5 has OPT.FWID " + std::to_string(width) +
                                 ", which is reserved and taken as 256 bits; allowed: 0 to 5");
    }
}

}  // namespace
}  // namespace fovea::dma
