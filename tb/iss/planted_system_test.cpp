// Tests of MMU, caches, buffers and internal RAM on a copy of the core with a planted defect: for
// each defect of planted_system.h, the tests named there fail, and they pass without it.
#include "tb/iss/planted_system.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <iostream>
#include <string>

#include "tb/iss/planted.h"

int fovea_planted = 0;

namespace fovea::cpu::test {
namespace {

constexpr const char* kVariable = "FOVEA_PLANTED";

/// Runs tests of this program in a process of its own. @return its exit status
int run_tests(const std::string& filter, int planted) {
  std::cout.flush();
  const pid_t child = fork();
  if (child == 0) {
    setenv(kVariable, std::to_string(planted).c_str(), 1);
    const std::string argument = "--gtest_filter=" + filter;
    if (!std::freopen("/dev/null", "w", stdout)) _exit(126);
    execl("/proc/self/exe", "planted_system", argument.c_str(), nullptr);
    _exit(127);
  }
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

int run_all() {
  int failures = 0;
  if (run_tests("*", 0) != 0) {
    std::cout << "tests fail without a planted defect\n";
    return 1;
  }
  int number = static_cast<int>(std::size(kDefects) + std::size(kTimingDefects));
  for (const SystemDefect& d : kSystemDefects) {
    const int status = run_tests(d.tests, ++number);
    const bool noticed = status == 1;  // a failed expectation, no crash
    std::cout << d.what << (noticed ? ": noticed by " : ": NOT noticed by ") << d.tests
              << " (status " << status << ")\n";
    failures += !noticed;
  }
  return failures ? 1 : 0;
}

}  // namespace
}  // namespace fovea::cpu::test

int main(int argc, char** argv) {
  const char* planted = std::getenv(fovea::cpu::test::kVariable);
  if (!planted) return fovea::cpu::test::run_all();
  fovea_planted = std::atoi(planted);
  testing::InitGoogleTest(&argc, argv);
  const int status = RUN_ALL_TESTS();
  return testing::UnitTest::GetInstance()->test_to_run_count() ? status : 2;
}
