// The firmware's remap methods on the board: the displayed pictures are those of the look-up table,
// and the UART names the method that a lens allows. CTest runs each case in its own process.
#include <gtest/gtest.h>

#include <algorithm>
#include <systemc>

#include "tb/e2e/expectations.h"
#include "tb/e2e/rig.h"

namespace fovea::e2e {
namespace {

/// The lines of the UART's text that begin with "kernel".
std::string kernel_lines(Rig& rig) {
  const std::string text = rig.board().uart_text();
  std::string lines;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find("\r\n", at), text.size());
    if (text.compare(at, 6, "kernel") == 0) lines += text.substr(at, end - at) + "\n";
    at = end + 2;
  }
  return lines;
}

/// True if the last line about kernels names this method.
bool is_chosen(Rig& rig, const std::string& method) {
  const std::string lines = kernel_lines(rig);
  const std::size_t at = lines.rfind("kernel: ");
  if (at == std::string::npos) return false;
  const std::string line = lines.substr(at + 8);
  return line == method + "\n" || line.compare(0, method.size() + 2, method + ", ") == 0;
}

void expect_exact(Rig& rig, const std::string& method, std::size_t frames) {
  rig.run(kLimit);
  ASSERT_EQ(rig.board().dm365.arm.failure(), "");
  ASSERT_EQ(rig.shown().size(), frames) << rig.board().uart_text();
  EXPECT_TRUE(is_chosen(rig, method)) << kernel_lines(rig);
  expect_frames_right(rig);
  EXPECT_EQ(rig.state().torn, 0u);
}

struct Kernel {
  const char* word;    ///< of firmware.kernel
  const char* method;  ///< on the UART
};

class KernelTest : public testing::TestWithParam<Kernel> {};

// Two strips or more, a last group of six pairs, a pitch beyond the row (504 of 512 bytes).
TEST_P(KernelTest, APictureOfSeveralStripsIsExact) {
  Rig rig;
  rig.set("video.width", "252").set("video.height", "40").set("camera.stamp", "false");
  rig.set("run.frames", "3").set("firmware.kernel", GetParam().word);
  expect_exact(rig, GetParam().method, 3);
}

// A view that is wider than the picture: black on all sides.
TEST_P(KernelTest, ABlackRimIsExact) {
  Rig rig;
  rig.set("video.width", "256").set("video.height", "64").set("camera.stamp", "false");
  rig.set("lens.mapping", "rectilinear").set("lens.fov", "60deg").set("lens.out_focal", "170px");
  rig.set("run.frames", "2").set("firmware.kernel", GetParam().word);
  expect_exact(rig, GetParam().method, 2);
  const auto lut = rig.lut();
  const auto black = static_cast<std::size_t>(std::count(lut.begin(), lut.end(), 64u * 512));
  EXPECT_GT(black, lut.size() / 10);
  EXPECT_LT(black, lut.size() / 2);
}

INSTANTIATE_TEST_SUITE_P(All, KernelTest,
                         testing::Values(Kernel{"strips", "strips"},
                                         Kernel{"offsets16", "offsets16"},
                                         Kernel{"deltas4", "deltas4"},
                                         Kernel{"codes", "codes"}, Kernel{"fastest", "staged"}),
                         [](const auto& i) { return std::string(i.param.word); });

// The shipped lens and footage in full size.
class WholeFrameTest : public testing::TestWithParam<Kernel> {};
TEST_P(WholeFrameTest, IsExactAndWithoutWarnings) {
  Rig rig;
  rig.load("default.yaml");
  rig.set("run.frames", "3").set("firmware.kernel", GetParam().word);
  expect_exact(rig, GetParam().method, 3);
  const board::FrameStats f = rig.board().frame_stats();
  EXPECT_EQ(f.dropped, 0u);
  EXPECT_EQ(f.repeated, 0u);
  EXPECT_EQ(rig.board().dm365.isif.stats.overflows.count(), 0u);
  for (const auto& [what, times] : Diagnostics::instance().counts())
    ADD_FAILURE() << times << " times: " << what.second;
}
INSTANTIATE_TEST_SUITE_P(Kernels, WholeFrameTest,
                         testing::Values(Kernel{"codes", "codes"}, Kernel{"fastest", "staged"}),
                         [](const auto& i) { return std::string(i.param.word); });

/// A view of the default lens, and the fastest method that its table allows.
struct View {
  const char *key, *value;
  const char* method;
  int refusals;  ///< number of faster methods that it does not allow
};
const char* const kNoWindows = "kernel staged: a tile's window does not fit into internal RAM\n";
const char* const kNoCodes = "kernel codes: more than 256 patterns of four pairs in a strip\n";
const char* const kNoDeltas =
    "kernel deltas4: more than 16 distances between neighbouring pairs in a strip\n";
const char* const kNoOffsets =
    "kernel offsets16: a row of a strip reads from more than 64 KiB of the source\n";

class FastestTest : public testing::TestWithParam<View> {};
TEST_P(FastestTest, TakesWhatTheLensAllows) {
  const View& view = GetParam();
  Rig rig;
  rig.load("default.yaml");
  rig.set("run.frames", "1").set("firmware.kernel", "fastest").set(view.key, view.value);
  expect_exact(rig, view.method, 1);
  std::string expected;
  if (view.refusals > 0) expected += kNoWindows;
  if (view.refusals > 1) expected += kNoCodes;
  if (view.refusals > 2) expected += kNoDeltas;
  if (view.refusals > 3) expected += kNoOffsets;
  expected += std::string("kernel: ") + view.method;
  EXPECT_EQ(kernel_lines(rig).substr(0, expected.size()), expected);
}
INSTANTIATE_TEST_SUITE_P(Views, FastestTest,
                         testing::Values(View{"lens.theta_max", "60deg", "staged", 0},
                                         View{"lens.out_focal", "160px", "codes", 1},
                                         View{"lens.out_focal", "120px", "deltas4", 2},
                                         View{"lens.out_focal", "50px", "offsets16", 3},
                                         View{"lens.out_focal", "30px", "strips", 4}),
                         [](const auto& i) {
                           return std::string(i.param.key).substr(5) + "_" + i.param.value;
                         });

}  // namespace
}  // namespace fovea::e2e
