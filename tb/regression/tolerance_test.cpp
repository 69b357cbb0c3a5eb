// Limits of tolerances: each at n and beyond, both directions, absolute and relative.
#include "sw/fovea/compare/tolerance.h"

#include <cmath>

#include "tb/unit/support.h"

namespace fovea::regression {
namespace {

using test::user_error;
using testing::HasSubstr;
constexpr auto kWithin = Deviation::kWithin;
constexpr auto kHigher = Deviation::kHigher;
constexpr auto kLower = Deviation::kLower;

TEST(ToleranceTest, ZeroDemandsTheSameNumber) {
  EXPECT_EQ(deviation_of(100, 100, {}, true), kWithin);
  EXPECT_EQ(deviation_of(101, 100, {}, true), kHigher);
  EXPECT_EQ(deviation_of(99, 100, {}, true), kLower);
  EXPECT_EQ(deviation_of(0.004, 0.004, {}, false), kWithin);
  EXPECT_EQ(deviation_of(std::nextafter(0.004, 1), 0.004, {}, false), kHigher);
  EXPECT_EQ(deviation_of(std::nextafter(0.004, 0), 0.004, {}, false), kLower);
}

TEST(ToleranceTest, TheTextHasTheFiguresUnit) {
  const Tolerance both{2.5, 0.01};
  EXPECT_EQ(both.text("MB/s"), "1.0 % or 2.5 MB/s");
  for (const char* unit : {"", "1", "ratio"}) EXPECT_EQ(both.text(unit), "1.0 % or 2.5");
}

TEST(ToleranceTest, AbsoluteLimitIsStillWithin) {
  const Tolerance t{5, 0};
  EXPECT_EQ(deviation_of(105, 100, t, true), kWithin);
  EXPECT_EQ(deviation_of(106, 100, t, true), kHigher);
  EXPECT_EQ(deviation_of(95, 100, t, true), kWithin);
  EXPECT_EQ(deviation_of(94, 100, t, true), kLower);
  EXPECT_EQ(deviation_of(-105, -100, t, true), kWithin);
  EXPECT_EQ(deviation_of(-106, -100, t, true), kLower);
}

TEST(ToleranceTest, RelativeLimitIsAShareOfTheExpectedValue) {
  const Tolerance t{0, 0.01};
  EXPECT_EQ(deviation_of(1010, 1000, t, true), kWithin);
  EXPECT_EQ(deviation_of(1011, 1000, t, true), kHigher);
  EXPECT_EQ(deviation_of(990, 1000, t, true), kWithin);
  EXPECT_EQ(deviation_of(989, 1000, t, true), kLower);
  // Of the expected value, not of the larger one: 1 % of 1,010 would allow 1,000 here.
  EXPECT_EQ(deviation_of(1000, 1011, t, true), kLower);
  EXPECT_EQ(deviation_of(-1011, -1000, t, true), kLower);
  EXPECT_EQ(deviation_of(1, 0, t, true), kHigher) << "no share of nothing";
}

TEST(ToleranceTest, TheLargerOfBothCounts) {
  const Tolerance t{5, 0.01};
  EXPECT_EQ(deviation_of(105, 100, t, true), kWithin);   // 5, not 1
  EXPECT_EQ(deviation_of(106, 100, t, true), kHigher);
  EXPECT_EQ(deviation_of(1010, 1000, t, true), kWithin); // 10, not 5
  EXPECT_EQ(deviation_of(1011, 1000, t, true), kHigher);
}

TEST(ToleranceTest, DecimalsAtTheLimitAreWithinThoughTheyRound) {
  // 0.33 - 0.3 is 0.030000000000000027 in double precision.
  EXPECT_EQ(deviation_of(0.33, 0.3, {0, 0.1}, false), kWithin);
  EXPECT_EQ(deviation_of(0.27, 0.3, {0, 0.1}, false), kWithin);
  EXPECT_EQ(deviation_of(0.330000001, 0.3, {0, 0.1}, false), kHigher);
  EXPECT_EQ(deviation_of(0.269999999, 0.3, {0, 0.1}, false), kLower);
  // Counts have no rounding: 2^52 and one more.
  EXPECT_EQ(deviation_of(4503599627370506, 4503599627370496, {10, 0}, true), kWithin);
  EXPECT_EQ(deviation_of(4503599627370507, 4503599627370496, {10, 0}, true), kHigher);
}

TEST(ToleranceTest, IsReadInAllForms) {
  const auto both = [](const char* text) {
    const Tolerance t = parse_tolerance(text, "x");
    return std::pair(t.absolute, t.relative);
  };
  EXPECT_EQ(both("1%"), std::pair(0.0, 0.01));
  EXPECT_EQ(both("2"), std::pair(2.0, 0.0));
  EXPECT_EQ(both("1% or 2e-6"), std::pair(2e-6, 0.01));
  EXPECT_EQ(both("2 or 0.5 %"), std::pair(2.0, 0.005));
  EXPECT_EQ(both("0"), std::pair(0.0, 0.0));
  for (const char* wrong : {"", "x", "-1", "-1%", "1% or 2%", "1 or 2", "inf", "nan", "1%%", "1 2", "1% and 2"})
    EXPECT_THAT(user_error([&] { parse_tolerance(wrong, "f.yaml:3"); }),
                testing::AllOf(HasSubstr("f.yaml:3"), HasSubstr("allowed"))) << wrong;
}

}  // namespace
}  // namespace fovea::regression
