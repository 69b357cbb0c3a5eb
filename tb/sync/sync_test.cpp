// Strict and default synchronisation give the same record of everything observable. A planted late
// horizon shows that the comparison can fail.
#include <gtest/gtest.h>
#include <cstdlib>
#include <fstream>
#include <string>

#include "tb/sync/in_child.h"
#include "tb/sync/traffic.h"

namespace fovea::sync {
namespace {

/// Programs `seed` and on, in a process of their own.
Outcome programs(std::uint64_t seed, unsigned count, bool strict, Picoseconds late) {
  const std::string all = in_child(late, [&] {
    const Outcome o = run_programs(seed, count, strict);
    return std::to_string(o.direct) + " " + std::to_string(o.queued) + "\n" + o.record;
  });
  Outcome o;
  if (all.empty()) return o;
  char* end = nullptr;
  o.direct = std::strtoull(all.c_str(), &end, 10);
  o.queued = std::strtoull(end, &end, 10);
  o.record = all.substr(all.find('\n') + 1);
  return o;
}

constexpr unsigned kPrograms = 1200;
constexpr unsigned kPerProcess = 200;

TEST(TimeRuleTest, RandomProgramsAreIdenticalInStrictAndDefaultMode) {
  std::uint64_t direct = 0, queued = 0;
  for (unsigned i = 0; i < kPrograms; i += kPerProcess) {
    const Outcome strict = programs(1 + i, kPerProcess, true, 0);
    const Outcome fast = programs(1 + i, kPerProcess, false, 0);
    ASSERT_GT(strict.record.size(), 1000u);
    ASSERT_EQ(strict.record.find("did not finish"), std::string::npos);
    for (const char* what : {" stream r ", " stream w ", " dma r ", " irq", " tc2 ends 8", " tc3 ends 8",
                             " tc2 ends 0001", " tc3 ends 0001", " to 0001"})
      ASSERT_NE(strict.record.find(what), std::string::npos) << what;
    if (const char* folder = std::getenv("FOVEA_SYNC_DUMP"); folder && strict.record != fast.record) {
      std::ofstream(std::string(folder) + "/strict.txt") << strict.record;
      std::ofstream(std::string(folder) + "/default.txt") << fast.record;
    }
    ASSERT_TRUE(strict.record == fast.record)
        << "seeds " << 1 + i << ".." << i + kPerProcess << "\n"
        << first_difference(strict.record, fast.record);
    EXPECT_EQ(strict.direct, 0u) << "strict must not decide ahead of the kernel";
    EXPECT_EQ(strict.queued, fast.direct + fast.queued);
    direct += fast.direct;
    queued += fast.queued;
  }
  std::printf("%u programs identical; default mode: %llu direct, %llu queued accesses\n", kPrograms,
              static_cast<unsigned long long>(direct), static_cast<unsigned long long>(queued));
  EXPECT_GT(direct, 1000u) << "the direct path was never taken: nothing was compared";
}

TEST(TimeRuleTest, RunsAreReproducible) {
  const Outcome first = programs(7, 50, false, 0);
  ASSERT_GT(first.record.size(), 1000u);
  EXPECT_TRUE(first.record == programs(7, 50, false, 0).record);
}

TEST(TimeRuleTest, AHorizonThatIsLateByOnePicosecondIsFound) {
  const Outcome strict = programs(1, kPerProcess, true, 0);
  ASSERT_GT(strict.record.size(), 1000u);
  for (const Picoseconds late : {Picoseconds{1}, 200 * kPsPerNs}) {
    const Outcome wrong = programs(1, kPerProcess, false, late);
    ASSERT_GT(wrong.record.size(), 1000u) << "the late run must run";
    EXPECT_FALSE(strict.record == wrong.record) << late << " ps: the comparison cannot fail";
  }
}

}  // namespace
}  // namespace fovea::sync

int sc_main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
