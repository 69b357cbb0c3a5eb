// How far ahead of the kernel is too far: what happens at t is seen strictly after t
// (model/decisions/0001-time.md). Two acts that meet to the picosecond, each a pair by construction: the
// core's instruction boundary one picosecond behind an interrupt, and the crossbar's arbitration one
// picosecond behind a change of priority.
#include <gtest/gtest.h>

#include <cstring>
#include <memory>
#include <string>
#include <vector>

#include "model/bus/lookahead_initiator.h"
#include "model/common/burst_master.h"
#include "model/cpu/arm926.h"
#include "tb/iss/assembler.h"
#include "tb/sync/in_child.h"
#include "tb/sync/memory_system.h"
#include "tb/sync/reader.h"

namespace fovea::sync {
namespace {

/// Calls `act` once, at a kernel event at a time of its own.
class Alarm : public sc_core::sc_module {
 public:
  Alarm(sc_core::sc_module_name name, Picoseconds at, std::function<void()> act)
      : sc_module(name), act_(std::move(act)) {
    SC_HAS_PROCESS(Alarm);
    SC_METHOD(run);
    sensitive << due_.event();
    dont_initialize();
    due_.at(at);
  }

 private:
  void run() { act_(); }
  std::function<void()> act_;
  Timer due_;
};

constexpr std::uint32_t kRamBase = 0x1'0000, kRamSize = 0x8000;
constexpr Picoseconds kArmPeriod = 4000;  // 250 MHz, a whole number of picoseconds

const char* const kCounting = R"(
  b start
  .org 0x18
  svc #2
start:
  mov r8, #0
  msr cpsr_c, #0x13
1:
  .rept 4000
  add r8, r8, #1
  .endr
  b 1b
)";

/// The core counts instructions in r8 until the interrupt at `irq_at`; the answer is r8.
std::string instructions_before_interrupt(const cpu::test::Program& program, Picoseconds irq_at,
                                          bool strict) {
  bus::AddressMap map;
  map.ram_base = kRamBase;
  map.ram_size = kRamSize;
  cpu::CpuParams cpu_params;
  std::vector<std::uint8_t> ram(kRamSize);
  MemorySystem system(map, strict, Frequency(250'000'000), Frequency(125'000'000));
  cpu::Arm926 arm("arm", cpu_params, ram, 0);
  ClockSignal arm_clk{"arm_clk", Frequency(250'000'000)};
  sc_core::sc_signal<bool> irq{"irq"}, fiq{"fiq"};
  arm.clk(arm_clk);
  arm.irq(irq);
  arm.fiq(fiq);
  arm.path(system.scr.path);
  arm.sockets[cpu::Arm926::kInstructionPort]->bind(*system.scr.target[index(Master::kArmI)]);
  arm.sockets[cpu::Arm926::kDataPort]->bind(*system.scr.target[index(Master::kArmD)]);
  Alarm alarm("alarm", irq_at, [&irq] { irq.write(true); });
  std::memcpy(ram.data(), program.bytes.data(), program.bytes.size());
  std::string answer;
  const Subscription exit = arm.core().handle_swi([&answer](cpu::Core& c, std::uint32_t) {
    answer = std::to_string(c.reg(8));
    c.request_stop();
    return true;
  });
  sc_core::sc_start(ps_time(100 * kPsPerUs));
  return answer;
}

TEST(HorizonLimitTest, TheCoreSeesAnInterruptAtTheFirstBoundaryStrictlyBehindIt) {
  const auto program = cpu::test::assemble(kCounting, 0);
  const auto boundary = [&program](Picoseconds irq_at, bool strict, Picoseconds late) {
    const std::string answer =
        in_child(late, [&] { return instructions_before_interrupt(program, irq_at, strict); });
    return answer.empty() ? -1 : std::stol(answer);
  };
  unsigned boundaries = 0;
  for (unsigned k = 0; k < 12; ++k) {
    // Whole periods from time 0 on.
    const Picoseconds edge = 4 * kPsPerUs + k * kArmPeriod;
    const long before = boundary(edge - 1, true, 0), at = boundary(edge, true, 0);
    ASSERT_GT(before, 100);
    // An instruction boundary on this edge sees what happened a picosecond before it; what happens at the
    // edge itself is seen an instruction later.
    ASSERT_TRUE(at == before || at == before + 1) << before << " " << at;
    EXPECT_EQ(boundary(edge - 1, false, 0), before);
    EXPECT_EQ(boundary(edge, false, 0), at);
    if (at == before) continue;  // no boundary on this edge
    ++boundaries;
    EXPECT_EQ(boundary(edge - 1, false, 1), at) << "a horizon that is late by 1 ps is not found";
    // One picosecond further away that error has nothing to act on.
    EXPECT_EQ(boundary(edge - 2, false, 1), before);
    EXPECT_EQ(boundary(edge - 2, false, 2), at);
    EXPECT_EQ(boundary(edge, false, 1), at);
  }
  EXPECT_GE(boundaries, 3u);
}

constexpr Picoseconds kScrPeriod = 8000;  // 125 MHz
constexpr std::uint32_t kSdram = 0x8000'0000;

/// A reader of priority 1 and a DMA of priority 2 compete at one edge of the crossbar; the DMA gets
/// priority 0 `before` that edge. The answer is which is served first.
std::string winner(Picoseconds before, bool strict) {
  MemorySystem system({}, strict, Frequency(250'000'000), Frequency(125'000'000));
  const Picoseconds issue = 10 * kPsPerUs + 100;
  Reader reader("reader", kSdram, issue);
  BurstMaster dma("dma", Master::kEdmaTc0Read, 1);
  reader.path(system.scr.path);
  reader.sockets[0]->bind(*system.scr.target[index(Master::kEdmaTc1Read)]);
  dma.socket.bind(*system.scr.target[index(Master::kEdmaTc0Read)]);
  system.priority[index(Master::kEdmaTc1Read)].write(1);
  system.priority[index(Master::kEdmaTc0Read)].write(2);
  const auto& port = system.xbar_params.port(Master::kEdmaTc0Read);
  const Picoseconds arbitration =
      10 * kPsPerUs + kScrPeriod * (1 + static_cast<Picoseconds>(port.request_latency()));
  Picoseconds dma_first = 0;
  dma.on_done = [&dma_first](const BurstMaster::Completion& c) { dma_first = c.first; };
  Alarm begin("begin", issue, [&dma] { dma.read(kSdram + 0x10'0000, 16); });
  Alarm urgent("urgent", arbitration - before,
               [&system] { system.priority[index(Master::kEdmaTc0Read)].write(0); });
  sc_core::sc_start(ps_time(20 * kPsPerUs));
  if (!reader.first || !dma_first) return "no master";
  return reader.first < dma_first ? "reader" : "dma";
}

// The path stops at the horizon itself, although a decision at that very time would still be right: it
// sees nothing of what happens then. So the smallest error that can be seen is 2 ps.
TEST(HorizonLimitTest, AnArbitrationSeesThePriorityOfThePicosecondBefore) {
  const auto served = [](Picoseconds before, bool strict, Picoseconds late) {
    return in_child(late, [&] { return winner(before, strict); });
  };
  for (const bool strict : {true, false}) {
    EXPECT_EQ(served(1, strict, 0), "dma");
    EXPECT_EQ(served(0, strict, 0), "reader") << "decided with what was there before";
  }
  EXPECT_EQ(served(1, false, 1), "dma");
  EXPECT_EQ(served(1, false, 2), "reader") << "a horizon that is late by 2 ps is not found";
  EXPECT_EQ(served(2, false, 2), "dma");
  EXPECT_EQ(served(2, false, 3), "reader");
}

}  // namespace
}  // namespace fovea::sync

int sc_main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
