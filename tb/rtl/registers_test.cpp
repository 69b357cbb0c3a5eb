// The device's registers: against a small model that is written from the table in rtl/README.md, its queue, its events
// and its interrupt.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>

#include "tb/rtl/engine_bench.h"
#include "tb/rtl/random_jobs.h"

namespace fovea::rtl {
namespace {

constexpr std::uint32_t kWord = EngineBench::kBase / 4, kMap = 0x8000, kTarget = 0x1'0000,
                        kSize = 0x2'0000, kBorder = 0x10801080;
constexpr std::uint32_t kDone = 1, kRefused = 2, kReadError = 4, kWriteError = 8, kAborted = 16,
                        kOverflow = 32, kDropped = 64, kEnable = 1, kAbort = 2;
constexpr unsigned kSlaveError = 2;

/// What the registers hold while the device is disabled, so that no job is taken.
class Model {
 public:
  unsigned write(const RegisterWrite& w) {
    const unsigned offset = w.offset & ~3u;
    if (!is_register(offset)) return kSlaveError;
    std::uint32_t lanes = 0;
    for (unsigned byte = 0; byte < 4; ++byte)
      if (w.strobes >> byte & 1) lanes |= 0xFFu << 8 * byte;
    const bool low = w.strobes & 1;
    if (offset == Offset::kCtrl && low && w.value & kAbort) {
      if (queued_) events_ |= kDropped;
      queued_ = 0;
    } else if (offset == Offset::kEvents && low) {
      events_ &= ~(w.value & 0xFF);
    } else if (offset == Offset::kSubmit && low) {
      if (queued_ == 4)
        events_ |= kOverflow;
      else
        ++queued_;
    }
    if (const auto r = kept_.find(offset); r != kept_.end())
      r->second.value = (r->second.value & ~lanes) | (w.value & lanes & r->second.writable);
    return 0;
  }
  RegisterAnswer read(unsigned offset) const {
    offset &= ~3u;
    if (!is_register(offset)) return {.read_response = kSlaveError};
    if (offset == Offset::kId) return {.data = 0x52454D31};
    if (offset == Offset::kStatus) return {.data = queued_ << 4 | (queued_ == 4 ? 0x100u : 0u)};
    if (offset == Offset::kEvents) return {.data = events_};
    const auto r = kept_.find(offset);
    return {.data = r == kept_.end() ? 0 : r->second.value};
  }
  std::uint32_t events() const { return events_; }
  std::uint32_t enables() const { return kept_.at(Offset::kEnables).value; }

