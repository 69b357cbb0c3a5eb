// What the simulator remembers to save host time changes no result: it is forgotten at random instants, and every
// request has the same times, every picture the same bytes.
#include <gtest/gtest.h>

#include <memory>
#include <random>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "model/common/observers.h"
#include "model/common/sc_ports.h"
#include "tb/e2e/in_child.h"
#include "tb/e2e/rig.h"

namespace fovea::e2e {
namespace {

using Keys = std::vector<std::pair<std::string, std::string>>;

enum class When {
  kNever,
  kAtBoundaries,  ///< of one instruction in 50; the core executes them one by one
  kAtTimes,       ///< at random ones of the kernel, as others act; in the midst of an instruction, too
};

/// At an instruction boundary one time in 50.
class AtBoundaries : private cpu::BoundaryObserver {
 public:
  AtBoundaries(cpu::Core& core, std::uint64_t seed)
      : core_(core), rng_(seed), observing_(core.observe_boundaries(*this)) {}

 private:
  void at_boundary() override {
    if (rng_() % 50 == 0) core_.forget_for_a_test();
  }
  cpu::Core& core_;
  std::mt19937_64 rng_;
  Subscription observing_;
};

SC_MODULE(AtTimes) {
  AtTimes(sc_core::sc_module_name name, cpu::Core& of, std::uint64_t seed) : sc_module(name), core(of), rng(seed) {
    SC_HAS_PROCESS(AtTimes);
    SC_THREAD(forget);
  }
  void forget() {
    for (;;) {
      wait(static_cast<double>(1 + rng() % 4'000'000), sc_core::SC_PS);
      core.forget_for_a_test();
    }
  }
  cpu::Core& core;
  std::mt19937_64 rng;
};

/// All requests on the crossbar with their times, in no order: which outcome is told first depends on how far ahead
/// the core is.
struct Requests : MemObserver {
  void submitted(const MemRequest&, bool) override {}
  void responded(const MemRequest& r) override { note(r); }
  void register_done(const MemRequest& r) override { note(r); }
  void note(const MemRequest& r) {
    std::uint64_t h = 0xCBF2'9CE4'8422'2325u;
    for (const std::uint64_t v : {std::uint64_t{index(r.master)}, std::uint64_t{r.write}, std::uint64_t{r.address},
                                  std::uint64_t{r.bytes}, r.issued, r.first, r.last})
      h = (h ^ v) * 0x100'0000'01B3u;
    all.emplace_back(r.issued, h);
  }
  /// Their number, and a sum, of those that were issued before `end`.
  std::string until(Picoseconds end) const {
    std::uint64_t n = 0, sum = 0;
    for (const auto& [at, h] : all)
      if (at < end) ++n, sum += h;
    return std::to_string(n) + " requests " + std::to_string(sum);
  }
  std::vector<std::pair<Picoseconds, std::uint64_t>> all;
};

std::string board_says(const std::string& experiment, const Keys& keys, When when, bool strict, std::uint64_t seed) {
  Rig rig;
  rig.load(experiment);
  for (const auto& [key, value] : keys) rig.set(key, value);
  if (strict) rig.strict();
  board::Board& board = rig.build();
  cpu::Core& core = board.dm365.arm.core();
  Requests requests;
  const Subscription observing = board.dm365.scr.crossbar().observe(requests);
  std::unique_ptr<AtBoundaries> at_boundaries;
  std::unique_ptr<AtTimes> at_times;
  if (when == When::kAtBoundaries) at_boundaries = std::make_unique<AtBoundaries>(core, seed);
  if (when == When::kAtTimes) at_times = std::make_unique<AtTimes>("at_times", core, seed);
  rig.run(kLimit);
  std::ostringstream out;
  out << requests.until(kernel_time() - 20 * kPsPerUs) << '\n' << board.dm365.arm.failure() << '\n';
  for (const Shown& s : rig.shown()) {
    std::uint64_t h = 0;
    for (const std::uint8_t b : s.frame.uyvy) h = (h ^ b) * 0x100'0000'01B3u;
    const video::FrameTimes& r = s.record;
    out << r.remap_start.value_or(0) << ' ' << r.remap_end.value_or(0) << ' ' << r.display_start << ' ';
    out << h << '\n';
  }
  return out.str();
}

void expect_nothing_changes(const std::string& experiment, const Keys& keys, const std::vector<std::uint64_t>& seeds) {
  const auto says = [&](When when, bool strict, std::uint64_t seed) {
    return test::in_child([&] { return board_says(experiment, keys, when, strict, seed); });
  };
  const std::string remembered = says(When::kNever, false, 0);
  EXPECT_GT(remembered.size(), 80u) << remembered;
  for (const std::uint64_t seed : seeds)
    for (const bool strict : {false, true}) {
      SCOPED_TRACE("seed " + std::to_string(seed) + (strict ? ", strict" : ""));
      EXPECT_EQ(says(When::kAtBoundaries, strict, seed), remembered) << "at boundaries";
      EXPECT_EQ(says(When::kAtTimes, strict, seed), remembered) << "at times";
    }
}

constexpr std::uint64_t kSeed = 20261130;

// A small I-cache is filled again and again while bursts of the EDMA drop lines.
TEST(ForgetTest, ASmallInstructionCacheIsFilledInTheSameTime) {
  expect_nothing_changes("default.yaml",
                         {{"cpu.icache.size", "4KiB"},
                          {"run.frames", "1"},
                          {"video.width", "188"},
                          {"video.height", "48"}},
                         {kSeed});
}

class NightlyForgetTest : public testing::TestWithParam<const char*> {};
TEST_P(NightlyForgetTest, NoExperimentChanges) {
  expect_nothing_changes(GetParam(), {{"run.frames", "1"}}, {kSeed, kSeed + 1});
}
INSTANTIATE_TEST_SUITE_P(Experiments, NightlyForgetTest,
                         testing::Values("default.yaml", "evm.yaml", "lines.yaml", "paper-pal.yaml", "paper-vga.yaml",
                                         "throughput.yaml"));

}  // namespace
}  // namespace fovea::e2e
