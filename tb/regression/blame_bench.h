// Two runs with profiles, and the difference of their clocks.
#pragma once
#include <gtest/gtest.h>

#include <string>

#include "sw/fovea/compare/blame.h"
#include "tb/regression/run_maker.h"

namespace fovea::regression {

inline void replace(std::string& text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  ASSERT_NE(at, text.npos) << from;
  text.replace(at, from.size(), to);
}

class BlameBench : public testing::Test {
 protected:
  BlameBench() : before(profiled()), after(profiled()) {}
  Difference difference(bool profile = true) {
    a = read_run(before.write(dir, "a"));
    b = read_run(after.write(dir, "b"));
    return difference_of(attribution_of(a, profile), attribution_of(b, profile), circumstances_of(a, b));
  }
  test::TempDir dir;
  RunMaker before, after;
  RunFigures a, b;
};

}  // namespace fovea::regression
