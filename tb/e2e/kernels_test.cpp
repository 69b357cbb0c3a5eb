// The firmware's remap methods on the board: the displayed pictures are those of the look-up table,
// and the UART names the method that a lens allows. CTest runs each case in its own process.
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <ostream>
#include <string>
#include <systemc>
#include <utility>
#include <vector>

#include "model/engine/remap_engine.h"
#include "tb/e2e/expectations.h"
#include "tb/e2e/rig.h"
#include "tb/rtl/lens_maps.h"

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
  const char* engine = "none";
};

class KernelTest : public testing::TestWithParam<Kernel> {};

// Two strips or more, a last group of six pairs, a pitch beyond the row (504 of 512 bytes).
TEST_P(KernelTest, APictureOfSeveralStripsIsExact) {
  Rig rig;
  rig.set("video.width", "252").set("video.height", "40").set("camera.stamp", "false");
  rig.set("run.frames", "3").set("firmware.kernel", GetParam().word);
  rig.set("engine", GetParam().engine);
  expect_exact(rig, GetParam().method, 3);
}

// A view that is wider than the picture: black on all sides.
TEST_P(KernelTest, ABlackRimIsExact) {
  Rig rig;
  rig.set("video.width", "256").set("video.height", "64").set("camera.stamp", "false");
  rig.set("lens.mapping", "rectilinear").set("lens.fov", "60deg").set("lens.out_focal", "170px");
  rig.set("run.frames", "2").set("firmware.kernel", GetParam().word);
  rig.set("engine", GetParam().engine);
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
                                         Kernel{"codes", "codes"}, Kernel{"fastest", "staged"},
                                         Kernel{"engine", "engine", "tlm"}),
                         [](const auto& i) { return std::string(i.param.word); });