 private:
  struct Kept {
    std::uint32_t writable, value = 0;
  };
  static bool is_register(unsigned offset) {
    return offset <= 0x18 || (offset >= 0x20 && offset <= 0x2C) ||
           (offset >= 0x40 && offset <= 0x94);
  }
  std::map<unsigned, Kept> kept_{
      {0x10, {0x7F}},        {0x40, {0x1FFF0707}},  {0x44, {0x1FFF0FFF}},  {0x48, {0xFFFFFFFC}},
      {0x4C, {0x7FFC}},      {0x50, {0x1FFF1FFF}},  {0x54, {0xFFFFFFFC}},  {0x58, {0x7FFC}},
      {0x5C, {0xFFFFFFC0}},  {0x60, {0x00FFFFFF}},  {0x64, {0xFFFFFFFF}},  {0x68, {0xFFFFFFFF}},
      {0x6C, {0xFFFFFFFF}},  {0x70, {0xFFFFFFFF}},  {0x74, {0xFFFFFFFF}},  {0x78, {0xFFFFFFFF}},
      {0x7C, {0xFFFFFFFF}},  {0x80, {0xFFFFFFFF}},  {0x84, {0xFFFFFFFF}},  {0x88, {0xFFFFFFFF}},
      {0x8C, {0xFFFFFFFF}},  {0x90, {0xFFFFFFFF}},  {0x94, {0xFFFFFFFF}}};
  std::uint32_t events_ = 0, queued_ = 0;
};

/// Offsets of registers mostly; those with an effect, and what is no register, often enough.
unsigned any_offset(Dice& dice) {
  if (dice.to(3) == 0) return std::array{0x04u, 0x0Cu, 0x14u, 0x14u}[dice.to(3)];
  return dice.to(7) ? dice.to(0x9F) : dice.to(0x3FF);
}

// One read and one write at a time (AXI4-Lite, ARM IHI 0022): what comes next is taken when the answer before it is, so
// that no answer is lost, however long it is left on the bus.
TEST(RegistersTest, AnAccessWaitsForTheAnswerBeforeIt) {
  constexpr unsigned border = 0x64, limit = 0x68;  // offsets of registers of 32 writable bits
  for (const unsigned hold : {0u, 1u, 2u, 7u}) {
    EngineBench bench(kSize, seed() + 5);
    const auto written = bench.write_two({border, 0x1234'5678, 15}, {0x3FC, 0, 15}, hold);
    EXPECT_EQ(written[0].write_response, 0u) << hold;
    EXPECT_EQ(written[1].write_response, kSlaveError) << hold;
    const auto swapped = bench.write_two({0x3FC, 0, 15}, {limit, 0x9ABC'DEF0, 15}, hold);
    EXPECT_EQ(swapped[0].write_response, kSlaveError) << hold;
    EXPECT_EQ(swapped[1].write_response, 0u) << hold;
    const auto read = bench.read_two(border, limit, hold);
    EXPECT_EQ(read[0].data, 0x1234'5678u) << hold;
    EXPECT_EQ(read[1].data, 0x9ABC'DEF0u) << hold;
    const auto refused = bench.read_two(0x3FC, border, hold);
    EXPECT_EQ(refused[0].read_response, kSlaveError) << hold;
    EXPECT_EQ(refused[1].read_response, 0u) << hold;
    EXPECT_EQ(refused[1].data, 0x1234'5678u) << hold;
  }
}

TEST(RegistersTest, RandomAccessesAreWhatTheTableSays) {
  Dice dice(seed() + 3);
  EngineBench bench(kSize, seed() + 3);
  Model model;
  for (unsigned n = 0; n < 4000; ++n) {
    bench.bus_willing = std::array{16u, 16u, 8u, 2u}[n / 100 % 4];
    std::optional<RegisterWrite> write;
    std::optional<unsigned> read;
    if (dice.to(2)) {
      write = {any_offset(dice), dice.word(), dice.to(2) ? 15 : dice.to(15)};
      if ((write->offset & ~3u) == Offset::kCtrl) write->value &= dice.to(1) ? ~3u : ~1u;
    }
    if (!write || dice.to(2) == 0) read = any_offset(dice);
    const Model before = model;
    const unsigned response = write ? model.write(*write) : 0;
    const RegisterAnswer got = bench.access(write, read);
    EXPECT_EQ(got.write_response, response) << "write to " << write->offset;
    if (read) {  // before the write beside it, or after
      EXPECT_EQ(got.read_response, model.read(*read).read_response) << "read of " << *read;
      EXPECT_THAT(got.data, testing::AnyOf(before.read(*read).data, model.read(*read).data))
          << "read of " << *read;
    }
    EXPECT_EQ(bench.interrupt(), (model.events() & model.enables()) != 0);
    EXPECT_FALSE(bench.busy()) << "disabled, and no access";
    if (HasFailure()) FAIL() << "access " << n;
  }
  for (unsigned offset = 0; offset < 0x400; offset += 4) {
    const RegisterAnswer got = bench.access({}, offset);
    EXPECT_EQ(got.data, model.read(offset).data) << offset;
  }
}

/// A table job of rows · 8 pairs with `bad` bad entries, whose source is filled with `dice`.
MappedJob small_job(EngineBench& bench, unsigned number, unsigned rows, unsigned bad, Dice& dice) {
  MappedJob m;
  Job& j = m.job;
  j.pairs = j.dst_pitch = 8;
  j.rows = rows;
  j.src_width = 16;
  j.src_height = 8;
  j.src_pitch = 8;
  j.src_base = kWord + number * 0x400;
  j.dst_base = kWord + kTarget / 4 + number * 0x400;
  for (unsigned n = 0; n < 8 * rows; ++n) m.map.push_back(n < bad ? 2 : 4 * dice.to(63));
  for (unsigned n = 0; n < 64; ++n) bench.word(j.src_base + n) = dice.word();
  for (unsigned n = 0; n < 8 * rows; ++n) {
    bench.word(kWord + kMap / 4 + number * 0x100 + n) = m.map[n];
    bench.word(j.dst_base + n) = 0;
  }
  return m;
}
void submit(EngineBench& bench, const MappedJob& m, unsigned number, std::uint8_t tag) {
  bench.submit(m.job, EngineBench::kBase + kMap + number * 0x400, kBorder, tag);
}
bool right(EngineBench& bench, const MappedJob& m) {
  const auto want =
      picture(m.job, m.map, kBorder, [&](std::uint32_t at) { return bench.word(at); });
  for (std::size_t n = 0; n < want.size(); ++n)
    if (bench.word(m.job.dst_base + static_cast<std::uint32_t>(n)) != want[n]) return false;
  return true;
}
bool untouched(EngineBench& bench, const MappedJob& m) {
  for (unsigned n = 0; n < m.job.pairs * m.job.rows; ++n)
    if (bench.word(m.job.dst_base + n) != 0) return false;
  return true;
}

TEST(RegistersTest, TheQueueKeepsFourJobsAsPushedAndLosesTheFifth) {
  Dice dice(seed() + 4);
  EngineBench bench(kSize);
  bench.memory.latency = 300;  // a job takes longer than a look at the registers
  std::vector<MappedJob> jobs;
  for (unsigned n = 0; n < 5; ++n) jobs.push_back(small_job(bench, n, 1 + n, n, dice));
  bench.write(Offset::kEnables, kOverflow);
  for (unsigned n = 0; n < 4; ++n) {
    submit(bench, jobs[n], n, static_cast<std::uint8_t>(0xF0 + n));
    EXPECT_EQ(bench.read(Offset::kStatus), (n + 1) << 4 | (n == 3 ? 0x100u : 0u));
    EXPECT_FALSE(bench.interrupt());
  }
  submit(bench, jobs[4], 4, 0xF4);
  EXPECT_EQ(bench.read(Offset::kStatus), 4u << 4 | 0x100);
  EXPECT_EQ(bench.read(Offset::kEvents), kOverflow);
  EXPECT_TRUE(bench.interrupt());
  bench.write(Offset::kEvents, kOverflow);
  EXPECT_FALSE(bench.interrupt());
  for (unsigned n = 0; n < 500; ++n) bench.clock();
  EXPECT_EQ(bench.read(Offset::kEnded), 0u) << "disabled";
  bench.write(Offset::kEnables, kDone);
  bench.write(Offset::kCtrl, kEnable);
  for (unsigned n = 0; n < 4; ++n) {
    bench.until_interrupt(100'000);
    bench.write(Offset::kEvents, kDone);
    EXPECT_EQ(bench.read(Offset::kEnded), (n + 1) << 16 | kDone << 8 | (0xF0 + n));
    EXPECT_EQ(bench.read(Offset::kBad), n);
    EXPECT_EQ(bench.read(Offset::kWrites), (n + 2) / 2) << "bursts of two rows";
    EXPECT_GT(bench.read(Offset::kClocks), 600u) << "table, then source";
    EXPECT_EQ(bench.read(Offset::kStatus), n == 3 ? 0u : (3 - n - 1) << 4 | 1);
    EXPECT_TRUE(right(bench, jobs[n])) << n;
  }
  EXPECT_FALSE(bench.busy());
  EXPECT_TRUE(untouched(bench, jobs[4]));
}

TEST(RegistersTest, DisablingLetsTheJobUnderWayEndAndTakesNoOther) {
  Dice dice(seed() + 5);
  EngineBench bench(kSize);
  bench.memory.latency = 100;
  const MappedJob first = small_job(bench, 0, 4, 0, dice), second = small_job(bench, 1, 4, 0, dice);
  bench.write(Offset::kEnables, kDone);
  bench.write(Offset::kCtrl, kEnable);
  submit(bench, first, 0, 1);
  submit(bench, second, 1, 2);
  EXPECT_EQ(bench.read(Offset::kStatus), 1u << 4 | 1);
  EXPECT_TRUE(bench.busy());
  bench.write(Offset::kCtrl, 0);
  bench.until_interrupt(100'000);
  for (unsigned n = 0; n < 500; ++n) bench.clock();
  EXPECT_EQ(bench.read(Offset::kEnded), 1u << 16 | kDone << 8 | 1);
  EXPECT_EQ(bench.read(Offset::kStatus), 1u << 4);
  EXPECT_FALSE(bench.busy());
  EXPECT_TRUE(right(bench, first));
  EXPECT_TRUE(untouched(bench, second));
}

TEST(RegistersTest, AbortEndsTheJobAndDropsTheQueue) {
  Dice dice(seed() + 6);
  EngineBench bench(kSize);
  bench.memory.latency = 100;
  std::vector<MappedJob> jobs;
  for (unsigned n = 0; n < 4; ++n) jobs.push_back(small_job(bench, n, 8, 0, dice));
  bench.write(Offset::kCtrl, kEnable | kAbort);
  EXPECT_EQ(bench.read(Offset::kEvents), 0u) << "there was nothing to abort";
  for (unsigned n = 0; n < 3; ++n) submit(bench, jobs[n], n, static_cast<std::uint8_t>(n));
  EXPECT_EQ(bench.read(Offset::kStatus), 2u << 4 | 1);
  bench.write(Offset::kCtrl, kEnable | kAbort);
  EXPECT_EQ(bench.read(Offset::kStatus) & ~1u, 0u);
  bench.write(Offset::kEnables, kAborted);
  bench.until_interrupt(100'000);
  EXPECT_EQ(bench.read(Offset::kEvents), kAborted | kDropped);
  EXPECT_EQ(bench.read(Offset::kEnded), 1u << 16 | kAborted << 8 | 0);
  EXPECT_EQ(bench.read(Offset::kCtrl), kEnable);
  EXPECT_TRUE(bench.quiet());
  bench.write(Offset::kEvents, 0x7F);
  for (unsigned n = 0; n < 500; ++n) bench.clock();
  EXPECT_EQ(bench.read(Offset::kStatus), 0u);
  EXPECT_TRUE(untouched(bench, jobs[1]) && untouched(bench, jobs[2]));
  // Jobs that wait while the device is disabled; the job window is as it was.
  bench.write(Offset::kCtrl, 0);
  submit(bench, jobs[3], 3, 3);
  bench.write(Offset::kCtrl, kEnable | kAbort);
  EXPECT_EQ(bench.read(Offset::kEvents), kDropped);
  bench.write(Offset::kEvents, kDropped);
  bench.write(Offset::kEnables, kDone);
  bench.write(Offset::kSubmit, 9);
  bench.until_interrupt(100'000);
  EXPECT_EQ(bench.read(Offset::kEnded), 2u << 16 | kDone << 8 | 9);
  EXPECT_TRUE(right(bench, jobs[3]));
}

// Whatever the clock in which it comes, an abort loses no job silently: it ends, or is dropped.
TEST(RegistersTest, AnAbortAtAnyClockLosesNothingSilently) {
  Dice dice(seed() + 7);
  EngineBench bench(kSize);
  unsigned kinds[3] = {};
  const MappedJob a = small_job(bench, 0, 1, 0, dice), b = small_job(bench, 1, 1, 0, dice);
  for (unsigned clocks = 0; clocks < 90; ++clocks) {
    bench.write(Offset::kCtrl, 0);
    const std::uint32_t ended = bench.read(Offset::kEnded) >> 16;
    submit(bench, a, 0, 1);
    submit(bench, b, 1, 2);
    bench.write(Offset::kCtrl, kEnable);
    for (unsigned n = 0; n < clocks; ++n) bench.clock();
    bench.write(Offset::kCtrl, kEnable | kAbort);
    for (unsigned n = 0; n < 300; ++n) bench.clock();
    const std::uint32_t events = bench.read(Offset::kEvents),
                        jobs = (bench.read(Offset::kEnded) >> 16) - ended;
    EXPECT_EQ(jobs + (events & kDropped ? 2 - jobs : 0), 2u) << "abort after " << clocks;
    EXPECT_EQ(bench.read(Offset::kStatus), 0u);
    EXPECT_TRUE(bench.quiet());
    EXPECT_TRUE(!(events & kDone) || right(bench, a));
    ++kinds[jobs];
    bench.write(Offset::kEvents, 0x7F);
  }
  EXPECT_GT(kinds[1], 10u);
  EXPECT_GT(kinds[2], 10u);
}

TEST(RegistersTest, ARefusedJobEndsAtOnceAndTheNextStarts) {
  Dice dice(seed() + 8);
  EngineBench bench(kSize);
  MappedJob wrong = small_job(bench, 0, 2, 0, dice);
  const MappedJob good = small_job(bench, 1, 2, 0, dice);
  wrong.job.src_pitch = 7;
  submit(bench, wrong, 0, 1);
  submit(bench, good, 1, 2);
  bench.write(Offset::kEnables, kRefused);
  bench.write(Offset::kCtrl, kEnable);
  bench.until_interrupt(10);
  EXPECT_EQ(bench.read(Offset::kEnded), 1u << 16 | kRefused << 8 | 1);
  bench.write(Offset::kEnables, kDone);
  bench.until_interrupt(1000);
  EXPECT_EQ(bench.read(Offset::kEvents), kDone | kRefused);
  EXPECT_EQ(bench.read(Offset::kEnded), 2u << 16 | kDone << 8 | 2);
  EXPECT_TRUE(untouched(bench, wrong));
  EXPECT_TRUE(right(bench, good));
}

TEST(RegistersTest, TheNumberOfJobsIsCountedModulo65536) {
  const bool all = std::getenv("RTL_LONG") != nullptr;
  const unsigned jobs = all ? 65'537 : 300;
  EngineBench bench(64);
  bench.write(Offset::kCtrl, kEnable);
  for (unsigned n = 1; n <= jobs; ++n) {  // refused, as the window is empty
    bench.write(Offset::kSubmit, n & 0xFF);
    while (bench.busy()) bench.clock();
    if (n % 256 == 1 || n % 4096 == 0) {
      ASSERT_EQ(bench.read(Offset::kEnded), (n & 0xFFFF) << 16 | kRefused << 8 | (n & 0xFF));
    }
  }
}

/// Brings about one event.
void cause(EngineBench& bench, const MappedJob& m, std::uint32_t event) {
  MappedJob job = m;
  bench.memory = {.latency = 20};
  if (event == kRefused) job.job.src_width = 3;
  if (event == kReadError) bench.memory.read_fault = m.job.src_base * 4;
  if (event == kWriteError) bench.memory.write_fault = m.job.dst_base * 4;
  bench.write(Offset::kCtrl, event == kOverflow || event == kDropped ? 0 : kEnable);
  for (unsigned n = 0; n < (event == kOverflow ? 5 : 1); ++n) submit(bench, job, 0, 0);
  if (event == kAborted || event == kDropped) bench.write(Offset::kCtrl, kAbort);
  for (unsigned n = 0; n < 300; ++n) bench.clock();
  if (event == kOverflow) {
    bench.write(Offset::kCtrl, kAbort);
    bench.write(Offset::kEvents, kDropped);
  }
}

TEST(RegistersTest, TheInterruptIsTheOrOfTheEventsWhoseEnableIsSet) {
  Dice dice(seed() + 9);
  EngineBench bench(kSize);
  MappedJob m = small_job(bench, 0, 2, 0, dice);
  m.map.assign(16, 0);  // one source line
  for (unsigned n = 0; n < 16; ++n) bench.word(kWord + kMap / 4 + n) = 0;
  for (unsigned bit = 0; bit < 7; ++bit) {
    cause(bench, m, 1u << bit);
    ASSERT_EQ(bench.read(Offset::kEvents), 1u << bit);
    for (unsigned enables = 0; enables < 128; ++enables) {
      bench.write(Offset::kEnables, enables);
      ASSERT_EQ(bench.interrupt(), (enables >> bit & 1) != 0) << "event " << bit;
    }
    bench.write(Offset::kEvents, 0x7F & ~(1u << bit));
    EXPECT_TRUE(bench.interrupt()) << "clearing others";
    bench.write(Offset::kEvents, 1u << bit, 0xE);
    EXPECT_TRUE(bench.interrupt()) << "the byte was not written";
    bench.write(Offset::kEvents, 1u << bit);
    EXPECT_FALSE(bench.interrupt());
  }
}

}  // namespace
}  // namespace fovea::rtl
