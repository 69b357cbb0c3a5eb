// After each access that may make a block act, the core asks again how far it may run ahead.
#include "tb/iss/vectors.h"

namespace fovea::cpu::test {
namespace {

constexpr std::uint32_t kBlock = kMemory + 0x00E0'0000;  // a register block's addresses

/// Memory, and a register block that does something a while after it was written or read.
class BlockPort : public FlatPort {
 public:
  using FlatPort::FlatPort;
  std::function<void(Picoseconds)> on_access;  ///< with the time of its outcome
  bool tells = true;                           ///< what is to be shown: false is the planted defect

  void submit(BusAccess& a, Picoseconds t) override {
    const bool block = a.address >= kBlock && a.address < kBlock + 0x1000;
    a.outside = block && tells;
    FlatPort::submit(a, t);
    if (block && on_access) on_access(a.write ? a.last : a.first);
  }
};
using BlockMachine = MachineWith<BlockPort>;

constexpr unsigned kSled = 200;
/// Interrupts open, an access of the block, three clocks, and a sled of one clock each.
std::string program(const std::string& before, const std::string& access, const std::string& three) {
  std::string text = kVectors + before + "ldr r4, =" + std::to_string(kBlock) +
                     "\n msr cpsr_c, #0x1f\n" + access + "\n" + three + "\n sled:\n";
  for (unsigned k = 0; k < kSled; ++k) text += "mov r5, #" + std::to_string(k) + "\n";
  return text;
}

/// Before which instruction of the sled the interrupt is taken. The block raises IRQ at `at`, which it
/// learns when it is accessed.
std::uint32_t run(const std::string& text, Picoseconds at, Picoseconds others_every,
                  bool tells = true) {
  BlockMachine m;
  m.port.tells = tells;
  m.on_svc = [&](std::uint32_t n) {
    if (n == 4) m.core.set_irq(false, m.time());
  };
  m.port.on_access = [&](Picoseconds) {
    m.port.on_access = {};
    m.port.schedule(at, [&m, at] {
      m.core.set_irq(true, at);
      m.port.interrupt_at(at);
    });
  };
  if (others_every)
    for (Picoseconds t = others_every; t < 2 * at; t += others_every) m.port.schedule(t, [] {});
  m.execute(text);
  const auto t = taken(m);
  return t.empty() ? ~0u : (t[0].lr - 4 - m.program.symbols.at("sled")) / 4;
}

class HorizonTest : public testing::Test {
 protected:
  struct Case {
    std::string name, before, access;
  };
  const std::vector<Case> cases = {
      {"a store", "", "str r0, [r4]"},
      {"a load", "", "ldr r0, [r4]"},
      {"a swap", "", "swp r0, r0, [r4]"},
      {"several words", "", "stmia r4, {r0-r3}"},
      // The page with the block is cached by the identity map: C = 0, B = 1 makes it buffered.
      {"a buffered store",
       "ldr r1, =" + std::to_string(kTables + 4 * (kBlock >> 20)) +
           "\n ldr r0, [r1]\n bic r0, r0, #8\n str r0, [r1]\n" + kCachesOn,
       "str r0, [r4]"},
  };
  /// The clock at which the sled's first instruction begins.
  static std::uint64_t sled_begins(const Case& c) {
    BlockMachine m;
    m.execute(program(c.before, c.access, "svc #1"));
    return m.marks.at(0) + 3;
  }
};

TEST_F(HorizonTest, WhatAnAccessBringsAboutIsSeenInTime) {
  for (const Case& c : cases) {
    const std::uint64_t begin = sled_begins(c);
    const std::string text = program(c.before, c.access, "mov r1, r1\n mov r1, r1\n mov r1, r1");
    for (const unsigned n : {20u, 21u, 57u, 150u}) {
      const Picoseconds at = (begin + n) * BlockMachine::kClock;
      // Seen by the first instruction that begins strictly after it, whatever else is pending.
      EXPECT_EQ(run(text, at, 0), n + 1) << c.name;
      EXPECT_EQ(run(text, at, 10 * BlockMachine::kClock), n + 1) << c.name;
      EXPECT_EQ(run(text, at - 1, 0), n) << c.name;
    }
  }
}

/// The port that does not say so shows what the test above would look like.
TEST_F(HorizonTest, APortThatDoesNotTellIsLate) {
  for (const Case& c : cases) {
    const std::uint64_t begin = sled_begins(c);
    const std::string text = program(c.before, c.access, "mov r1, r1\n mov r1, r1\n mov r1, r1");
    EXPECT_GT(run(text, (begin + 20) * BlockMachine::kClock, 0, false), 21u) << c.name;
  }
}

}  // namespace
}  // namespace fovea::cpu::test