// The shipped lens and footage in full size. `plain` is in ShippedTest, `copy`, `gather` and `runs` are in EdmaTest.
class WholeFrameTest : public testing::TestWithParam<Kernel> {};
TEST_P(WholeFrameTest, IsExactAndWithoutWarnings) {
  Rig rig;
  rig.load("default.yaml");
  rig.set("run.frames", "2").set("firmware.kernel", GetParam().word).set("engine", GetParam().engine);
  expect_exact(rig, GetParam().method, 2);
  const board::FrameStats f = rig.board().frame_stats();
  EXPECT_EQ(f.dropped, 0u);
  EXPECT_EQ(f.repeated, 0u);
  EXPECT_EQ(rig.board().dm365.isif.stats.overflows.count(), 0u);
  for (const auto& [what, times] : rig.diagnostics.counts()) {
    // The engine keeps the SDRAM so busy that the controller postpones refreshes for longer than JESD79-2 allows.
    if (GetParam().engine != std::string("none") && what.second.find("postponed REF") != std::string::npos) continue;
    ADD_FAILURE() << times << " times: " << what.second;
  }
}
INSTANTIATE_TEST_SUITE_P(Kernels, WholeFrameTest,
                         testing::Values(Kernel{"ldm", "ldm"}, Kernel{"strips", "strips"},
                                         Kernel{"offsets16", "offsets16"}, Kernel{"deltas4", "deltas4"},
                                         Kernel{"codes", "codes"}, Kernel{"fastest", "staged"},
                                         Kernel{"engine", "engine", "tlm"}),
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

/// A lens that one method after the other refuses, for a reason that no view of the default lens gives.
struct Refusing {
  const char* name;
  std::vector<std::pair<const char*, const char*>> keys;
  std::string refusals;  ///< all lines about kernels before the one that names the method
  const char* method;
};
void PrintTo(const Refusing& r, std::ostream* out) { *out << r.name; }
class FallbackTest : public testing::TestWithParam<Refusing> {};
TEST_P(FallbackTest, TheNextMethodTakesOverAndTheReasonIsSaid) {
  const Refusing& lens = GetParam();
  Rig rig;
  rig.set("firmware.kernel", "fastest").set("firmware.lut", "fixed_point").set("camera.stamp", "false");
  rig.set("run.frames", "1");
  for (const auto& [key, value] : lens.keys) rig.set(key, value);
  expect_exact(rig, lens.method, 1);
  const std::string expected = lens.refusals + "kernel: " + lens.method + ", ";
  EXPECT_EQ(kernel_lines(rig).substr(0, expected.size()), expected);
  const auto lut = rig.lut();
  const auto black = static_cast<std::size_t>(std::count(lut.begin(), lut.end(), 576u * 1'440));
  EXPECT_LT(black, lut.size() * 19 / 20) << "hardly anything to see";
}
INSTANTIATE_TEST_SUITE_P(
    Lenses, FallbackTest,
    testing::Values(
        // The largest tile source has 8,768 of the 10,368 bytes, which leaves room for 100 patterns.
        Refusing{"Patterns_of_staged",
                 {{"lens.out_focal", "178px"}},
                 "kernel staged: a strip has more patterns than fit into internal RAM beside the windows\n",
                 "codes"},
        // An output that is compressed to a fifth of its height: its rows are up to 91 rows of the source apart.
        Refusing{"Row_step_of_codes",
                 {{"lens.mapping", "stereographic"}, {"lens.fov", "150deg"}, {"lens.out_focal", "60px"},
                  {"lens.out_aspect", "0.2"}},
                 std::string(kNoWindows) + "kernel codes: a row begins more than 128 KiB away from the row above\n",
                 "deltas4"}),
    [](const auto& i) { return i.param.name; });

// What the engine makes without the table: the golden model's picture, for the golden model's own map of the lens.
class EngineMapTest : public testing::TestWithParam<const char*> {};
TEST_P(EngineMapTest, ThePictureIsTheGoldenModels) {
  constexpr unsigned kWidth = 160, kHeight = 48;  // rows without padding, as in the golden model's jobs
  Rig rig;
  rig.set("video.width", std::to_string(kWidth)).set("video.height", std::to_string(kHeight));
  rig.set("camera.stamp", "false").set("lens.shift_x", "20.5px").set("run.frames", "3");
  rig.set("engine", "tlm").set("firmware.kernel", GetParam());
  rig.run(kLimit);
  ASSERT_EQ(rig.board().dm365.arm.failure(), "");
  ASSERT_EQ(rig.shown().size(), 3u) << rig.board().uart_text();
  EXPECT_TRUE(is_chosen(rig, GetParam())) << kernel_lines(rig);
  EXPECT_EQ(rig.state().torn, 0u);
  lens_view_t view;
  lens_view_default(&view);
  view.shift_x = 20.5;
  lens_t lens;
  ASSERT_EQ(lens_init(&lens, &view, kWidth, kHeight), LENS_OK);
  rtl::MappedJob m =
      std::string(GetParam()) == "engine_grid" ? rtl::grid_job(lens, 4) : rtl::radial_job(lens);
  m.job.src_base = 0;
  const auto words_of = [](const oracle::Frame& f) {
    std::vector<std::uint32_t> words(f.uyvy.size() / 4);
    for (std::size_t n = 0; n < f.uyvy.size(); ++n)
      words[n / 4] |= std::uint32_t{f.uyvy[n]} << 8 * (n % 4);
    return words;
  };
  unsigned black = 0;
  for (const Shown& s : rig.shown()) {
    const auto guess = static_cast<std::uint64_t>(static_cast<double>(*s.record.capture_start) * 1e-12 / 0.04);
    bool found = false;
    for (std::uint64_t n = guess > 1 ? guess - 2 : 0; n <= guess + 2 && !found; ++n) {
      const auto sent = words_of(rig.sent(n));
      const auto want = rtl::picture(m.job, m.map, 0x10801080, [&](std::uint32_t at) { return sent.at(at); });
      found = want == words_of(s.frame);
      black = static_cast<unsigned>(std::count(want.begin(), want.end(), 0x10801080u));
    }
    EXPECT_TRUE(found) << "frame " << s.record.index << " is not the golden model's picture of a sent frame";
  }
  EXPECT_LT(black, kWidth * kHeight / 4);
  for (const auto& [what, times] : rig.diagnostics.counts()) ADD_FAILURE() << times << " times: " << what.second;
}
INSTANTIATE_TEST_SUITE_P(Maps, EngineMapTest, testing::Values("engine_grid", "engine_radial"),
                         [](const auto& i) { return std::string(i.param); });

// A chip without the engine: said, and another kernel's picture; its registers are not touched.
TEST(EngineKernelTest, WithoutAnEngineAnotherKernelIsTaken) {
  Rig rig;
  rig.set("video.width", "160").set("video.height", "48").set("camera.stamp", "false");
  rig.set("run.frames", "1").set("firmware.kernel", "engine");
  expect_exact(rig, "staged", 1);
  EXPECT_EQ(kernel_lines(rig).find("kernel engine: the chip has no remap engine\nkernel: staged, "), 0u)
      << kernel_lines(rig);
}

// What a grid cannot express is refused; black beyond the largest angle is the table's.
TEST(EngineKernelTest, AGridRefusesALargestAngle) {
  Rig rig;
  rig.set("video.width", "160").set("video.height", "48").set("camera.stamp", "false");
  rig.set("lens.mapping", "kannala_brandt").set("lens.theta_max", "20deg");
  rig.set("run.frames", "1").set("firmware.kernel", "engine_grid").set("engine", "tlm");
  expect_exact(rig, "staged", 1);
  EXPECT_EQ(kernel_lines(rig).find("kernel engine_grid: a grid cannot express the largest visible angle\n"), 0u)
      << kernel_lines(rig);
}

/// Jobs that the firmware did not ask for, while its own is under way: each kind of failure is said, the picture that
/// may be wrong is left out, the one before stays, and the engine goes on.
class EngineFailure : public testing::Test {
 protected:
  engine::RemapEngine& engine() { return rig.board().dm365.placed.get<engine::RemapEngine>("engine"); }
  void put(const Reg& r, std::uint32_t value) { engine().regs.write(r.offset(), 4, value); }
  bool busy() {
    std::uint32_t status = 0;
    engine().regs.read(engine().regs.status.offset(), 4, status);
    return status & 1;
  }
  /// Until the firmware's next job is under way.
  void next_job() {
    while (busy()) rig.advance(kPsPerUs * 20);
    while (!busy() && kernel_time() < kLimit) rig.advance(kPsPerUs * 20);
  }
  std::vector<std::string> said() {
    std::vector<std::string> lines;
    const std::string text = rig.board().uart_text(), begin = "engine: ";
    for (std::size_t at = text.find(begin); at != std::string::npos; at = text.find(begin, at + 1))
      lines.push_back(text.substr(at + begin.size(), text.find('\r', at) - at - begin.size()));
    return lines;
  }
  Rig rig;
};

TEST_F(EngineFailure, EachIsSaidAndTheLastGoodPictureStays) {
  rig.set("video.width", "160").set("video.height", "48").set("camera.stamp", "false").set("lens.fov", "150deg");
  rig.set("run.frames", "24").set("firmware.kernel", "engine").set("engine", "tlm");
  rig.build();
  constexpr std::uint32_t kNowhere = 0x0300'0000;
  const auto& r = engine().regs;
  const auto submit = [&] { put(r.submit, 0xEE); };
  const std::vector<std::pair<std::string, std::function<void()>>> faults = {
      {"0x03", [&] { put(r.size, 0), submit(); }},
      {"0x05", [&] { put(r.src_base, kNowhere), submit(); }},
      {"0x09", [&] { put(r.dst_base, kNowhere), submit(); }},
      {"0x10", [&] { put(r.ctrl, 3); }},
      {"0x20", [&] { for (int n = 0; n < 5; ++n) submit(); }}};
  next_job();
  for (const auto& [events, fault] : faults) {
    for (int n = 0; n < 3; ++n) next_job();
    ASSERT_TRUE(busy());
    fault();
    rig.advance(60 * kPsPerMs);  // the frame that is left out, and a good one
  }
  rig.run(kLimit);
  ASSERT_EQ(rig.board().dm365.arm.failure(), "");
  ASSERT_EQ(rig.shown().size(), 24u) << rig.board().uart_text();
  const auto lines = said();
  ASSERT_EQ(lines.size(), faults.size()) << rig.board().uart_text();
  for (std::size_t n = 0; n < lines.size(); ++n) EXPECT_EQ(lines[n], "events " + faults[n].first);
  expect_frames_right(rig, 0);
  unsigned repeated = 0;
  for (const Shown& s : rig.shown()) repeated += s.record.repeated;
  EXPECT_EQ(repeated, faults.size());
}

}  // namespace
}  // namespace fovea::e2e
