// Strict and default synchronisation give the same record of everything observable; a planted late
// horizon shows that the comparison can fail.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <string>

#include "tb/sync/traffic.h"

namespace fovea::sync {
namespace {

/// A second elaboration in one process fails, so each run gets a child process.
Outcome in_child(std::uint64_t seed, unsigned programs, bool strict, Picoseconds late) {
  int fd[2];
  if (pipe(fd) != 0) return {};
  const pid_t pid = fork();
  if (pid == 0) {
    close(fd[0]);
    Outcome o;
    try {
      o = run_programs(seed, programs, strict, late);
    } catch (const std::exception& e) {
      std::fprintf(stderr, "%s\n", e.what());
      _exit(1);
    }
    std::string all = std::to_string(o.direct) + " " + std::to_string(o.queued) + "\n" + o.record;
    for (std::size_t at = 0; at < all.size();) {
      const ssize_t n = write(fd[1], all.data() + at, all.size() - at);
      if (n <= 0) _exit(1);
      at += static_cast<std::size_t>(n);
    }
    _exit(0);
  }
  close(fd[1]);
  std::string all;
  char buffer[65536];
  for (ssize_t n; (n = read(fd[0], buffer, sizeof buffer)) > 0;)
    all.append(buffer, static_cast<std::size_t>(n));
  close(fd[0]);
  int status = 0;
  waitpid(pid, &status, 0);
  Outcome o;
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) return o;
  char* end = nullptr;
  o.direct = std::strtoull(all.c_str(), &end, 10);
  o.queued = std::strtoull(end, &end, 10);
  o.record = all.substr(all.find('\n') + 1);
  return o;
}

std::string first_difference(const std::string& a, const std::string& b) {
  std::size_t line = 0;
  while (line < a.size() && line < b.size()) {
    const std::size_t ea = a.find('\n', line), eb = b.find('\n', line);
    if (a.substr(line, ea - line) != b.substr(line, eb - line))
      return "strict:  " + a.substr(line, ea - line) + "\ndefault: " + b.substr(line, eb - line);
    line = ea + 1;
  }
  return a.size() == b.size() ? "" : "one record is longer";
}

constexpr unsigned kPrograms = 1200;
constexpr unsigned kPerProcess = 200;

TEST(TimeRuleTest, RandomProgramsAreIdenticalInStrictAndDefaultMode) {
  std::uint64_t direct = 0, queued = 0;
  for (unsigned i = 0; i < kPrograms; i += kPerProcess) {
    const Outcome strict = in_child(1 + i, kPerProcess, true, 0);
    const Outcome fast = in_child(1 + i, kPerProcess, false, 0);
    ASSERT_GT(strict.record.size(), 1000u);
    ASSERT_EQ(strict.record.find("did not finish"), std::string::npos);
    for (const char* what : {" stream r ", " stream w ", " dma r ", " irq"})
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
  const Outcome first = in_child(7, 50, false, 0);
  ASSERT_GT(first.record.size(), 1000u);
  EXPECT_TRUE(first.record == in_child(7, 50, false, 0).record);
}

TEST(TimeRuleTest, PlantedLateHorizonIsFound) {
  const Outcome strict = in_child(1, 100, true, 0);
  ASSERT_GT(strict.record.size(), 1000u);
  const Outcome late = in_child(1, 100, false, 200 * kPsPerNs);
  ASSERT_GT(late.record.size(), 1000u) << "the late run must run";
  EXPECT_FALSE(strict.record == late.record) << "the comparison cannot fail";
}

}  // namespace
}  // namespace fovea::sync

int sc_main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
