// Call stacks of small target programs: calls and returns, tail calls, long jumps, two tasks, nested
// interrupts. Each program is checked in full: every clock of the run is in one stack.
#include <algorithm>
#include <map>
#include <optional>
#include <random>
#include <set>
#include <span>
#include <vector>

#include "tb/iss/machine.h"
#include "tb/iss/vectors.h"

namespace fovea::cpu::test {
namespace {

/// The functions of a path, outermost first.
std::vector<std::uint32_t> functions_of(const std::vector<CallStacks::Path>& paths, CallStacks::Path path) {
  std::vector<std::uint32_t> out;
  for (out.push_back(path.function); path.caller; out.push_back(path.function)) path = paths.at(path.caller);
  std::reverse(out.begin(), out.end());
  return out;
}

using StackClocks = std::map<std::vector<std::uint32_t>, std::uint64_t>;
StackClocks by_functions(const std::vector<CallStacks::Path>& paths) {
  StackClocks out;
  for (const auto& p : paths)
    if (p.clocks) out[functions_of(paths, p)] += p.clocks;
  return out;
}

/// A program whose functions begin at the labels called f_NAME, and end at the next one.
struct Traced {
  Machine m;
  std::map<std::uint32_t, std::string> names;
  std::map<std::string, std::uint64_t> clocks;  ///< by "a;b;c"

