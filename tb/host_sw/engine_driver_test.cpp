// The driver of the remap engine against a recorder, and its queue of jobs against an engine that ends a job for each
// sleep of the core; the waits for the EDMA too, as both share the core's masks and sleep. Offsets and bits are those
// of the tables in rtl/README.md.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <deque>

#include "register_recorder.h"

extern "C" {
#include "sw/firmware/drivers/engine.h"
#include "sw/firmware/kernels/edma_wait.h"
#include "sw/firmware/kernels/engine_jobs.h"

uint32_t irq_mask(void);
void irq_restore(uint32_t cpsr);
void wait_for_interrupt(void);
}

namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using A = RegisterAccess;

std::function<void()> asleep;
int masked = 0;

}  // namespace

extern "C" {
uint32_t irq_mask(void) { return static_cast<uint32_t>(masked++); }
void irq_restore(uint32_t cpsr) { masked = static_cast<int>(cpsr); }
void wait_for_interrupt(void) {
  EXPECT_EQ(masked, 1) << "an interrupt that comes between the check and the sleep must end it";
  asleep();
}
}

namespace {

constexpr std::uint32_t kEngine = 0x01C6A000;

TEST(EngineTest, AnotherIdentityIsReadAndLeftAlone) {
  RegisterRecorder chip;
  chip.values[kEngine] = 0x52454D30;
  EXPECT_FALSE(engine_init());
  EXPECT_THAT(chip.accesses, ElementsAre(A{'r', kEngine, 0x52454D30}));
}

TEST(EngineTest, StartEndsWhatIsUnderWayAndLeavesNothingPending) {
  RegisterRecorder chip;
  unsigned looks = 0;
  chip.on_read = [&](std::uint32_t address) {
    if (address == kEngine) return 0x52454D31u;
    return address == kEngine + 8 && ++looks < 3 ? 0x101u : 0x100u;
  };
  EXPECT_TRUE(engine_init());
  EXPECT_EQ(looks, 3u);
  EXPECT_THAT(chip.writes(),
              ElementsAre(A{'w', kEngine + 0x10, 0}, A{'w', kEngine + 4, 2}, A{'w', kEngine + 0xC, 0x7F},
                          A{'w', kEngine + 0x10, 0x7F}, A{'w', kEngine + 4, 1}));
  chip.on_read = [](std::uint32_t address) { return address == kEngine ? 0x52454D31u : 1u; };
  EXPECT_FALSE(engine_init()) << "it never stops";
}

TEST(EngineTest, AJobIsTheWholeWindowThenItsTag) {
  RegisterRecorder chip;
  remap_engine_job_t job{};
  job.mode = 0x40;
  job.dst_base = 0x54;
  job.map_base = 0x5C;
  job.centre_y = 0x70;
  job.a[0] = 0x74;
  job.c[2] = 0x94;
  engine_submit(&job, 0x1234);
  const auto writes = chip.writes();
  ASSERT_EQ(writes.size(), 23u);
  for (unsigned n = 0; n < 22; ++n) {
    EXPECT_EQ(writes[n].address, kEngine + 0x40 + 4 * n);
    if (writes[n].value != 0) { EXPECT_EQ(writes[n].value, 0x40 + 4 * n); }
  }
  EXPECT_EQ(std::count_if(writes.begin(), writes.end(), [](const A& a) { return a.value != 0; }), 7);
  EXPECT_EQ(writes.back(), (A{'w', kEngine + 0x14, 0x34}));
}

TEST(EngineTest, EventsThatAreTakenAreClearedAndNoOthers) {
  RegisterRecorder chip;
  EXPECT_EQ(engine_take_events(), 0u);
  EXPECT_THAT(chip.writes(), IsEmpty());
  // A second event comes between the read of the first one and its clearing.
  std::uint32_t events = 1;
  chip.on_read = [&](std::uint32_t address) { return address == kEngine + 0xC ? events : 0; };
  chip.on_write = [&](std::uint32_t, std::uint32_t cleared) { events = (events | (cleared == 1 ? 4 : 0)) & ~cleared; };
  EXPECT_EQ(engine_take_events(), 5u);
  EXPECT_THAT(chip.writes(), ElementsAre(A{'w', kEngine + 0xC, 1}, A{'w', kEngine + 0xC, 4}));
}

/// Registers, a queue of four, and a timer of 24 MHz. Each sleep lasts 100 us; in each a job ends.
struct Engine : testing::Test {
  static constexpr std::uint32_t kTimer = 0x01C21410, kUart = 0x01C20000;
  Engine() {
    chip.on_read = [this](std::uint32_t address) -> std::uint32_t {
      switch (address) {
        case kEngine: return 0x52454D31;
        case kEngine + 0x08: return stuck && waiting.empty() ? 1 : 0;
        case kEngine + 0x0C: return events;
        case kEngine + 0x18: return ended << 16;
        case kTimer: return ticks;
        case kUart + 0x14: return 0x60;
        default: return 0;
      }
    };
    chip.on_write = [this](std::uint32_t address, std::uint32_t value) {
      if (address == kEngine + 0x0C) events &= ~value;
      if (address == kEngine + 0x04 && (value & 2)) waiting.clear();
      if (address == kEngine + 0x04) enabled = value == 1;
      if (address == kEngine + 0x14) submit(value);
      if (address == kUart) text += static_cast<char>(value);
    };
    asleep = [this] {
      ticks += ticks_asleep;
      ++sleeps;
      if (!hangs && enabled && !waiting.empty()) end();
    };
    EXPECT_TRUE(engine_jobs_open());
    (void)engine_jobs_failed();
    chip.accesses.clear();
  }
  void submit(std::uint32_t tag) {
    // One job is under way, four wait.
    if (waiting.size() == 5) {
      events |= 0x20;
      return;
    }
    waiting.push_back(tag);
    most = std::max(most, waiting.size());
  }
  void end() {
    tags.push_back(waiting.front());
    waiting.pop_front();
    ended = (ended + 1) & 0xFFFF;
    events |= tags.size() == bad_job ? bad_events : 1;
  }
  void add(unsigned jobs) {
    const remap_engine_job_t job{};
    for (unsigned n = 0; n < jobs; ++n) engine_jobs_add(&job);
  }
  RegisterRecorder chip;
  std::deque<std::uint32_t> waiting;
  std::vector<std::uint32_t> tags;
  std::string text;
  std::uint32_t events = 0, ended = 65530, ticks = 0xFFFFF000, bad_events = 0;
  std::size_t most = 0, bad_job = 0;
  unsigned sleeps = 0, ticks_asleep = 2400;
  bool hangs = false, stuck = false, enabled = false;
};

// A table is built in the background, and prepares its kernel; a frame may come at each access with open interrupts.
TEST_F(Engine, AFrameThatComesWhileTheEngineIsOpenedAnewFindsItReady) {
  const auto read = chip.on_read;
  const auto write = chip.on_write;
  bool in_frame = false;
  unsigned frames = 0;
  const auto frame = [&] {
    if (masked || in_frame) return;
    in_frame = true;
    ++frames;
    add(2);
    engine_jobs_wait();
    EXPECT_FALSE(engine_jobs_failed());
    in_frame = false;
  };
  chip.on_read = [&](std::uint32_t address) {
    frame();
    return read(address);
  };
  chip.on_write = [&](std::uint32_t address, std::uint32_t value) {
    frame();
    write(address, value);
  };
  EXPECT_TRUE(engine_jobs_open());
  EXPECT_GT(frames, 0u) << "when the interrupt controller is set";
  EXPECT_EQ(tags.size(), 2 * frames);
  EXPECT_EQ(text, "");
  EXPECT_EQ(masked, 0);
}

TEST_F(Engine, JobsWaitInTheQueueAndTheCoreSleeps) {
  add(12);  // the count of jobs that ended passes 65535
  EXPECT_EQ(most, 4u) << "never more than the queue is sure to have room for";
  EXPECT_EQ(sleeps, 8u);
  engine_jobs_wait();
  EXPECT_EQ(sleeps, 12u);
  EXPECT_EQ(tags.size(), 12u);
  for (std::size_t n = 1; n < tags.size(); ++n) EXPECT_EQ(tags[n], (tags[n - 1] + 1) % 256);
  EXPECT_EQ(text, "");
  EXPECT_FALSE(engine_jobs_failed());
  engine_jobs_wait();
  EXPECT_EQ(sleeps, 12u) << "nothing to wait for";
}

TEST_F(Engine, EachFailureIsSaidDropsTheOthersAndTheEngineStartsAnew) {
  for (const unsigned bit : {1u, 2u, 3u, 4u, 5u, 6u}) {
    SCOPED_TRACE(bit);
    text.clear();
    tags.clear();
    bad_job = 2;
    bad_events = 1u << bit;
    add(12);
    engine_jobs_wait();
    EXPECT_EQ(text, std::string("engine: events 0x") + "0123456789abcdef"[(1u << bit | 1) >> 4] +
                        "0123456789abcdef"[(1u << bit | 1) & 15] + "\r\n");
    EXPECT_EQ(tags.size(), 2u);
    EXPECT_TRUE(waiting.empty());
    EXPECT_TRUE(engine_jobs_failed());
    EXPECT_FALSE(engine_jobs_failed()) << "told once";
    bad_job = 0;
    add(3);
    engine_jobs_wait();
    EXPECT_FALSE(engine_jobs_failed());
    EXPECT_EQ(tags.size(), 5u);
  }
}

TEST_F(Engine, JobsMayTakeMoreThanTwoSecondsTogether) {
  ticks_asleep = 36'000'000;  // 1.5 s
  add(6);
  engine_jobs_wait();
  EXPECT_EQ(tags.size(), 6u);
  EXPECT_FALSE(engine_jobs_failed()) << text;
}

TEST_F(Engine, AJobThatNeverEndsIsGivenUpAfterTwoSecondsWithoutOne) {
  add(3);
  hangs = true;
  engine_jobs_wait();
  EXPECT_EQ(sleeps, 20001u) << "of 100 us";
  EXPECT_EQ(text, "engine: no end of a job, events 0x00\r\n");
  EXPECT_TRUE(engine_jobs_failed());
  text.clear();
  add(1);
  stuck = true;
  engine_jobs_wait();
  EXPECT_EQ(text, "engine: no end of a job, events 0x00\r\nengine: does not stop\r\n");
}

/// Interrupts of the EDMA's completion codes, as opened in the ARM's region (SPRUEE4A), and the interrupt controller's.
struct Edma : testing::Test {
  static constexpr std::uint32_t kCc = 0x01C00000, kAintc = 0x01C48000, kTimer = 0x01C21410, kPsc = 0x01C41000;
  static constexpr edma_codes_t kCodes = {3, 9, 0xB};  // 3, 12 and 30
  Edma() {
    chip.on_read = [this](std::uint32_t address) -> std::uint32_t {
      seen();
      return address == kCc + 0x2068 ? pending : address == kTimer ? ticks : chip.values[address];
    };
    chip.on_write = [this](std::uint32_t address, std::uint32_t value) {
      seen();
      if (address == kCc + 0x2058) open &= ~value;
      if (address == kCc + 0x2060) open |= value;
      if (address == kCc + 0x2070) pending &= ~value;
      if (address >= kPsc + 0xA00 && address < kPsc + 0xB00) chip.values[address - 0x200] = value & 0x1F;
    };
    edma_wait_prepare(kCodes);
    chip.accesses.clear();
  }
  void seen() {
    if (watched && masked == 0 && !ready()) ++not_ready;
  }
  bool ready() { return open == kBits && (chip.values[kAintc + 0x18] >> 16 & 1); }
  static constexpr std::uint32_t kBits = 1u << 3 | 1u << 12 | 1u << 30;
  RegisterRecorder chip;
  std::uint32_t open = 0, pending = 0, ticks = 0;
  unsigned not_ready = 0;
  bool watched = false;
};

TEST_F(Edma, AFrameThatComesWhileItIsPreparedAnewFindsItsInterruptsOpen) {
  ASSERT_TRUE(ready());
  watched = true;
  edma_wait_prepare(kCodes);
  EXPECT_GT(chip.accesses.size(), 20u) << "all of it is done again";
  EXPECT_EQ(not_ready, 0u);
  EXPECT_TRUE(ready());
  EXPECT_EQ(masked, 0);
}

TEST_F(Edma, AllCodesAreWaitedForAsleepAndACodeThatComesBetweenCheckAndSleepIsNotMissed) {
  unsigned sleeps = 0;
  asleep = [&] { pending |= ++sleeps == 1 ? 1u << 12 : sleeps == 2 ? 1u << 3 | 1u << 5 : 1u << 30; };
  edma_wait_all(kCodes);
  EXPECT_EQ(sleeps, 3u);
  EXPECT_EQ(pending, 1u << 5) << "a code that is not waited for is left";
  EXPECT_EQ(masked, 0);
  EXPECT_TRUE(ready());
}

}  // namespace
