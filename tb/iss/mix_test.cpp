// Clocks per iteration of programs/mix.c from zero-wait internal RAM, printed next to the figure of
// ARM's FAQ ka3885 for Dhrystone 2.1 (1.1 DMIPS/MHz: 517 clocks). Program and compiler differ, so
// the figure only shows whether the magnitude is right and is not compared. The program's result
// is.
#include <cstring>
#include <iostream>

#include "tb/iss/machine.h"
#include "tb/iss/programs/mix.h"

namespace fovea::cpu::test {
namespace {

constexpr std::uint32_t kImage = 0x400;  ///< as linked

struct Ran {
  std::uint64_t clocks;
  std::uint32_t result;
};

Ran run_turns(std::uint32_t turns) {
  Machine m;
  const auto image = read_file(PROGRAM_DIR "/mix_zero_wait.bin");
  const auto elf = read_file(PROGRAM_DIR "/mix_zero_wait.elf");
  std::uint32_t entry = 0;
  std::memcpy(&entry, elf.data() + 24, 4);  // e_entry
  if (kImage + image.size() > m.tcm.size()) throw std::runtime_error("it does not fit");
  std::memcpy(m.tcm.data() + kImage, image.data(), image.size());
  m.execute(" ldr sp, =0x8000\n ldr r0, =" + std::to_string(turns) + "\n ldr r4, =" +
            std::to_string(entry) + "\n svc #1\n blx r4\n svc #1\n");
  return {m.between(), m.core.reg(0)};
}

TEST(MixTest, ComputesWhatTheHostComputes) {
  const Ran few = run_turns(100), many = run_turns(300);
  EXPECT_EQ(few.result, mix_run(100));
  EXPECT_EQ(many.result, mix_run(300));
  const double turn = static_cast<double>(many.clocks - few.clocks) / 200;
  const std::string version = output_of(ARM_PREFIX "gcc -dumpfullversion");
  std::cout << "Dhrystone-like mix, gcc " << version.substr(0, version.find('\n')) << ' '
            << MIX_FLAGS << ": " << turn << " clocks a turn (Dhrystone 2.1, ARM's compiler: 517)\n";
}

}  // namespace
}  // namespace fovea::cpu::test
