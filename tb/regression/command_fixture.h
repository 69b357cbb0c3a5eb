// Commands as a user gives them, on two small folders of results: `b` is slower than `a`.
#pragma once
#include <algorithm>
#include <sstream>
#include <string>
#include <vector>

#include "sw/fovea/cli/cli.h"
#include "tb/regression/run_maker.h"

namespace fovea::regression {

class RegressionCommandTest : public testing::Test {
 protected:
  RegressionCommandTest() : slow(profiled()) {
    a = profiled().write(dir, "a").string();
    slow.figure("frame.remap_time.mean", "0.0042", "s").figure("extra", "1");
    slow.profile.replace(slow.profile.find("vpbe,50"), 7, "vpbe,70");
    slow.profile.replace(slow.profile.find("capture,,,300"), 13, "capture,,,280");
    slow.figure("cpu.idle", "280", "cycles");
    b = slow.write(dir, "b").string();
    base = (dir / "base.yaml").string();
  }
  int cli(std::vector<std::string> args) {
    out.str("");
    err.str("");
    const int status = app::run_cli(args, {.out = out, .err = err});
    const std::string text = err.str();
    EXPECT_LE(std::count(text.begin(), text.end(), '\n'), 1) << text;
    return status;
  }
  test::TempDir dir;
  RunMaker slow;
  std::string a, b, base;
  std::ostringstream out, err;
};

}  // namespace fovea::regression
