// Exceptions, modes, translation and CP15: the programs of system/ leave the same log here and on
// QEMU's versatilepb.
#include <gtest/gtest.h>

#include <iostream>

#include "tb/iss/system_log.h"
#include "tb/iss/system_machine.h"

namespace fovea::cpu::test {
namespace {

class SystemDifferentialTest : public testing::TestWithParam<std::string> {};

TEST_P(SystemDifferentialTest, LeavesWhatQemuLeaves) {
  const std::string stem = SYSTEM_DIR "/system_" + GetParam();
  const auto image = read_file(stem + ".bin");
  const auto want = parse_log(by_qemu_system(stem + ".elf"), image);
  for (const bool caches : {false, true}) {
    SystemMachine m;
    m.load(0, image);
    const auto got = parse_log(m.run(caches), image);
    const auto wrong = compare_logs(got, want);
    std::size_t entries = 0;
    for (const LogCase& c : got) entries += c.entries.size();
    std::cout << GetParam() << (caches ? " cached: " : " uncached: ") << got.size() - 1
              << " cases, " << entries << " entries, " << m.core.counts().instructions
              << " instructions\n";
    EXPECT_TRUE(wrong.empty()) << wrong.size() << " differences";
    for (std::size_t k = 0; k < wrong.size() && k < 40; ++k) ADD_FAILURE() << wrong[k].text();
  }
}
INSTANTIATE_TEST_SUITE_P(Programs, SystemDifferentialTest, testing::Values("exceptions"),
                         [](const auto& row) { return row.param; });

}  // namespace
}  // namespace fovea::cpu::test
