// Completion codes, completion interrupts, errors and their interrupt: SPRUH82C, sections 17.2.5
// (completion), 17.2.8 (chaining) and 17.2.9 (interrupts).
#include "tb/dma/channel_bench.h"

namespace fovea::dma {
namespace {

struct Codes : ChannelBench {
  struct Reports {
    bool interrupt, chain;
    bool operator==(const Reports&) const = default;
  };
  Reports reports(std::size_t i) const {
    return {submitted.at(i).request.interrupt, submitted.at(i).request.chain};
  }
};

TEST_F(Codes, IntermediateAndFinalRequestsReportByTheirOwnBits) {
  for (const auto& [opt, intermediate, final] :
       {std::tuple<std::uint32_t, Reports, Reports>{kTcinten, {}, {true, false}},
        {kItcinten, {true, false}, {}},
        {kTcchen, {}, {false, true}},
        {kItcchen, {false, true}, {}},
        {kTcinten | kItcchen, {false, true}, {true, false}}}) {
    submitted.clear();
    fill(5, {.opt = opt | tcc(40), .bcnt = 2, .ccnt = 2, .reload = 2});
    for (int i = 0; i < 4; ++i) trigger_and_run(5);
    ASSERT_EQ(submitted.size(), 4u);
    for (int i = 0; i < 3; ++i) EXPECT_EQ(reports(i), intermediate) << opt << " " << i;
    EXPECT_EQ(reports(3), final) << opt;
    fill(5, {.opt = opt | kAbSync, .bcnt = 3, .ccnt = 2});
    for (int i = 0; i < 2; ++i) trigger_and_run(5);
    EXPECT_EQ(reports(4), intermediate) << opt;
    EXPECT_EQ(reports(5), final) << opt;
  }
}

TEST_F(Codes, NormalCompletionSetsItsBitsWhenTheControllerReports) {
  fill(5, {.opt = kTcinten | kTcchen | tcc(63)});
  trigger_and_run(5);
  EXPECT_EQ(get(kIpr + 4) | get(kCer + 4), 0u);
  EXPECT_EQ(read(kCcstat) >> 8 & 63, 1u);
  core.completed(last());
  EXPECT_EQ(get(kIpr + 4), 1u << 31);
  EXPECT_EQ(get(kCer + 4), 1u << 31);
  EXPECT_EQ(read(kCcstat) >> 8 & 63, 0u);
}

TEST_F(Codes, EarlyCompletionSetsThemAtSubmission) {
  fill(5, {.opt = kTcinten | kTcchen | kTccmode | tcc(33)});
  fill(33, {.source = 0x5555});
  trigger_and_run(5);
  ASSERT_EQ(submitted.size(), 2u);
  EXPECT_EQ(reports(0), Reports{});
  EXPECT_EQ(last().source.address, 0x5555u);
  EXPECT_EQ(get(kIpr + 4), 2u);
  EXPECT_EQ(read(kCcstat) >> 8 & 63, 0u);
  core.completed(submitted[0].request);  // the transfer controller reports nothing
  EXPECT_EQ(get(kIpr), 0u);
}

TEST_F(Codes, EarlyCompletionOfAnIntermediateRequest) {
  fill(5, {.opt = kItcinten | kTccmode | tcc(2), .bcnt = 2});
  trigger_and_run(5);
  EXPECT_EQ(get(kIpr), 4u);
  put(kIcr, 4);
  trigger_and_run(5);
  EXPECT_EQ(get(kIpr), 0u);
}

TEST_F(Codes, AChannelMayChainToItself) {
  fill(5, {.opt = kItcchen | kTcinten | kAbSync | tcc(5), .ccnt = 3});
  trigger_and_run(5);
  core.completed(submitted[0].request);
  run();
  core.completed(submitted[1].request);
  run();
  ASSERT_EQ(submitted.size(), 3u);
  core.completed(submitted[2].request);
  run();
  EXPECT_EQ(submitted.size(), 3u);
  EXPECT_EQ(get(kIpr), 1u << 5);
}

/// SPRUH73H, CCSTAT.COMPACTV: at 63 codes outstanding the controller serves no new request.
TEST_F(Codes, SixtyThreeMayBeOutstanding) {
  for (unsigned c = 0; c < 64; ++c) fill(c, {.opt = kTcinten | tcc(c)});
  for (unsigned c = 0; c < 62; ++c) trigger_and_run(c);
  EXPECT_EQ(read(kCcerr), 0u);
  trigger_and_run(62);
  EXPECT_EQ(submitted.size(), 63u);
  EXPECT_EQ(read(kCcstat) >> 8 & 63, 63u);
  EXPECT_EQ(read(kCcerr), 1u << 16);
  EXPECT_EQ(error_pulses, 1);
  trigger_and_run(63);
  EXPECT_EQ(submitted.size(), 63u);
  EXPECT_EQ(read(kQstat0) >> 8 & 31, 1u);
  core.completed(submitted[0].request);
  run();
  EXPECT_EQ(submitted.size(), 64u);
  write(kCcerrclr, 1u << 16);
  EXPECT_EQ(read(kCcerr), 0u);
  core.completed(submitted[1].request);
  EXPECT_EQ(read(kCcstat) >> 8 & 63, 62u);
}

/// A transfer controller that drops a request (TRERR) reports no code.
TEST_F(Codes, ADroppedRequestIsNotOutstanding) {
  fill(5, {.opt = kTcinten | kTcchen | tcc(6)});
  trigger_and_run(5);
  core.dropped(last());
  EXPECT_EQ(read(kCcstat), 0u);
  EXPECT_EQ(get(kIpr) | get(kCer), 0u);
  fill(5, {});
  trigger_and_run(5);
  core.dropped(last());  // reports nothing anyway
  EXPECT_EQ(read(kCcstat), 0u);
}

struct Pulses : ChannelBench {
  void SetUp() override {
    write(kDrae0, 0x0F);
    write(kDrae0 + 8, 0xF8);  // region 1 shares code 3 with region 0
    write(kDrae0 + 4, 1);     // code 32: region 0
    put(kIesr, 0xFF);
  }
  void complete(unsigned code, bool interrupt = true) {
    TransferRequest r;
    r.acnt = r.bcnt = 1;
    r.tcc = static_cast<std::uint8_t>(code);
    r.interrupt = interrupt;
    core.completed(r);
  }
  std::array<int, 4> pulses() { return std::exchange(completion_pulses, {}); }
};
using Four = std::array<int, 4>;

TEST_F(Pulses, ARegionIsPulsedForItsOwnEnabledCodes) {
  complete(0);
  EXPECT_EQ(pulses(), (Four{1, 0, 0, 0}));
  complete(4);
  EXPECT_EQ(pulses(), (Four{0, 1, 0, 0}));
  put(kIcr, 0x11);
  complete(3);
  EXPECT_EQ(pulses(), (Four{1, 1, 0, 0}));
  complete(9);   // no region
  complete(32);  // not enabled
  EXPECT_EQ(pulses(), Four{});
}

TEST_F(Pulses, OnceUntilAllAreCleared) {
  complete(0);
  complete(1);
  EXPECT_EQ(pulses(), (Four{1, 0, 0, 0}));
  put(kIcr, 1);
  complete(2);
  EXPECT_EQ(pulses(), Four{});
  put(kIcr, 6);
  EXPECT_EQ(get(kIpr), 0u);
  complete(1);
  EXPECT_EQ(pulses(), (Four{1, 0, 0, 0}));
}

TEST_F(Pulses, EnablingAPendingInterruptPulses) {
  complete(32);
  EXPECT_EQ(get(kIpr + 4), 1u);
  put(kIesr + 4, 1);
  EXPECT_EQ(pulses(), (Four{1, 0, 0, 0}));
  put(kIecr + 4, 1);
  put(kIesr + 4, 1);
  EXPECT_EQ(pulses(), (Four{1, 0, 0, 0}));
}

TEST_F(Pulses, IevalOfARegionPulsesIfItHasAPendingInterrupt) {
  complete(1);
  pulses();
  write(kShadow0 + kIeval, 1);
  EXPECT_EQ(pulses(), (Four{1, 0, 0, 0}));
  write(kShadow0 + kIeval, 2);
  write(kShadow0 + 0x200 + kIeval, 1);
  EXPECT_EQ(pulses(), Four{});
  put(kIecr, 2);
  write(kShadow0 + kIeval, 1);  // pending, no longer enabled
  EXPECT_EQ(pulses(), Four{});
}

TEST_F(Pulses, IevalOfTheGlobalRegionIsReported) {
  complete(1);
  pulses();
  put(kIeval, 1);
  EXPECT_EQ(pulses(), Four{});
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_NE(warnings[0].find("IEVAL"), std::string::npos);
}

TEST_F(Pulses, AReportedCodeWithoutInterruptSetsNothing) {
  complete(1, false);
  EXPECT_EQ(get(kIpr), 0u);
  EXPECT_EQ(pulses(), Four{});
}

struct Errors : ChannelBench {
  void miss(unsigned channel) {
    trigger(channel);
    trigger(channel);
  }
};

TEST_F(Errors, PulseOnceUntilAllAreCleared) {
  miss(1);
  EXPECT_EQ(error_pulses, 1);
  miss(2);
  miss(34);
  EXPECT_EQ(error_pulses, 1);
  EXPECT_EQ(read(kEmr), 6u);
  EXPECT_EQ(read(kEmrh), 4u);
  write(kEmcr, 6);
  miss(3);
  EXPECT_EQ(error_pulses, 1);
  write(kEmcr, 8);
  write(kEmcrh, 4);
  miss(3);
  EXPECT_EQ(error_pulses, 2);
}

TEST_F(Errors, KindsOfErrorsShareTheInterrupt) {
  map_qdma(0, 130, 7);
  fill(130, {});
  write(kPaRam + 32 * 130 + 28, 1);
  EXPECT_EQ(error_pulses, 1);
  miss(1);
  write(kQwmthra, 0);
  run();
  EXPECT_EQ(read(kCcerr), 1u);
  EXPECT_EQ(error_pulses, 1);
  write(kQemcr, 1);
  write(kEmcr, ~0u);
  miss(2);
  EXPECT_EQ(error_pulses, 1);  // CCERR is still set
  write(kEmcr, ~0u);
  write(kCcerrclr, 1);
  miss(2);
  EXPECT_EQ(error_pulses, 2);
}

TEST_F(Errors, EevalPulsesIfAnyIsPending) {
  write(kEeval, 1);
  EXPECT_EQ(error_pulses, 0);
  miss(34);
  write(kEeval, 1);
  EXPECT_EQ(error_pulses, 2);
  write(kEeval, 0);
  write(kEeval, 2);
  EXPECT_EQ(error_pulses, 2);
  write(kEmcrh, 4);
  write(kEeval, 1);
  EXPECT_EQ(error_pulses, 2);
}

TEST_F(Errors, SeveralEventsMissedByOneWriteCount) {
  put(kEsr, 0xF0);
  put(kEsr, 0x3C);
  EXPECT_EQ(read(kEmr), 0x30u);
  EXPECT_EQ(core.counts().missed, 2u);
  EXPECT_EQ(error_pulses, 1);
}

}  // namespace
}  // namespace fovea::dma
