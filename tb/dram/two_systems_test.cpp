// Two memory systems in one process: each warns its own Diagnostics, whatever is current.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <string>
#include <vector>

#include "tb/dram/path.h"
#include "tb/own_diagnostics.h"

namespace fovea::dram {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Pair;
using Kind = Diagnostics::Kind;

const auto kPostponed = Pair(Kind::kGuest, HasSubstr("more refreshes of the SDRAM are postponed"));

/// Three masters that always have four reads of one row under way, for which refreshes are put off.
struct Reads {
  static constexpr std::array kMasters{Master::kVpfe, Master::kVpbe, Master::kLoad};
  struct Slot {
    PathRequest request;
    std::array<std::uint8_t, 64> data{};
  };
  Path& path;
  std::array<std::array<Slot, 4>, kMasters.size()> slots;
  explicit Reads(Path& p) : path(p) {
    for (std::size_t m = 0; m < kMasters.size(); ++m)
      for (Slot& s : slots[m]) {
        s.request.master = kMasters[m];
        s.request.bytes = 64;
        s.request.data = s.data.data();
        path.submit(s.request, 0);
      }
  }
  /// Until `end`, without a pause.
  void go_on(Picoseconds end) {
    while (path.next_decision() < end) {
      const Picoseconds now = path.next_decision();
      path.step();
      for (auto& of_master : slots)
        for (Slot& s : of_master)
          if (s.request.responses) {
            s.request.responses = 0;
            path.submit(s.request, now + 1);
          }
    }
  }
};

/// One read in ten microseconds, so that each refresh comes in time.
void read_now_and_then(Path& path, Picoseconds from, Picoseconds end) {
  for (Picoseconds at = from; at < end; at += 10 * kPsPerUs) {
    std::array<std::uint8_t, 64> data{};
    PathRequest r;
    r.master = Master::kVpfe;
    r.bytes = 64;
    r.data = data.data();
    path.run_before(at);
    path.submit(r, at);
    path.drain();
  }
}

constexpr Picoseconds kSpan = 50 * kPsPerUs;
constexpr unsigned kSpans = 8;

/// The warnings of a system that is busy for all spans.
Diagnostics::Counts alone() {
  Path path;
  Reads reads(path);
  for (unsigned n = 0; n < kSpans; ++n) reads.go_on((n + 1) * kSpan);
  EXPECT_THAT(path.diagnostics.counts(), ElementsAre(Pair(kPostponed, testing::Gt(1u))));
  return path.diagnostics.counts();
}

TEST(TwoMemorySystemsTest, DoNotShareTheirWarnings) {
  const Diagnostics::Counts expected = alone();
  Path busy, calm;
  Reads reads(busy);
  std::vector<std::string> heard, heard_of_calm;
  busy.diagnostics.set_sink([&](Kind, const std::string& what) { heard.push_back(what); });
  calm.diagnostics.set_sink([&](Kind, const std::string& what) { heard_of_calm.push_back(what); });
  for (unsigned n = 0; n < kSpans; ++n) {
    reads.go_on((n + 1) * kSpan);
    read_now_and_then(calm, n * kSpan + kPsPerUs, (n + 1) * kSpan);
  }
  EXPECT_EQ(busy.diagnostics.counts(), expected) << "as many as without the other one";
  EXPECT_THAT(heard, ElementsAre(HasSubstr("are postponed"))) << "one text, shown once";
  EXPECT_THAT(calm.diagnostics.counts(), IsEmpty());
  EXPECT_THAT(heard_of_calm, IsEmpty());
}

TEST(TwoMemorySystemsTest, BothCountTheSameText) {
  const Diagnostics::Counts expected = alone();
  Path one, other;
  Reads reads(one), others(other);
  for (unsigned n = 0; n < kSpans; ++n) {
    reads.go_on((n + 1) * kSpan);
    others.go_on((n + 1) * kSpan);
  }
  EXPECT_EQ(one.diagnostics.counts(), expected);
  EXPECT_EQ(other.diagnostics.counts(), expected);
}

TEST(TwoMemorySystemsTest, WhatIsHandedCountsAndNotWhatIsCurrent) {
  const Diagnostics::Counts expected = alone();
  OwnDiagnostics current;
  Path path;
  Reads reads(path);
  reads.go_on(kSpans * kSpan);
  EXPECT_EQ(path.diagnostics.counts(), expected);
  EXPECT_THAT(current.counts(), IsEmpty());
}

}  // namespace
}  // namespace fovea::dram
