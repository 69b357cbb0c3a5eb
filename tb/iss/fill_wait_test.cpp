// Accesses that wait for a transfer under way: other lines, and the port after a change of the
// clock.
#include <algorithm>

#include "tb/iss/machine.h"

namespace fovea::cpu::test {
namespace {

/// A branch at the first word of a line under fill leaves it for a line that is there. The first
/// word takes 20 clocks and one into the core; the seven beats behind it take 14, the branch three
/// of them.
TEST(FillWaitTest, FetchFromAnotherLineWaitsForTheEndOfTheFill) {
  const auto waited = [](Picoseconds beat) {
    Machine m;
    m.port.beat = beat;
    std::vector<std::uint64_t> stalls;
    m.on_svc = [&](std::uint32_t) { stalls.push_back(m.stall(Cause::kIcache)); };
    m.execute(std::string(kCachesOn) + R"(
      b start
      .ltorg
      .balign 32
    start:
      mov r1, #0
      b target
    back:
      svc #3
      b far
      .balign 32
    far:
      b target
      .balign 32
    target:
      cmp r1, #1
      mov r1, #1
      bne back
      svc #3
    )",
              kMemory);
    return stalls.at(1) - stalls.at(0);
  };
  EXPECT_EQ(waited(0), 20u + 1);
  EXPECT_EQ(waited(8'000), 20u + 1 + 14 - 3);
}

/// A slow fill with words still to come when the clock becomes four times as fast.
struct FasterInAFill : Machine {
  Picoseconds fill_over = 0, begun = 0, seen = 0;
  /// @param change time; 0: it stays
  FasterInAFill(const std::string& then, Picoseconds change) {
    port.ahb_period = 0;
    port.beat = 80'000;
    core.set_clock(Frequency(125'000'000), 0);
    on_svc = [this](std::uint32_t n) { (n == 3 ? begun : seen) = core.boundary_time(); };
    if (change)
      port.schedule(change, [this, change] { core.set_clock(Frequency(500'000'000), change); });
    section(0x0800'0000, kMemory + 0x20'0000, 0, 0);
    execute(
        std::string(kCachesOn) +
        " ldr r5, =0x00110000\n ldr r6, =0x08000000\n ldr r0, [r6]\n ldr r0, [r5, #64]\n"
        ".rept 200\n mov r0, r0\n .endr\n svc #3\n ldr r0, [r5]\n .rept 30\n mov r2, r2\n .endr\n" +
        then + "\n svc #4\n");
    for (const BusRecord& r : port.log)
      if (r.address == 0x11'0000) fill_over = r.last;
  }
};

TEST(FillWaitTest, DataPortStaysBusyOverAChangeOfTheClock) {
  const char* const then = "ldr r1, [r6]";
  // 200 ns later the first word is there; the other seven take 560 ns from it on. The port itself
  // refuses a second transaction before the first is over.
  const FasterInAFill m(then, FasterInAFill(then, 0).begun + 200'000);
  ASSERT_GT(m.fill_over, 0u);
  EXPECT_GE(m.port.log.back().at, m.fill_over);
}

TEST(FillWaitTest, WordsOfAFillComeAtTheirTimeAfterAChangeOfTheClock) {
  const char* const then = "ldr r1, [r5, #28]\n add r1, r1, #1";
  const FasterInAFill m(then, FasterInAFill(then, 0).begun + 200'000);
  ASSERT_GT(m.fill_over, 0u);
  EXPECT_GE(m.seen, m.fill_over) << "the last word";
  EXPECT_LE(m.seen, m.fill_over + 20'000);
}

}  // namespace
}  // namespace fovea::cpu::test
