// The profile of the core's clocks: exact for each instruction and cause, and without effect on any figure.
#include <cstdlib>
#include <iostream>
#include <map>
#include <random>
#include <tuple>

#include "tb/iss/machine.h"
#include "tb/iss/random_code.h"
#include "tb/iss/vectors.h"

namespace fovea::cpu::test {
namespace {

using Key = std::pair<std::uint32_t, unsigned>;  // address, cause
using Clocks = std::map<Key, std::uint64_t>;
constexpr unsigned kInstructions = 100;  // as a cause: not clocks but executions

/// What each instruction costs, seen from outside: the counters at each instruction boundary. Between
/// two boundaries lies one instruction, from the fetch on. An exception's entry belongs to its cause.
class Watcher : public BoundaryObserver {
 public:
  explicit Watcher(Core& core) : core_(core), watching_(core.observe_boundaries(*this)) {}
  void at_boundary() override { take(); }
  Clocks finish() {
    take();
    return std::move(seen_);
  }

 private:
  void take() {
    const Counts& now = core_.counts();
    const auto add = [&](unsigned cause, std::uint64_t n) {
      if (n) seen_[{pc_, cause}] += n;
    };
    add(ProfileRow::kIssue, now.issue - last_.issue);
    add(ProfileRow::kIdle, now.idle - last_.idle);
    add(kInstructions, now.instructions - last_.instructions);
    for (std::size_t k = 0; k < kCauses; ++k)
      add(static_cast<unsigned>(ProfileRow::kStall + k), now.stall[k] - last_.stall[k]);
    last_ = now;
    pc_ = core_.reg(15);
  }
  Core& core_;
  Counts last_;
  std::uint32_t pc_ = 0;
  Clocks seen_;
  Subscription watching_;
};

Clocks by_instruction(const ClockProfile& p, std::size_t section = 0) {
  Clocks out;
  for (const ProfileRow& r : p.rows(section)) {
    const unsigned cause = r.cause < ProfileRow::kStall ? std::min<unsigned>(r.cause, ProfileRow::kIdle)
                                                        : r.cause;
    if (r.clocks) out[{r.address, cause}] += r.clocks;
    if (r.instructions) out[{r.address, kInstructions}] += r.instructions;
  }
  return out;
}

std::string text(const Key& k) {
  char s[64];
  std::snprintf(s, sizeof s, "0x%x cause %u", k.first, k.second);
  return s;
}

void expect_equal(const Clocks& profile, const Clocks& seen) {
  unsigned wrong = 0;
  for (const auto& [key, n] : seen) {
    const auto found = profile.find(key);
    const std::uint64_t has = found == profile.end() ? 0 : found->second;
    if (has != n && ++wrong < 10) ADD_FAILURE() << text(key) << ": " << has << " instead of " << n;
  }
  for (const auto& [key, n] : profile)
    if (!seen.contains(key) && ++wrong < 10) ADD_FAILURE() << text(key) << ": " << n << " instead of 0";
  EXPECT_EQ(wrong, 0u);
}

/// Sums of a section by cause, region and culprit against the core's own counters.
void expect_sums(const std::vector<ProfileRow>& rows, const Counts& from, const Counts& to) {
  std::uint64_t all = 0, issue = 0, instructions = 0;
  std::array<std::uint64_t, kWakeEvents> idle{};  // with waits for work that was given away
  std::map<std::pair<unsigned, unsigned>, std::uint64_t> stalls;
  for (const ProfileRow& r : rows) {
    all += r.clocks;
    instructions += r.instructions;
    if (r.cause == ProfileRow::kIssue) issue += r.clocks;
    else if (r.stalled()) stalls[{r.cause - ProfileRow::kStall, r.region}] += r.clocks;
    else idle[(r.cause - ProfileRow::kIdle) % kWakeEvents] += r.clocks;
  }
  EXPECT_EQ(all, to.cycles - from.cycles);
  EXPECT_EQ(issue, to.issue - from.issue);
  EXPECT_EQ(instructions, to.instructions - from.instructions);
  for (std::size_t k = 0; k < kWakeEvents; ++k) EXPECT_EQ(idle[k], to.idle_by[k] - from.idle_by[k]);
  for (std::size_t c = 0; c < kCauses; ++c)
    for (unsigned r = 0; r < RegionMap::kMax; ++r) {
      std::uint64_t n = 0;
      for (std::size_t k = 0; k < kStallCulprits; ++k)
        n += to.stalled(static_cast<Cause>(c), r, k, from);
      EXPECT_EQ((stalls[{static_cast<unsigned>(c), r}]), n) << "cause " << c << " region " << r;
    }
}

Counts ended(Core& core, std::uint64_t first = 1) {
  Counts c = core.counts();
  c.cycles = core.clock_count() - first;
  return c;
}

/// A program run three times: alone, with a profile, and instruction by instruction.
template <class Start>
void check(Start start, bool compare_each = true) {
  Machine plain, profiled;
  start(plain);
  profiled.core.start_profile();
  start(profiled);
  const Counts end = ended(profiled.core);
  EXPECT_EQ(plain.core.clock_count(), profiled.core.clock_count());
  EXPECT_TRUE(plain.core.counts() == profiled.core.counts()) << "the profile changed a figure";
  profiled.core.finish_profile(end);
  expect_sums(profiled.core.profile()->rows(0), Counts{}, end);
  if (!compare_each) return;
  Machine watched;
  Watcher watcher(watched.core);
  start(watched);
  ASSERT_EQ(watched.core.clock_count(), plain.core.clock_count());
  expect_equal(by_instruction(*profiled.core.profile()), watcher.finish());
}

std::uint64_t seed() {
  const char* s = std::getenv("FOVEA_SEED");
  return s ? std::strtoull(s, nullptr, 0) : 17;
}

TEST(ProfileTest, RandomProgramsInstructionByInstruction) {
  std::cout << "seed " << seed() << "\n";
  for (std::uint64_t n = 0; n < 6; ++n) {
    const RandomProgram p = generate(seed() + n, 120, 10);
    const std::string user = " msr cpsr_c, #0x10\n ldr r0, =0x100000\n bx r0\n";
    const Program boot = assemble((n & 1u ? kCachesOn : "") + user, 0);
    check([&](Machine& m) {
      std::memcpy(m.port.at(kMemory), p.image.data(), p.image.size());
      m.load(boot);
      m.run();
    });
    if (HasFailure()) FAIL() << "program " << n;
  }
}

/// Loops, calls, tables and conditions in ARM and Thumb state, from cached memory: what chains are made of.
const std::string kLoops = R"(
  .macro work name
\name:
  push {r4-r7, lr}
  mov r4, #25
1: sub r4, r4, #1
  mov r5, r4
  bl \name\()leaf
  cmp r5, #7
  bgt 2f
  mov r6, #3
3: sub r6, r6, #1
  cmp r6, #0
  bne 3b
2: ldr r7, [r3]
  add r7, r7, r5
  str r7, [r3]
  .word 0xe8930080  @ ldmia r3, {r7}, for which the assembler has an ldr
  .word 0xe8830080  @ stmia r3, {r7}
  ldrb r7, [r3, #1]
  mov r6, r7
  cmp r4, #0
  bne 1b
  pop {r4-r7, pc}
\name\()leaf:
  mov r6, #2
  mul r6, r5, r6
  mov r5, r6
  bx lr
  .endm
  ldr r3, =0x00300000
  ldr sp, =0x00380000
  mov r8, #40
5: bl arm
  ldr r0, =thumb + 1
  mov lr, pc
  bx r0
  add r3, r3, #4
  add r0, r8, r8, lsl r8
  ldr r1, [r3, r8, lsl #2]
  adds r0, r0, r1
  strpl r0, [r3, #256]
  muls r2, r0, r8
  umull r0, r2, r8, r8
  add r2, r2, #1
  addeq r2, r2, #1
  subs r8, r8, #1
  bne 5b
  svc #2
  .ltorg
  work arm
  .thumb
  .syntax unified
  .thumb_func
thumb:
  push {r4-r7, lr}
  movs r4, #25
1: subs r4, r4, #1
  movs r5, r4
  bl thumbleaf
  cmp r5, #7
  bgt 2f
  movs r6, #3
3: subs r6, r6, #1
  bne 3b
2: ldrh r7, [r3]
  adds r7, r7, r5
  strh r7, [r3]
  cmp r4, #0
  bne 1b
  pop {r4-r7, pc}
  .thumb_func
thumbleaf:
  movs r6, #2
  muls r5, r6, r5
  bx lr
  .arm
)";

const std::string kToLoops = kVectors + kCachesOn + "msr cpsr_c, #0x1f\n ldr r0, =0x00140000\n mov pc, r0\n .ltorg\n";

TEST(ProfileTest, LoopsInArmAndThumbState) {
  static const Program loops = assemble(kLoops, 0x0014'0000);
  static const Program boot = assemble(kToLoops, 0);
  check([&](Machine& m) {
    m.load(loops);
    m.load(boot);
    m.run();
  });
  // The same from internal RAM, whose records rely on no neighbours, and past the caches.
  static const Program inside = assemble(kLoops, 0);
  check([&](Machine& m) {
    m.load(inside);
    m.run();
  });
  check([&](Machine& m) {
    m.load(loops);
    m.run(0x0014'0000);
  });
}

/// Code that a program writes over itself: what was executed before counts with its own clocks.
TEST(ProfileTest, CodeThatChanges) {
  const std::string text = R"(
    mov r4, #10
  1: adr r0, 2f
    ldr r1, [r0, #48]
    tst r4, #1
    ldreq r1, [r0, #52]
    str r1, [r0]
    mov r5, #20
    b 2f
    .balign 32
  2: nop
    subs r5, r5, #1
    bne 2b
    subs r4, r4, #1
    bne 1b
    svc #2
    .balign 16
    .skip 16
    mul r3, r4, r5
    mov r3, r4, lsl r5
  )";
  check([&](Machine& m) {
    m.program = assemble(text, 0);
    m.load(m.program);
    m.run();
  });
}

/// Clocks by hand: ARM DDI 0222B chapter 8, code and data in internal RAM. Each row: instructions executed, clocks
/// issued, clocks of interlock.
TEST(ProfileTest, HandCountedLoop) {
  const std::string text = R"(
    mov r4, #0x5000
    mov r5, #1000       @ +4
  1: ldr r0, [r4]       @ +8: 1 each
    add r1, r0, #1      @ +c: 1, waits 1 for the load
    mul r2, r1, r1      @ +10: 2
    add r2, r2, #1      @ +14: 1, waits 1 for the product
    tst r5, #1          @ +18: 1
    bne 2f              @ +1c: 3 if taken (500 times), otherwise 1
    ldrb r3, [r4, #1]   @ +20: 500 times 1
    add r3, r3, #1      @ +24: 500 times 1, waits 2
  2: movne r3, r4, lsl r5  @ +28: 500 times 2, 500 times 1 because it is not executed
    ldm r4, {r6-r9}     @ +2c: 4
    subs r5, r5, #1     @ +30: 1
    bne 1b              @ +34: 999 times 3, once 1
    svc #2
    .ltorg
  )";
  constexpr std::uint32_t at = 0;
  const Machine::Settings no_waits = {{"cpu.tcm.wait_states", "0 cycles"}};
  Machine m(no_waits);
  m.core.start_profile();
  m.load(assemble(text, at));
  m.run();
  m.core.finish_profile(ended(m.core));
  const Clocks c = by_instruction(*m.core.profile());
  struct Row {
    unsigned offset;
    std::uint64_t executed, issued, waited;
  };
  constexpr Row kRows[] = {{0x04, 1, 1, 0},       {0x08, 1000, 1000, 0},   {0x0c, 1000, 1000, 1000},
                           {0x10, 1000, 2000, 0}, {0x14, 1000, 1000, 1000}, {0x18, 1000, 1000, 0},
                           {0x1c, 1000, 2000, 0}, {0x20, 500, 500, 0},     {0x24, 500, 500, 1000},
                           {0x28, 1000, 1500, 0}, {0x2c, 1000, 4000, 0},   {0x30, 1000, 1000, 0},
                           {0x34, 1000, 2998, 0}};
  const auto of = [&](std::uint32_t offset, unsigned cause) {
    const auto found = c.find({at + offset, cause});
    return found == c.end() ? 0 : found->second;
  };
  for (const Row& r : kRows) {
    EXPECT_EQ(of(r.offset, kInstructions), r.executed) << std::hex << r.offset;
    EXPECT_EQ(of(r.offset, ProfileRow::kIssue), r.issued) << std::hex << r.offset;
    EXPECT_EQ(of(r.offset, ProfileRow::kStall), r.waited) << std::hex << r.offset;
  }
}

const std::string kSleeper = R"(
  ldr r4, =0x00200000
  mov r8, #60
1: mov r5, #30
2: ldr r0, [r4], #32
  str r0, [r4, #64]
  subs r5, r5, #1
  bne 2b
  mov r0, #0
  mcr p15, 0, r0, c7, c0, 4
  subs r8, r8, #1
  bne 1b
  svc #2
  .ltorg
)";

/// Interrupts at any time, sleeps that different events end, and sections that begin at random times,
/// within sleeps too: each section adds up, and all together are the whole run.
TEST(ProfileTest, SectionsAtRandomTimesAddUp) {
  std::mt19937_64 random(seed());
  static const Program code = assemble(kSleeper, 0x0014'0000);
  static const Program boot = assemble(kToLoops, 0);
  unsigned within_sleep = 0;
  for (unsigned n = 0; n < 12; ++n) {
    Machine m;
    ClockProfile& profile = m.core.start_profile();
    unsigned wakes = 0;
    m.core.wake_event = [&] { return static_cast<WakeEvent>(wakes++ % kWakeEvents); };
    m.on_svc = [&m](std::uint32_t number) {
      if (number != 4) return;
      m.core.set_irq(false, m.time());
      m.port.interrupt_at(kNever);
    };
    const Picoseconds every = 20'000'000 + random() % 20'000'000;
    std::function<void(Picoseconds)> tick = [&](Picoseconds t) {
      m.port.schedule(t, [&, t] {
        m.core.set_irq(true, t);
        m.port.interrupt_at(t);
        tick(t + every);
      });
    };
    tick(every);
    Picoseconds at[2];
    at[0] = every + random() % (20 * every);
    at[1] = at[0] + 1 + random() % (20 * every);
    for (unsigned k = 0; k < 2; ++k)
      m.port.schedule(at[k], [&m, k, t = at[k]] {
        m.core.mark_window(t);
        m.core.mark_section(t, k + 1);
        m.core.mark_given_away(t, k == 0);
      });
    m.load(code);
    m.load(boot);
    m.run();
    const Counts end = ended(m.core, 0);
    m.core.finish_profile(end);
    const Counts& from = m.core.window_stats().from;
    const Counts& to = m.core.window_stats().to;
    Counts start;
    start.cycles = 1;
    expect_sums(profile.rows(0), start, from);
    expect_sums(profile.rows(1), from, to);
    expect_sums(profile.rows(2), to, end);
    // The window is also when work is given away: its sleeps are waits, and no others.
    for (unsigned section = 0; section < 3; ++section)
      for (const ProfileRow& r : profile.rows(section))
        EXPECT_EQ(r.cause >= ProfileRow::kWait && !r.stalled(),
                  section == 1 && r.cause >= ProfileRow::kIdle && !r.stalled())
            << section;
    within_sleep += from.idle && from.cycles == at[0] / Machine::kClock + 1;
    if (HasFailure()) FAIL() << "run " << n;
  }
  EXPECT_GT(within_sleep, 0u) << "some marks must fall into a sleep";
}

/// A run may end within a sleep. Its clocks up to there are the sleep's.
TEST(ProfileTest, EndsInASleep) {
  Machine m;
  const ClockProfile& profile = m.core.start_profile();
  std::uint64_t asleep = 0;
  m.port.schedule(400'001, [&] {
    Counts end = ended(m.core);
    asleep = 101 - m.core.clock_count();
    end.idle += asleep;
    m.core.finish_profile(end);
  });
  m.port.schedule(800'000, [&] {
    m.core.set_irq(true, 800'000);
    m.port.interrupt_at(800'000);
    std::uint64_t idle = 0, all = 0;
    for (const ProfileRow& r : profile.rows(0)) {
      all += r.clocks;
      if (r.cause >= ProfileRow::kIdle && !r.stalled()) idle += r.clocks;
    }
    EXPECT_EQ(idle, asleep);
    EXPECT_EQ(all, 100u);
  });
  m.execute("mov r0, #0\n mcr p15, 0, r0, c7, c0, 4\n nop");
  EXPECT_GT(asleep, 80u);
}

TEST(MaskWatchTest, KeepsTheFirstOfEquallyLongStretches) {
  MaskWatch w;  // IRQs are masked after a reset
  w.set(false, 5, 0x10);
  w.set(true, 10, 0x20);
  w.set(false, 15, 0x30);
  EXPECT_EQ(w.longest().clocks, 5u);
  EXPECT_EQ(w.longest().begin, 0u);
  EXPECT_EQ(w.longest().end, 0x10u);
  w.set(true, 20, 0x40);
  w.set(false, 26, 0x50);
  EXPECT_EQ(w.longest().clocks, 6u);
  EXPECT_EQ(w.longest().begin, 0x40u);
  EXPECT_EQ(w.longest().end, 0x50u);
}

}  // namespace
}  // namespace fovea::cpu::test
