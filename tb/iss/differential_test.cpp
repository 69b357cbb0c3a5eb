// Compiled programs print the same on the core and under qemu-arm, with and without caches.
#include <chrono>
#include <iostream>
#include <iterator>
#include <sstream>

#include "tb/iss/machine.h"

namespace fovea::cpu::test {
namespace {

class DifferentialTest : public testing::TestWithParam<std::string> {};

void run_here(Machine& m, const std::string& name, bool caches) {
  const auto image = read_file(std::string(PROGRAM_DIR "/") + name + ".bin");
  std::memcpy(m.port.at(kMemory), image.data(), image.size());
  const auto elf = read_file(std::string(PROGRAM_DIR "/") + name + ".elf");
  std::uint32_t entry = 0;
  std::memcpy(&entry, elf.data() + 24, 4);  // e_entry
  const Program boot = assemble(std::string(caches ? kCachesOn : "") +
                                    " ldr r0, =" + std::to_string(entry) + "\n bx r0\n .ltorg\n",
                                0);
  m.load(boot);
  const auto begin = std::chrono::steady_clock::now();
  m.run();
  const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - begin;
  std::cout << name << (caches ? " cached " : " uncached ") << m.core.counts().instructions
            << " instructions, " << m.core.clock_count() << " clocks, "
            << static_cast<double>(m.core.counts().instructions) / wall.count() / 1e6 << " MIPS;";
  const Counts& n = m.core.counts();
  for (const std::uint64_t v :
       {n.issue, n.stall[0], n.stall[1], n.stall[2], n.stall[3], n.stall[4], n.stall[5], n.stall[9],
        n.icache_fills, n.dcache_reads, n.dcache_read_fills, n.dcache_writes, n.dcache_write_misses,
        n.dcache_writebacks})
    std::cout << ' ' << v;
  std::cout << '\n';
}

TEST_P(DifferentialTest, PrintsWhatQemuPrints) {
  const std::string want =
      output_of(QEMU_ARM " -cpu arm926 " PROGRAM_DIR "/" + GetParam() + ".elf");
  ASSERT_GT(want.size(), 90u);
  for (const bool caches : {true, false}) {
    if (!caches && !GetParam().ends_with("O2")) continue;  // slow, and the same instructions
    Machine m;
    run_here(m, GetParam(), caches);
    EXPECT_EQ(m.exit_status, 0);
    EXPECT_EQ(m.output, want);
  }
}
std::vector<std::string> programs() {
  std::istringstream in(PROGRAMS);
  return {std::istream_iterator<std::string>(in), {}};
}
INSTANTIATE_TEST_SUITE_P(Programs, DifferentialTest, testing::ValuesIn(programs()),
                         [](const auto& row) { return row.param; });

}  // namespace
}  // namespace fovea::cpu::test
