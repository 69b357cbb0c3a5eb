// How a channel is triggered, queued, missed and given to a transfer controller: SPRUH82C, sections
// 17.2.4 (initiating a transfer), 17.2.10 (event queues) and 17.2.13 (prioritisation).
#include "tb/dma/channel_bench.h"

namespace fovea::dma {
namespace {

struct Trigger : ChannelBench {
  void SetUp() override {
    for (unsigned c = 0; c < 64; ++c) fill(c, {.opt = kStatic, .source = 0x10'0000 + c, .bcnt = 1});
  }
  /// Source addresses tell the channels.
  std::vector<unsigned> served() const {
    std::vector<unsigned> out;
    for (const Submitted& s : submitted) out.push_back(s.request.source.address - 0x10'0000);
    return out;
  }
  /// Leaves a chained event of channel 5 while queue 0 is not served: channel 8, in queue 1,
  /// completes early.
  void chain_to_5() {
    fill(8, {.opt = tcc(5) | kTcchen | kTccmode});
    write(kDmaqnum0 + 4, 1);
    ready[0] = false;
    trigger(8);
    queue_all();
    ASSERT_TRUE(core.process(0));
  }
};
using Order = std::vector<unsigned>;

TEST_F(Trigger, EventsAreLatchedAndWaitForTheirEnable) {
  core.event(40);
  EXPECT_EQ(get(kEr + 4), 1u << 8);
  run();
  EXPECT_TRUE(submitted.empty());
  const int before = wakes;
  put(kEesr + 4, 1u << 8);
  EXPECT_GT(wakes, before);
  run();
  EXPECT_EQ(served(), Order{40});
  EXPECT_EQ(get(kEr + 4), 0u);
  EXPECT_EQ(read(kEmrh), 0u);
}

TEST_F(Trigger, ADisabledEventCanBeCleared) {
  core.event(3);
  put(kEcr, 1u << 3);
  put(kEesr, 1u << 3);
  run();
  EXPECT_TRUE(submitted.empty());
}

TEST_F(Trigger, ManualAndChainedTriggersNeedNoEnable) {
  trigger(7);
  EXPECT_EQ(get(kEsr), 1u << 7);
  run();
  EXPECT_EQ(served(), Order{7});
  EXPECT_EQ(get(kEsr), 0u);
  fill(7, {.opt = tcc(33) | kTcchen, .source = 0x10'0007});
  trigger_and_run(7);
  core.completed(last());
  EXPECT_EQ(get(kCer + 4), 2u);
  run();
  EXPECT_EQ(served(), (Order{7, 7, 33}));
  EXPECT_EQ(get(kCer + 4), 0u);
}

TEST_F(Trigger, AnEventInTheQueueIsInSerAndOneMoreIsKept) {
  put(kEesr, 1u << 3);
  core.event(3);
  queue_all();
  EXPECT_EQ(get(kSer), 1u << 3);
  EXPECT_EQ(get(kEr), 0u);
  core.event(3);  // latched, and not queued while the first one is
  queue_all();
  EXPECT_EQ(get(kEr), 1u << 3);
  EXPECT_EQ(read(kQstat0) >> 8 & 31, 1u);
  EXPECT_EQ(read(kEmr), 0u);
  core.event(3);
  EXPECT_EQ(read(kEmr), 1u << 3);
  run();
  EXPECT_EQ(served(), (Order{3, 3}));
}

TEST_F(Trigger, EachKindOfTriggerMissesAlone) {
  put(kEesr, 1u << 5);
  core.event(5);
  trigger(5);
  EXPECT_EQ(read(kEmr), 0u);
  core.event(5);
  EXPECT_EQ(read(kEmr), 1u << 5);
  write(kEmcr, 1u << 5);
  trigger(5);
  EXPECT_EQ(read(kEmr), 1u << 5);
  write(kEmcr, 1u << 5);
  EXPECT_EQ(error_pulses, 2);
  for (bool missed : {false, true}) {
    chain_to_5();
    EXPECT_EQ(get(kCer), 1u << 5);
    EXPECT_EQ(read(kEmr), missed ? 1u << 5 : 0u);
  }
}

TEST_F(Trigger, AMissedEventDoesNotStopTheChannel) {
  trigger(5);
  trigger(5);
  EXPECT_EQ(read(kEmr), 1u << 5);
  run();
  EXPECT_EQ(served(), Order{5});
  trigger_and_run(5);
  EXPECT_EQ(served(), (Order{5, 5}));
  EXPECT_EQ(core.counts().missed, 1u);
}

TEST_F(Trigger, OfOneChannelEventThenChainThenManual) {
  put(kEesr, 1u << 5);
  chain_to_5();
  submitted.clear();
  trigger(5);
  core.event(5);
  ready[0] = true;
  Order kinds;
  const unsigned start = read(kQstat0) & 15;
  for (unsigned i = 0; i < 3; ++i) {
    ASSERT_TRUE(core.prioritise(0));
    EXPECT_FALSE(core.prioritise(0));  // SER holds the others back
    const std::uint32_t entry = read(kQ0e0 + 4 * ((start + i) % 16));
    EXPECT_EQ(entry & 63, 5u);
    kinds.push_back(entry >> 6);
    ASSERT_TRUE(core.process(0));
  }
  EXPECT_EQ(kinds, (Order{0, 2, 1}));  // ETYPE: event, chained, manual
  EXPECT_EQ(submitted.size(), 3u);
}

TEST_F(Trigger, LowChannelsFirstAndDmaBeforeQdma) {
  fill(200, {.opt = kStatic, .source = 0x10'0000 + 200});
  fill(201, {.opt = kStatic, .source = 0x10'0000 + 201});
  map_qdma(6, 200, 7);
  map_qdma(2, 201, 7);
  write(kPaRam + 32 * 200 + 28, 1);
  write(kPaRam + 32 * 201 + 28, 1);
  for (unsigned c : {63u, 0u, 31u, 32u}) trigger(c);
  run();
  EXPECT_EQ(served(), (Order{0, 31, 32, 63, 201, 200}));
}

struct Queues : Trigger {
  void SetUp() override {
    Trigger::SetUp();
    write(kDmaqnum0 + 4 * 4, 0x3210'3210);  // channels 32 to 39: queues 0 1 2 3 0 1 2 3
  }
  std::uint32_t count(unsigned q) { return read(kQstat0 + 4 * q) >> 8 & 31; }
};

TEST_F(Queues, DmaqnumSelectsTheQueueAndQuetcmapItsController) {
  for (unsigned c = 32; c < 36; ++c) trigger(c);
  queue_all();
  for (unsigned q = 0; q < 4; ++q) EXPECT_EQ(count(q), 1u);
  write(kQuetcmap, 0x0123);
  run();
  ASSERT_EQ(submitted.size(), 4u);
  for (unsigned q = 0; q < 4; ++q) {
    EXPECT_EQ(submitted[q].request.source.address, 0x10'0000 + 32 + q);  // low queues first
    EXPECT_EQ(submitted[q].controller, 3 - q);
  }
}

TEST_F(Queues, QdmaqnumSelectsTheQueue) {
  fill(200, {.opt = kStatic});
  map_qdma(5, 200, 7);
  write(kQdmaqnum, 2u << 20);
  write(kPaRam + 32 * 200 + 28, 1);
  queue_all();
  EXPECT_EQ(count(2), 1u);
  EXPECT_EQ(read(0x400 + 0x80), 3u << 6 | 5);
  EXPECT_EQ(get(kQser), 1u << 5);
}

TEST_F(Queues, ABusyControllerBlocksItsQueueOnly) {
  ready[0] = false;
  trigger(32);
  trigger(36);
  trigger(35);
  run();
  EXPECT_EQ(served(), Order{35});
  EXPECT_EQ(count(0), 2u);
  ready[0] = true;
  run();
  EXPECT_EQ(served(), (Order{35, 32, 36}));  // in the order of their arrival
}

TEST_F(Queues, TwoQueuesMayShareAController) {
  write(kQuetcmap, 0x2222);
  for (unsigned c = 39; c >= 32; --c) trigger(c);
  queue_all();
  run();
  EXPECT_EQ(served(), (Order{32, 36, 33, 37, 34, 38, 35, 39}));
  for (const Submitted& s : submitted) EXPECT_EQ(s.controller, 2u);
}

TEST_F(Queues, SixteenEntriesAndTheSeventeenthWaitsInItsRegister) {
  ready.fill(false);
  for (unsigned c = 0; c < 17; ++c) trigger(c);
  queue_all();
  EXPECT_EQ(count(0), 16u);
  EXPECT_EQ(get(kEsr), 1u << 16);
  EXPECT_EQ(get(kSer), 0xFFFFu);
  EXPECT_EQ(read(kEmr), 0u);
  trigger(35);  // another queue has room
  queue_all();
  EXPECT_EQ(count(3), 1u);
  for (unsigned e = 0; e < 16; ++e) EXPECT_EQ(read(kQ0e0 + 4 * e), 1u << 6 | e);
  ready[0] = true;
  ASSERT_TRUE(core.process(0));
  ready[0] = false;
  EXPECT_EQ(read(kQstat0) & 15, 1u);
  queue_all();
  EXPECT_EQ(count(0), 16u);
  EXPECT_EQ(read(kQ0e0), 1u << 6 | 16);  // where the first one was
  EXPECT_EQ(get(kEsr), 0u);
}

TEST_F(Queues, AQueueEntryIsServedNoEarlierThanItsTurn) {
  EXPECT_EQ(core.next_turn(), kNever);
  trigger(32);
  trigger(33);
  ASSERT_TRUE(core.prioritise(2000));
  ASSERT_TRUE(core.prioritise(1000));
  EXPECT_EQ(core.next_turn(), 1000u);
  EXPECT_EQ(core.next_turn_after(999), 1000u);
  EXPECT_EQ(core.next_turn_after(1000), 2000u);
  EXPECT_EQ(core.next_turn_after(2000), kNever);
  EXPECT_FALSE(core.process(999));
  EXPECT_TRUE(core.process(1000));
  EXPECT_FALSE(core.process(1999));
  EXPECT_TRUE(core.process(2000));
  EXPECT_EQ(served(), (Order{33, 32}));
}

TEST_F(Queues, WatermarkAndThreshold) {
  write(kQwmthra, 0x1010'1002);
  ready.fill(false);
  trigger(0);
  trigger(1);
  queue_all();
  EXPECT_EQ(read(kCcerr), 0u);
  EXPECT_EQ(read(kQstat0), 2u << 16 | 2u << 8);
  trigger(2);
  queue_all();
  EXPECT_EQ(read(kCcerr), 1u);
  EXPECT_EQ(read(kQstat0), 1u << 24 | 3u << 16 | 3u << 8);
  EXPECT_EQ(error_pulses, 1);
  ready.fill(true);
  run();
  EXPECT_EQ(read(kQstat0), 1u << 24 | 3u << 16 | 3u);  // empty; mark and flag stay
  EXPECT_EQ(read(kCcerr), 1u);
  write(kCcerrclr, 1u << 1);
  EXPECT_EQ(read(kCcerr), 1u);
  write(kCcerrclr, 1u);
  EXPECT_EQ(read(kCcerr), 0u);
  EXPECT_EQ(read(kQstat0), 3u);
  trigger_and_run(0);
  EXPECT_EQ(read(kQstat0), 1u << 16 | 4u);
}

TEST_F(Queues, FullQueuesExceedAThresholdOfFifteenButNeitherSixteenNorSeventeen) {
  for (unsigned threshold : {15u, 16u, 17u}) {
    write(kQwmthra, threshold);
    ready.fill(false);
    for (unsigned c = 0; c < 16; ++c) trigger(c);
    queue_all();
    EXPECT_EQ(read(kQstat0) >> 16 & 31, 16u);
    EXPECT_EQ(read(kCcerr), threshold == 15 ? 1u : 0u) << threshold;
    ready.fill(true);
    run();
    write(kCcerrclr, 1);
  }
}

TEST_F(Queues, AThresholdIsThatOfItsQueue) {
  write(kQwmthra, 0x0010'1010);
  trigger(35);
  queue_all();
  EXPECT_EQ(read(kCcerr), 1u << 3);
  EXPECT_EQ(read(kQstat0 + 12) >> 24, 1u);
  EXPECT_EQ(read(kQstat0) >> 24, 0u);
}

TEST_F(Queues, EventsThatARegionEnablesAreReported) {
  put(kEesr, 1u << 7);
  put(kEesr + 4, 1u << 2);
  EXPECT_EQ(enabled, 1ull << 7 | 1ull << 34);
  enabled = 0;
  write(kDrae0, 1u << 5);
  write(kShadow0 + kEesr, 3u << 5);
  EXPECT_EQ(enabled, 1ull << 5) << "DRAE hides the other one";
  enabled = 0;
  put(kEecr, 1u << 7);
  put(kEsr, 1u << 8);
  put(kIesr, 1u << 9);
  EXPECT_EQ(enabled, 0u);
}

TEST_F(Queues, AQueueThatDoesNotExistIsReportedAndItsLowBitsCount) {
  write(kDmaqnum0, 5);
  trigger_and_run(0);
  ASSERT_FALSE(warnings.empty());
  EXPECT_NE(warnings[0].find("queue 5; allowed: 0 to 3"), std::string::npos) << warnings[0];
  EXPECT_EQ(read(kQstat0 + 4) >> 16 & 31, 1u);
}

TEST_F(Queues, AControllerThatDoesNotExistIsReportedAndOtherQueuesGoOn) {
  write(kQuetcmap, 0x3214);
  trigger(32);
  trigger(33);
  run();
  EXPECT_EQ(served(), Order{33});
  ASSERT_FALSE(warnings.empty());
  EXPECT_NE(warnings[0].find("controller 4; allowed: 0 to 3"), std::string::npos) << warnings[0];
  write(kQuetcmap, 0x3210);
  run();
  EXPECT_EQ(served(), (Order{33, 32}));
}

struct Qdma : ChannelBench {
  void word(unsigned set, unsigned w, std::uint32_t v) { write(kPaRam + 32 * set + 4 * w, v); }
};

TEST_F(Qdma, OnlyTheSetsThatExistTrigger) {
  fill(255, {.acnt = 8});
  write(kQchmap0 + 4, 255 << 5);
  EXPECT_TRUE(warnings.empty());
  write(kQchmap0 + 8, 256 << 5);
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_NE(warnings[0].find("QCHMAP2 names set 256"), std::string::npos) << warnings[0];
  EXPECT_NE(warnings[0].find("allowed: 0 to 255"), std::string::npos) << warnings[0];
  put(kQeesr, 3u << 1);
  word(255, 0, 0);
  word(0, 0, 0);
  run();
  EXPECT_EQ(submitted.size(), 1u) << "of channel 1";
}

TEST_F(Qdma, TheTriggerWordTriggersAndNoOtherDoes) {
  for (unsigned trigger_word = 0; trigger_word < 8; ++trigger_word) {
    fill(130, {.opt = kStatic});
    map_qdma(1, 130, trigger_word);
    run();  // what the word of the last turn has triggered
    submitted.clear();
    const auto same = words(130);
    for (unsigned w = 0; w < 8; ++w) {
      if (w != trigger_word) word(130, w, same[w]);
      word(131, w, 0);
    }
    run();
    EXPECT_TRUE(submitted.empty()) << trigger_word;
    word(130, trigger_word, same[trigger_word]);
    EXPECT_EQ(get(kQer), 2u);
    run();
    EXPECT_EQ(submitted.size(), 1u) << trigger_word;
    EXPECT_EQ(get(kQer) | get(kQser), 0u);
  }
}

TEST_F(Qdma, DisabledChannelsLatchNothing) {
  map_qdma(1, 130, 7);
  put(kQeecr, 2);
  fill(130, {});
  EXPECT_EQ(get(kQer), 0u);
  put(kQeesr, 2);
  run();
  EXPECT_TRUE(submitted.empty());
}

TEST_F(Qdma, ASecondTriggerIsMissed) {
  map_qdma(1, 130, 7);
  fill(130, {.opt = kStatic});
  word(130, 7, 1);
  EXPECT_EQ(read(kQemr), 2u);
  EXPECT_EQ(error_pulses, 1);
  run();
  EXPECT_EQ(submitted.size(), 1u);
  write(kQemcr, 2);
  EXPECT_EQ(read(kQemr), 0u);
}

TEST_F(Qdma, QsecrClearsBothRegisters) {
  map_qdma(1, 130, 7);
  fill(130, {.opt = kStatic, .acnt = 0, .bcnt = 0, .ccnt = 0});
  run();
  EXPECT_EQ(get(kQser), 2u);
  EXPECT_EQ(read(kQemr), 2u);
  word(130, 7, 0);
  EXPECT_EQ(get(kQer), 2u);
  run();
  put(kQsecr, 2);
  EXPECT_EQ(get(kQer) | get(kQser), 0u);
}

TEST_F(Qdma, ALinkTriggersTheNextTransfer) {
  map_qdma(1, 130, 3);
  fill(140, {.source = 0x2, .link = 0x4000 + 32 * 141});
  fill(141, {.opt = kStatic, .source = 0x3});
  fill(130, {.source = 0x1, .link = 0x4000 + 32 * 140});
  run();
  ASSERT_EQ(submitted.size(), 3u);
  for (unsigned i = 0; i < 3; ++i) EXPECT_EQ(submitted[i].request.source.address, i + 1);
  EXPECT_EQ(read(kQemr), 0u);
}

TEST_F(Qdma, ALinkOfADmaChannelTriggersToo) {
  fill(140, {.opt = kStatic, .source = 0x77});
  fill(9, {.source = 0x66, .link = 32 * 140});
  map_qdma(1, 9, 3);
  trigger_and_run(9);
  ASSERT_EQ(submitted.size(), 2u);
  EXPECT_EQ(submitted[1].request.source.address, 0x77u);
}

TEST_F(Qdma, CountUpdatesDoNotTrigger) {
  map_qdma(1, 130, 2);
  fill(130, {.bcnt = 3});
  run();
  EXPECT_EQ(submitted.size(), 1u);
  EXPECT_EQ(words(130)[2], 0x0002'0001u);
}

TEST_F(Qdma, ANullSetBlocksTheChannelAndItsLinkIsLatched) {
  map_qdma(1, 130, 7);
  fill(140, {.opt = kStatic, .source = 0x88});
  fill(130, {.acnt = 0, .bcnt = 0, .ccnt = 0, .link = 32 * 140});
  run();
  EXPECT_TRUE(submitted.empty());
  EXPECT_EQ(read(kQemr), 2u);
  EXPECT_EQ(get(kQser), 2u);
  EXPECT_EQ(get(kQer), 2u);
}

TEST_F(Qdma, TwoChannelsMayShareASet) {
  map_qdma(1, 130, 3);
  map_qdma(4, 130, 3);
  fill(130, {.opt = kStatic});
  EXPECT_EQ(get(kQer), 0x12u);
  run();
  EXPECT_EQ(submitted.size(), 2u);
}

}  // namespace
}  // namespace fovea::dma