  explicit Traced(const std::string& text, std::function<void(Machine&)> prepare = {}) {
    const Program p = assemble(text, 0);
    std::vector<CallStacks::Function> functions;
    for (const auto& [name, address] : p.symbols)
      if (name.starts_with("f_")) {
        names[address] = name.substr(2);
      }
    for (auto f = names.begin(); f != names.end(); ++f)
      functions.push_back({f->first, std::next(f) == names.end()
                                         ? static_cast<std::uint32_t>(p.bytes.size())
                                         : std::next(f)->first});
    ClockProfile& profile = m.core.start_profile();
    profile.stacks.set_functions(functions);
    if (prepare) prepare(m);
    m.load(p);
    m.run();
    Counts end = m.core.counts();
    m.core.finish_profile(end);
    std::uint64_t all = 0;
    const auto paths = profile.stacks.paths();
    for (const CallStacks::Path& path : paths) {
      if (path.clocks == 0) continue;
      std::string text_of;
      for (const std::uint32_t f : functions_of(paths, path))
        text_of += (text_of.empty() ? "" : ";") + (names.contains(f) ? names[f] : std::to_string(f));
      clocks[text_of] += path.clocks;
      all += path.clocks;
    }
    EXPECT_EQ(all, profile.clocks(0)) << "every clock is in one stack";
    EXPECT_EQ(all, m.core.clock_count() - 1);
  }
  std::set<std::string> stacks() const {
    std::set<std::string> out;
    for (const auto& [stack, n] : clocks) out.insert(stack);
    return out;
  }
  const CallStacks& tree() const { return m.core.profile()->stacks; }
};

using Stacks = std::set<std::string>;

TEST(CallStackTest, CallsAndReturns) {
  const Traced r(R"(
  f_main:
    mov sp, #0x4000
    bl f_a
    bl f_b
    adr r0, f_thumb
    add r0, r0, #1
    mov lr, pc
    bx r0
    svc #2
  f_a:
    push {r4, lr}
    bl f_leaf
    bl f_b
    pop {r4, pc}
  f_b:
    push {lr}
    mov lr, pc
    ldr pc, =f_leaf
    ldr pc, [sp], #4
    .ltorg
  f_leaf:
    mov r1, #10
  1: subs r1, r1, #1
    bne 1b
    mov pc, lr
    .thumb
  f_thumb:
    push {r4, lr}
    bl f_small
    pop {r4, pc}
    .balign 4
  f_small:
    bx lr
    .arm
  )");
  EXPECT_EQ(r.stacks(), (Stacks{"main", "main;a", "main;a;leaf", "main;a;b", "main;a;b;leaf", "main;b",
                                "main;b;leaf", "main;thumb", "main;thumb;small"}));
  EXPECT_EQ(r.clocks.at("main;b;leaf"), r.clocks.at("main;a;b;leaf"));
  std::uint64_t calls = 0;
  for (const auto& c : r.tree().calls()) {
    calls += c.count;
    if (r.names.at(c.to) != "a") continue;
    EXPECT_EQ(c.clocks, r.clocks.at("main;a") + r.clocks.at("main;a;leaf") + r.clocks.at("main;a;b") +
                            r.clocks.at("main;a;b;leaf"));
  }
  EXPECT_EQ(calls, 8u);
}

TEST(CallStackTest, RecursionCountsOnce) {
  const Traced r(R"(
  f_main:
    mov sp, #0x4000
    mov r0, #4
    bl f_down
    svc #2
  f_down:
    push {r4, lr}
    subs r0, r0, #1
    blne f_down
    pop {r4, pc}
  )");
  EXPECT_EQ(r.stacks(), (Stacks{"main", "main;down", "main;down;down", "main;down;down;down",
                                "main;down;down;down;down"}));
  std::uint64_t all = 0;
  for (const auto& [stack, n] : r.clocks) all += stack == "main" ? 0 : n;
  for (const auto& c : r.tree().calls()) {
    EXPECT_EQ(c.count, c.clocks == all ? 1u : 3u);
    EXPECT_EQ(c.clocks, c.count == 1 ? all : all - r.clocks.at("main;down"));
  }
}

TEST(CallStackTest, RecursionThatIsUnderWay) {
  cpu::CallStacks s;
  s.start(0, 0x100);
  s.count(0, true);
  s.call(10, 0x100, 0x200, 0x104, 0x8000);
  s.call(20, 0x200, 0x200, 0x204, 0x7FF0);
  s.call(30, 0x200, 0x200, 0x204, 0x7FE0);
  s.count(40, false);
  const auto calls = s.calls();
  ASSERT_EQ(calls.size(), 2u);
  EXPECT_EQ(calls[0].count, 1u);
  EXPECT_EQ(calls[0].clocks, 30u);
  EXPECT_EQ(calls[1].count, 2u);
  EXPECT_EQ(calls[1].clocks, 20u);
}

/// Handlers that end in another way than a return from an exception.
TEST(CallStackTest, ExceptionsThatNeverReturn) {
  cpu::CallStacks s;
  s.start(0, 0x100);
  s.count(0, true);
  for (std::uint64_t cycle = 1; cycle <= 600; ++cycle) s.exception(cycle, 0x10, 0x100, 0x8000);
  s.count(601, false);
  std::uint64_t clocks = 0;
  for (const auto& path : s.paths()) clocks += path.clocks;
  EXPECT_EQ(clocks, 601u);
}

/// A branch, and a branch to a register, out of a function: the callee returns for its caller.
TEST(CallStackTest, TailCalls) {
  const Traced r(R"(
  f_main:
    mov sp, #0x4000
    mov r5, #3
  1: bl f_first
    subs r5, r5, #1
    bne 1b
    svc #2
  f_first:
    push {r4, lr}
    bl f_leaf
    pop {r4, lr}
    cmp r5, #2
    beq f_second
    ldr r3, =f_third
    bx r3
    .ltorg
  f_second:
    push {r4, lr}
    bl f_leaf
    pop {r4, pc}
  f_third:
    b f_leaf
  f_leaf:
    bx lr
  )");
  EXPECT_EQ(r.stacks(), (Stacks{"main", "main;first", "main;first;leaf", "main;second",
                                "main;second;leaf", "main;third", "main;leaf"}));
}

/// A table of cases inside a function is no call.
TEST(CallStackTest, TablesOfCases) {
  const Traced r(R"(
  f_main:
    mov sp, #0x4000
    mov r0, #1
    bl f_choose
    mov r0, #0
    bl f_choose
    svc #2
  f_choose:
    push {r4, lr}
    cmp r0, #1
    ldrls pc, [pc, r0, lsl #2]
    nop
    .word 1f, 2f
  1: mov r1, #1
    pop {r4, pc}
  2: bl f_leaf
    pop {r4, pc}
  f_leaf:
    bx lr
  )");
  EXPECT_EQ(r.stacks(), (Stacks{"main", "main;choose", "main;choose;leaf"}));
}

/// From three calls deep back into the function that called setjmp, twice.
TEST(CallStackTest, LongJump) {
  const Traced r(R"(
  f_main:
    mov sp, #0x4000
    bl f_outer
    bl f_leaf
    svc #2
  f_outer:
    push {r4, lr}
    sub sp, sp, #8
    mov r6, #0x3000
    bl f_setjmp
    cmp r0, #2
    bge 1f
    add r4, r0, #1
    bl f_middle
  1: bl f_leaf
    add sp, sp, #8
    pop {r4, pc}
  f_middle:
    push {r4, lr}
    bl f_inner
    pop {r4, pc}
  f_inner:
    push {r4, lr}
    mov r0, r4
    bl f_longjmp
  f_setjmp:
    str sp, [r6]
    str lr, [r6, #4]
    mov r0, #0
    bx lr
  f_longjmp:
    ldr sp, [r6]
    ldr pc, [r6, #4]
  f_leaf:
    bx lr
  )");
  EXPECT_EQ(r.stacks(),
            (Stacks{"main", "main;outer", "main;outer;setjmp", "main;outer;middle",
                    "main;outer;middle;inner", "main;outer;middle;inner;longjmp", "main;outer;leaf",
                    "main;leaf"}));
}

/// Two tasks with stacks of 256 bytes side by side hand over to each other from two calls deep.
TEST(CallStackTest, TwoTasks) {
  const Traced r(R"(
    .equ other, 0x3000
  f_main:
    mov sp, #0x4000
    ldr r0, =other
    ldr r1, =0x4100 - 40
    str r1, [r0]
    ldr r2, =f_second
    str r2, [r1, #36]
    mov r5, #6
    bl f_first
    svc #2
    .ltorg
  f_first:
    push {r4, lr}
  1: bl f_work
    bl f_yield
    subs r5, r5, #1
    bne 1b
    pop {r4, pc}
  f_second:
    bl f_chore
    b f_second
  f_chore:
    push {r4, lr}
    bl f_work
    bl f_yield
    bl f_work
    pop {r4, pc}
  f_work:
    mov r1, #20
  1: subs r1, r1, #1
    bne 1b
    bx lr
  f_yield:
    push {r4, lr}
    bl f_switch
    pop {r4, pc}
  f_switch:
    push {r4, r6-r12, r14}
    push {r4}
    ldr r0, =other
    ldr r1, [r0]
    str sp, [r0]
    mov sp, r1
    pop {r4}
    pop {r4, r6-r12, pc}
    .ltorg
  )");
  EXPECT_EQ(r.stacks(),
            (Stacks{"main", "main;first", "main;first;work", "main;first;yield",
                    "main;first;yield;switch", "second", "second;chore", "second;chore;work",
                    "second;chore;yield", "second;chore;yield;switch"}));
  // Six turns of 20 times 2 or 4 clocks and the way there and back, in each task.
  EXPECT_EQ(r.clocks.at("main;first;work"), 6 * (1 + 19 * 4 + 2 + 3));
  const auto ranges = r.tree().ranges();
  ASSERT_EQ(ranges.size(), 2u);
  EXPECT_EQ(ranges[0].base, 0x4000u);
  EXPECT_EQ(ranges[1].base, 0x4100u);
  for (const auto& range : ranges) {
    EXPECT_LE(range.base - range.low, 64u);
    EXPECT_GE(range.base - range.low, 16u);
  }
}

/// An FIQ interrupts the handler of an IRQ, which calls functions; both return to where they came from.
TEST(CallStackTest, NestedInterrupts) {
  const std::string text = R"(
  f_vectors:
    b f_main
    .skip 20
    b f_irq
  f_fiq:
    sub lr, lr, #4
    push {r0-r3, lr}
    svc #5
    bl f_work
    ldm sp!, {r0-r3, pc}^
  f_irq:
    sub lr, lr, #4
    push {r0-r3, lr}
    svc #4
    bl f_work
    bl f_work
    ldm sp!, {r0-r3, pc}^
  f_main:
    msr cpsr_c, #0xd1
    mov sp, #0x3000
    msr cpsr_c, #0xd2
    mov sp, #0x3800
    msr cpsr_c, #0x1f
    mov sp, #0x4000
    bl f_task
    svc #2
  f_task:
    push {r4, lr}
    mov r4, #40
  1: bl f_work
    subs r4, r4, #1
    bne 1b
    pop {r4, pc}
  f_work:
    mov r1, #20
  1: subs r1, r1, #1
    bne 1b
    bx lr
  )";
  const Traced r(text, [](Machine& m) {
    m.on_svc = [&m](std::uint32_t n) {
      if (n == 4) m.core.set_irq(false, m.time());
      if (n == 5) m.core.set_fiq(false, m.time());
    };
    const Picoseconds at = 500 * Machine::kClock;
    m.port.schedule(at, [&m] { m.core.set_irq(true, at); });
    // While the handler works.
    const Picoseconds later = at + 60 * Machine::kClock;
    m.port.schedule(later, [&m] { m.core.set_fiq(true, later); });
  });
  Stacks expected{"vectors", "main", "main;task", "main;task;work", "irq", "irq;work", "fiq",
                  "fiq;work"};
  Stacks seen = r.stacks();
  seen.erase("vectors");
  expected.erase("vectors");
  EXPECT_EQ(seen, expected);
  const std::uint64_t work = 1 + 19 * 4 + 2 + 3;
  EXPECT_EQ(r.clocks.at("irq;work"), 2 * work);
  EXPECT_EQ(r.clocks.at("fiq;work"), work);
  EXPECT_EQ(r.clocks.at("main;task;work"), 40 * work);
}

/// What a watcher was told: clocks by path, without a gap between two stretches.
struct Watched final : CallStacks::Watcher {
  std::map<std::vector<std::uint32_t>, std::uint64_t> clocks;
  std::optional<std::uint64_t> last;
  std::vector<std::uint32_t> copy;  ///< what is active, by what has changed
  std::uint64_t changed = 0;
  void ran(std::span<const std::uint32_t> functions, std::size_t same, std::uint64_t begin,
           std::uint64_t end) override {
    if (!last) same = 0;
    ASSERT_LE(same, copy.size());
    ASSERT_LE(same, functions.size());
    copy.resize(same);
    copy.insert(copy.end(), functions.begin() + static_cast<std::ptrdiff_t>(same), functions.end());
    changed += functions.size() - same;
    if (functions.size() < 100) EXPECT_EQ(copy, std::vector<std::uint32_t>(functions.begin(), functions.end()));
    EXPECT_EQ(begin, last.value_or(begin));
    EXPECT_LE(begin, end);
    last = end;
    if (functions.size() < 100) clocks[{functions.begin(), functions.end()}] += end - begin;
  }
};

class StacksByHandTest : public ::testing::Test {
 protected:
  StacksByHandTest() {
    stacks.set_functions({{0x100, 0x200}, {0x200, 0x300}, {0x300, 0x400}});
    watching = stacks.watch(watched);
    stacks.start(10, 0x100);
  }
  CallStacks stacks;
  Watched watched;
  Subscription watching;
};

TEST_F(StacksByHandTest, TheEndOfOneWatcherLeavesTheOther) {
  Watched other;
  Subscription others = stacks.watch(other);
  stacks.call(30, 0x110, 0x200, 0x114, 0x1000);
  others.reset();
  stacks.jump(45, 0x114, 0x1000);
  EXPECT_EQ(other.clocks, (StackClocks{{{0x100}, 20}}));
  EXPECT_EQ(watched.clocks, (StackClocks{{{0x100}, 20}, {{0x100, 0x200}, 15}}));
}

// main (0x100) calls 0x200 from clock 30 to 45; the handler 0x300 interrupts it from 40 to 42.
TEST_F(StacksByHandTest, AWatcherSeesCallersAndWhatAnExceptionInterrupts) {
  stacks.call(30, 0x110, 0x200, 0x114, 0x1000);
  stacks.exception(40, 0x300, 0x220, 0xff0);
  stacks.exception_return(42, 0x220, 0xff0);
  stacks.jump(45, 0x114, 0x1000);
  stacks.count(50, false);
  EXPECT_EQ(watched.clocks, (StackClocks{{{0x100}, 25}, {{0x100, 0x200}, 13}, {{0x100, 0x200, 0x300}, 2}}));
  // Also where nothing is counted.
  stacks.call(60, 0x110, 0x200, 0x114, 0x1000);
  EXPECT_EQ(watched.clocks.at({0x100}), 35u);
}

// Exceptions of exceptions, calls and returns at random: what has changed, added up, is what is active.
TEST_F(StacksByHandTest, WhatHasChangedAddsUpToWhatIsActive) {
  std::mt19937 random(3);
  struct Place {
    std::uint32_t back, sp;
    bool exception;
  };
  std::vector<Place> places;
  std::uint32_t sp = 0x8000'0000;
  std::uint64_t clock = 20;
  for (unsigned n = 0; n < 20'000; ++n) {
    clock += random() % 5;
    const std::uint32_t from = 0x100 * (1 + random() % 3) + 4 * (random() % 32);
    const unsigned what = places.size() > 40 ? 2 : random() % (places.empty() ? 2 : 4);
    if (what == 0) {
      places.push_back({from + 4, sp, false});
      stacks.call(clock, from, 0x100 * (1 + random() % 3), from + 4, sp);
      sp -= 16;
    } else if (what == 1) {
      places.push_back({from, sp, true});
      stacks.exception(clock, 0x100 * (1 + random() % 3), from, sp);
    } else {
      const Place p = places.back();
      places.pop_back();
      sp = p.sp;
      p.exception ? stacks.exception_return(clock, p.back, sp) : stacks.jump(clock, p.back, sp);
    }
  }
  EXPECT_GT(watched.clocks.size(), 1'000u);
}

// A recursion of 200,000 activations and back: a watcher is told of each once, not of all at each branch.
TEST_F(StacksByHandTest, AWatcherOfADeepRecursionIsToldOfWhatChanges) {
  constexpr std::uint32_t kDeep = 200'000, kBase = 0x8000'0000;
  for (std::uint32_t n = 0; n < kDeep; ++n)
    stacks.call(30 + n, n ? 0x210 : 0x110, 0x200, n ? 0x214 : 0x114, kBase - 4 * n);
  for (std::uint32_t n = kDeep; n-- > 0;) stacks.jump(30 + 2 * kDeep - n, n ? 0x214 : 0x114, kBase - 4 * n);
  stacks.count(31 + 2 * kDeep, false);
  EXPECT_EQ(watched.changed, 1u + kDeep);
  EXPECT_EQ(watched.copy, std::vector<std::uint32_t>{0x100});
  EXPECT_EQ(watched.clocks.at({0x100}), 20u + 1u);
}

// main runs from 10 to 30 and from 45 on, 0x200 in between; the section changes at 35 and at 50, and 60 is the end.
TEST_F(StacksByHandTest, EachSectionHasItsClocksWhetherTheyAreCountedOrNot) {
  stacks.call(30, 0x110, 0x200, 0x114, 0x1000);
  stacks.enter(35, false, 7);
  stacks.jump(45, 0x114, 0x1000);
  stacks.enter(50, true, 0);
  stacks.count(60, false);
  const auto clocks_of = [this](std::size_t section) {
    return by_functions(stacks.paths_of(section));
  };
  EXPECT_EQ(clocks_of(7), (StackClocks{{{0x100, 0x200}, 10}, {{0x100}, 5}}));
  EXPECT_EQ(clocks_of(0), (StackClocks{{{0x100}, 30}, {{0x100, 0x200}, 5}}));
  const StackClocks counted = by_functions(stacks.paths());
  EXPECT_EQ(counted, clocks_of(0));
}

// 100,000 activations of a function are as many paths of one function each, not of 100,000.
TEST(CallStackTest, ADeepRecursionIsATree) {
  constexpr std::uint32_t kDeep = 100'000, kBase = 0x8000'0000;
  CallStacks stacks;
  stacks.set_functions({{0x100, 0x200}, {0x200, 0x300}});
  stacks.start(10, 0x100);
  stacks.count(10, true);
  for (std::uint32_t n = 0; n < kDeep; ++n)
    stacks.call(30 + n, n ? 0x210 : 0x110, 0x200, n ? 0x214 : 0x114, kBase - 4 * n);
  stacks.count(30 + kDeep, false);
  const auto paths = stacks.paths();
  std::uint64_t clocks = 0;
  std::uint32_t depth = 0;
  for (std::uint32_t n = 1; n < paths.size(); ++n) {
    EXPECT_LT(paths[n].caller, n);
    clocks += paths[n].clocks;
  }
  for (std::uint32_t n = static_cast<std::uint32_t>(paths.size()) - 1; n; n = paths[n].caller) ++depth;
  EXPECT_EQ(clocks, 20u + kDeep);
  EXPECT_EQ(depth, kDeep + 1);
}

// The clocks up to a reset belong to the function that it ended.
TEST_F(StacksByHandTest, AResetEndsWhatRanBefore) {
  stacks.call(30, 0x110, 0x200, 0x114, 0x1000);
  stacks.start(70, 0x300);
  stacks.count(100, false);
  const StackClocks counted = by_functions(stacks.paths());
  const StackClocks expected{{{0x100}, 20}, {{0x100, 0x200}, 40}, {{0x300}, 30}};
  EXPECT_EQ(counted, expected);
  EXPECT_EQ(watched.clocks, expected);
}

// Between the end of one function and the begin of the next there is none.
TEST(CallStackTest, AFunctionEndsBeforeItsEnd) {
  CallStacks stacks;
  stacks.set_functions({{0x10, 0x20}, {0x30, 0x40}});
  EXPECT_TRUE(stacks.same_function(0x1c, 0x10));
  EXPECT_FALSE(stacks.same_function(0x1c, 0x20));
  EXPECT_TRUE(stacks.same_function(0x20, 0x24)) << "both in no function";
  EXPECT_FALSE(stacks.same_function(0x30, 0x24));
}

}  // namespace
}  // namespace fovea::cpu::test
