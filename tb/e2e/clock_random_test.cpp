// Random programs that change their own clock, wait and sleep. Neither the synchronisation mode nor
// the length of the host's time slices may change the time of anything they do.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <random>
#include <systemc>

#include "tb/e2e/rig.h"
#include "tb/iss/assembler.h"

namespace fovea::e2e {
namespace {

constexpr std::uint32_t kLast = 0x8000;  // pins of a program that has come to its end

std::string random_program(std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const auto below = [&](unsigned n) { return static_cast<unsigned>(random() % n); };
  const auto nops = [&](unsigned n) {
    std::string text;
    for (unsigned k = below(n); k > 0; --k) text += "mov r2, r2\n";
    return text;
  };
  // PLLC1 from PLLCTL on, TIMER0, AINTC with the alarm's source on; interrupts stay masked.
  std::string text = ".include \"" PROGRAM_SOURCES R"(/pins.inc"
    open_pins
    ldr r5, =0x01C40900
    ldr r6, =0x01C21400
    ldr r8, =0x01C48000
    mov r0, #2
    str r0, [r8, #0x1c]
    mov r1, #1
    mov r7, #0
    mov r9, #0x4000
)";
  for (unsigned step = 0; step < 60; ++step) {
    switch (below(6)) {
      case 0:  // PLLDIV2 and GOSET
        text += "ldr r0, =" + std::to_string(0x8000u | below(16)) +
                "\n str r0, [r5, #0x1c]\n str r1, [r5, #0x38]\n" + nops(4);
        break;
      case 1: text += nops(16); break;
      case 2: text += "add r7, r7, #1\n str r7, [r4, #4]\n"; break;
      case 3: text += "1: ldr r0, [r5, #0x3c]\n tst r0, #1\n bne 1b\n"; break;
      case 4:  // an alarm, and asleep until then
        text += "mov r0, #0\n str r0, [r6, #0x20]\n str r0, [r6, #0x14]\n ldr r0, =" +
                std::to_string(1 + below(400)) +
                "\n str r0, [r6, #0x1c]\n mov r0, #6\n str r0, [r6, #0x24]\n mov r0, #0x400000\n"
                " str r0, [r6, #0x20]\n" + nops(6) +
                "mov r0, #0\n mcr p15, 0, r0, c7, c0, 4\n mov r0, #2\n str r0, [r8, #0x0c]\n";
        break;
      default:  // several clocks each
        text += "mul r3, r7, r1\n stmia r9, {r0-r3}\n ldmia r9, {r2, r3}\n smull r2, r3, r7, r7\n";
    }
    if (step % 20 == 19) text += "b 2f\n .ltorg\n 2:\n";
  }
  return text + "ldr r7, =" + std::to_string(kLast) + "\n str r7, [r4, #4]\n 3: b 3b\n .ltorg\n";
}

struct Shown {
  std::uint32_t pins;
  Picoseconds at;
  bool operator==(const Shown&) const = default;
};

/// What the pins show, in a process of its own: a simulation elaborates once.
std::vector<Shown> run(const cpu::test::Program& program, bool strict, Picoseconds look) {
  int ends[2];
  EXPECT_EQ(::pipe(ends), 0);
  const pid_t child = ::fork();
  if (child == 0) {
    Rig rig(PROGRAM_DIR "/idle_loop.elf");
    if (strict) rig.strict();
    auto& board = rig.build();
    board.load({0, program.bytes});
    bool over = false, ok = true;
    const Subscription pins = board.dm365.gpio.observe_outputs([&](unsigned bank, std::uint32_t out, Picoseconds at) {
      if (bank != 2) return;
      const Shown s{out, at};
      ok &= ::write(ends[1], &s, sizeof s) == sizeof s;
      over = out == kLast;
    });
    while (!over && kernel_time() < 50 * kPsPerMs) rig.advance(look);
    ::_exit(ok && over ? 0 : 1);
  }
  ::close(ends[1]);
  std::vector<Shown> out;
  for (Shown s; ::read(ends[0], &s, sizeof s) == sizeof s;) out.push_back(s);
  ::close(ends[0]);
  int status = 0;
  ::waitpid(child, &status, 0);
  EXPECT_EQ(status, 0) << "the program does not end";
  return out;
}

TEST(ClockRandomTest, NoObserverChangesTheTime) {
  const char* given = std::getenv("FOVEA_SEED");
  const std::uint64_t first = given ? std::strtoull(given, nullptr, 0) : 1;
  unsigned shown = 0;
  for (std::uint64_t seed = first; seed < first + (given ? 1 : 24); ++seed) {
    SCOPED_TRACE("FOVEA_SEED=" + std::to_string(seed));
    const auto program = cpu::test::assemble(random_program(seed), 0);
    const auto usual = run(program, false, kPsPerMs);
    shown += static_cast<unsigned>(usual.size());
    EXPECT_EQ(usual, run(program, true, kPsPerMs)) << "strict";
    EXPECT_EQ(usual, run(program, false, 1'700'000)) << "a look every 1.7 us";
    if (HasFailure()) break;
  }
  if (!given) {
    EXPECT_GT(shown, 100u);
  }
}

}  // namespace
}  // namespace fovea::e2e

int sc_main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
