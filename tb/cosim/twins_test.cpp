// RTL and model of the remap engine beside each other, each on a memory of its own: random words in random byte lanes
// to every register in every state. Reads, interrupt line, ends of jobs and memory are compared.
#include <gtest/gtest.h>

#include <cstdlib>
#include <string>

#include "model/engine/rtl/rtl_backend.h"
#include "tb/engine/model_bench.h"
#include "tb/rounds.h"
#include "tb/rtl/random_jobs.h"

namespace fovea::rtl::twins {
namespace {

using engine::EngineBackend;
using engine::ModelBench;

constexpr std::uint32_t kWord = ModelBench::kBase / 4;
constexpr std::uint32_t kMap = 0x4000, kTarget = 0x8000, kSize = 0xC000, kBorder = 0x10801080;
constexpr unsigned kSettle = 4;  // clocks in which an access has happened in both, and its interrupt is to be seen

/// What the engine is doing when the registers are written.
enum class State { kReset, kEnabled, kQueued, kFull, kBusy, kBusyAndQueued, kAborting, kFailed, kRefused, kAfter };
constexpr const char* kNames[] = {"after reset", "enabled",        "jobs wait",       "the queue is full",
                                  "busy",        "busy, jobs wait", "aborting",        "after an error",
                                  "after a refusal", "after a job"};

struct Twins {
  ModelBench rtl{kSize, [](const Clock& c, EngineBackend::Host& h) { return std::make_unique<RtlBackend>(h, c); }};
  ModelBench model{kSize};
  Dice dice;
  unsigned compared = 0;
  /// Accesses since the last job with counters that can be compared began: a read lets the RTL go an edge ahead.
  unsigned reads = 0;
  /// A job has ended early: the model may have asked for some bursts more (model/engine/README.md, Limits), so its
  /// counters, and what it wrote, need not be those of the RTL.
  bool early = false;
  /// ENDED and the counters are, or may be, those of such a job.
  bool stale = false;
  /// And until both are quiet they do not do so in the same clock.
  bool apart = false;

  explicit Twins(std::uint32_t seed) : dice(seed) {
    for (std::uint32_t n = 0; n < kSize / 4; ++n) rtl.word(kWord + n) = model.word(kWord + n) = dice.word();
    constexpr std::uint32_t kFirst = kWord + kMap / 4;
    for (std::uint32_t n = kFirst; n < kFirst + 800; ++n) rtl.word(n) = model.word(n) = 4 * dice.to(799);
    rtl.memory.latency = model.memory.latency = 60;
  }
  template <class F>
  void both(F f) {
    f(rtl);
    f(model);
  }
  void set(const Reg& reg, std::uint32_t word, unsigned strobes = 15) {
    both([&](ModelBench& b) { b.set(reg, word, strobes); });
    both([](ModelBench& b) { b.advance(kSettle); });
  }
  void wait() {
    both([](ModelBench& b) {
      for (unsigned n = 0; b.backend.busy() && n < 30; ++n) b.advance(1000);
      b.advance(100);
    });
  }
  void finish() {
    const std::uint32_t ended = jobs_ended();
    wait();
    // A job with fewer words of the map than it reads waits until it is aborted (rtl/README.md, Limits).
    if (model.backend.busy() && early) {
      set(rtl.regs.ctrl, 2);
      wait();
    }
    both([](ModelBench& b) { EXPECT_FALSE(b.backend.busy()) << "it stands still"; });
    apart = false;
    if (early || jobs_ended() != ended) stale = early;
  }
  /// A job of 800 pairs, which takes about 1,700 clocks; all accesses of a round take about 500.
  void window(bool possible = true, std::uint32_t map = kMap) {
    Job job;
    job.pairs = job.dst_pitch = job.src_pitch = 40;
    job.rows = job.src_height = 20;
    job.src_width = possible ? 80 : 0;
    job.src_base = kWord;
    job.dst_base = kWord + kTarget / 4;
    both([&](ModelBench& b) {
      b.advance(50);
      b.window(job, ModelBench::kBase + map, 800, kBorder);
      b.advance(50);
    });
  }
  /// Brings both into the state, from any other one.
  void enter(State state) {
    both([](ModelBench& b) { b.set(b.regs.ctrl, 3); });
    finish();
    set(rtl.regs.ctrl, 2);
    set(rtl.regs.events, ~0u);
    for (std::uint32_t n = 0; n < kSize / 4; ++n) model.word(kWord + n) = rtl.word(kWord + n);
    both([](ModelBench& b) { b.asked.clear(); });
    early = false;
    stale = state != State::kReset;
    reads = 0;
    if (state == State::kReset) {
      both([](ModelBench& b) { b.backend.reset(); });
      both([](ModelBench& b) { b.advance(kSettle); });
    }
    const unsigned jobs = state == State::kFull             ? 5
                          : state == State::kQueued         ? 1 + dice.to(2)
                          : state == State::kBusyAndQueued  ? 3
                          : state == State::kReset || state == State::kEnabled ? 0
                                                            : 1;
    window(state != State::kRefused, state == State::kFailed ? 0x10'0000 : kMap);
    for (unsigned n = 0; n < jobs; ++n) set(rtl.regs.submit, dice.word());
    if (state != State::kReset && state != State::kQueued && state != State::kFull) set(rtl.regs.ctrl, 1);
    if (state >= State::kBusy) both([](ModelBench& b) { b.advance(150); });
    if (state == State::kAborting) abort();
    if (state >= State::kFailed) finish();
    if (state == State::kFailed) early = stale = true;
  }
  void abort() {
    set(rtl.regs.ctrl, 3);
    early = apart = true;
  }
  std::uint32_t jobs_ended() { return model.get(model.regs.ended) >> 16; }
  bool busy() { return model.get(model.regs.status) & 1; }
  /// What a write of the lowest byte of SUBMIT or CTRL begins. Jobs of random windows end early, if at all.
  void note_command(const Reg& reg, std::uint32_t word, bool random_jobs) {
    const bool was_busy = busy(), waiting = model.get(model.regs.status) >> 4 & 15;
    if (&reg == &rtl.regs.submit) {
      early = true;
      apart = apart || (!was_busy && model.get(model.regs.ctrl) & 1);
    } else if (&reg == &rtl.regs.ctrl) {
      const bool begins = word & 1 && waiting && !was_busy && random_jobs;
      if (begins || (word & 2 && was_busy)) early = apart = true;
    }
  }

  bool counter(const Reg& reg) const {
    return &reg == &rtl.regs.clocks || &reg == &rtl.regs.lines || &reg == &rtl.regs.writes || &reg == &rtl.regs.bad;
  }
  bool lasting(const Reg& reg) const {
    return reg.offset() >= rtl.regs.mode.offset() || &reg == &rtl.regs.id || &reg == &rtl.regs.ctrl ||
           &reg == &rtl.regs.enables || &reg == &rtl.regs.submit;
  }
  void compare(const Reg& reg) {
    const std::uint32_t a = rtl.get(reg), b = model.get(reg);
    ++reads;
    both([](ModelBench& bench) { bench.advance(kSettle); });
    if (apart && !lasting(reg)) return;
    if (stale && counter(reg)) return;
    ++compared;
    if ((early && &reg == &rtl.regs.events) || ((early || stale) && &reg == &rtl.regs.ended)) {
      // Of the bursts more some may have failed, and an abort may come before an error in one and behind it in the
      // other: then only that the job failed is the same.
      const std::uint32_t failed = (engine::kReadError | engine::kWriteError | engine::kAborted)
                                   << (&reg == &rtl.regs.ended ? 8 : 0);
      ASSERT_EQ(a & ~failed, b & ~failed) << reg.name();
      ASSERT_EQ((a & failed) != 0, (b & failed) != 0) << reg.name();
      return;
    }
    if (&reg == &rtl.regs.clocks) {
      ASSERT_LE(std::abs(static_cast<std::int64_t>(a) - static_cast<std::int64_t>(b)), reads);
      return;
    }
    ASSERT_EQ(a, b) << reg.name();
  }
  void compare_all() {
    for (const Reg* reg : rtl.regs.regs())
      if (!testing::Test::HasFatalFailure()) compare(*reg);
    if (apart || rtl.get(rtl.regs.events) != model.get(model.regs.events)) return;
    ASSERT_EQ(!rtl.interrupts.empty() && rtl.interrupts.back(), !model.interrupts.empty() && model.interrupts.back());
  }
  void compare_memory() {
    if (early) return;
    for (std::uint32_t n = 0; n < kSize / 4; ++n) ASSERT_EQ(rtl.word(kWord + n), model.word(kWord + n)) << 4 * n;
  }
  std::uint32_t some_word() {
    switch (dice.to(4)) {
      case 0: return ~0u;
      case 1: return 1u << dice.to(31);
      case 2: return 0;
      default: return dice.word();
    }
  }
  /// Writes every register once, in any order. @param commands SUBMIT and ABORT too
  void write_every_register(bool commands) {
    std::vector<const Reg*> order(rtl.regs.regs().begin(), rtl.regs.regs().end());
    for (unsigned n = static_cast<unsigned>(order.size()); n > 1; --n) std::swap(order[n - 1], order[dice.to(n - 1)]);
    for (const Reg* reg : order) {
      std::uint32_t word = some_word();
      const unsigned strobes = 1 + dice.to(14);
      if (commands && reg == &rtl.regs.size) word &= 0xF'003F;  // a job of any window is short
      const bool lowest = strobes & 1;
      if (!commands && reg == &rtl.regs.ctrl) word &= ~2u;
      if (!commands && lowest && reg == &rtl.regs.submit) continue;
      if (lowest) note_command(*reg, word, commands);
      set(*reg, word, strobes);
      for (const Reg* look : {reg, order[dice.to(static_cast<unsigned>(order.size()) - 1)]}) {
        compare(*look);
        if (testing::Test::HasFatalFailure()) {
          ADD_FAILURE() << "after " << std::hex << word << " in bytes " << strobes << " of " << reg->name();
          return;
        }
      }
    }
  }
};

void every_state(unsigned rounds) {
  Twins t(seed());
  for (unsigned n = 0; n < rounds; ++n)
    for (unsigned s = 0; s < std::size(kNames); ++s)
      for (const bool commands : {false, true}) {
        SCOPED_TRACE(std::string(kNames[s]) + (commands ? ", with commands" : "") + ", round " + std::to_string(n));
        t.enter(static_cast<State>(s));
        const bool busy = s == static_cast<unsigned>(State::kBusy) || s == static_cast<unsigned>(State::kBusyAndQueued);
        ASSERT_TRUE(t.apart || t.busy() == busy);
        t.compare_all();
        t.write_every_register(commands);
        ASSERT_TRUE(!busy || commands || t.busy()) << "the job ended before all was written";
        t.compare_all();
        t.finish();
        t.compare_all();
        t.compare_memory();
        if (testing::Test::HasFailure()) return;
      }
  std::printf("%u reads compared\n", t.compared);
  EXPECT_GT(t.compared, rounds * 2000);  // of about 3,000
}

// At night with the number of rounds in the environment.
TEST(TwinsTest, EveryRegisterInEveryStateReadsTheSame) {
  const char* const more = std::getenv("FOVEA_TWIN_ROUNDS");
  every_state(more ? static_cast<unsigned>(std::stoul(more)) : rounds(8));
}
// Of the longest map, whose beats are one more than 23 bits hold, the words that are needed are read in both.
TEST(TwinsTest, TheLongestMapIsReadAsFarAsItIsNeeded) {
  for (const std::uint32_t words : {800u, 0xFF'FFFEu, 0xFF'FFFFu}) {
    Twins t(1);
    t.window();
    t.set(t.rtl.regs.map_words, words);
    t.set(t.rtl.regs.ctrl, 1);
    t.set(t.rtl.regs.submit, 0x56);
    t.wait();
    t.compare_all();
    EXPECT_EQ(t.rtl.get(t.rtl.regs.ended), 0x0001'0156u) << words;
  }
}

}  // namespace
}  // namespace fovea::rtl::twins
