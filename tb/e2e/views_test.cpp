// Composed views: tables against the oracle, every displayed picture byte for byte the host's composition of sent
// frames, which are found from the displayed bytes.
#include <gtest/gtest.h>

#include <algorithm>
#include <systemc>

#include "tb/e2e/views_rig.h"

namespace fovea::e2e {
namespace {

constexpr Picoseconds kViewLimit = 20 * kPsPerSecond;

/// The tiny picture is smaller than the D-cache, which is invalidated before and after each composition then.
struct View {
  const char* name;
  const char* view;
  bool quad;
  const char* kernel;
  const char* lut;
  const char *width = "160", *height = "120";
};
void PrintTo(const View& v, std::ostream* out) { *out << v.name; }

class ViewTest : public testing::TestWithParam<View> {};
TEST_P(ViewTest, EveryDisplayedPictureIsComposedOfSentFrames) {
  const View& p = GetParam();
  ViewsRig rig;
  rig.set("cameras.count", "4").set("camera.kind", "chart").set("camera.stamp", "false");
  rig.set("tvp5146.relock_fields", "0").set("video.width", p.width).set("video.height", p.height);
  rig.set("firmware.view", p.view).set("firmware.kernel", p.kernel).set("firmware.lut", p.lut);
  rig.set("cameras.quad", p.quad ? "true" : "false");
  const bool by_engine = p.kernel == std::string("engine");
  if (by_engine) rig.set("engine", "tlm");
  rig.set("camera.1.lens.mapping", "linear").set("camera.2.lens.centre_x", "5px").set("camera.3.mount.roll", "5deg");
  rig.set("run.frames", "7");
  rig.run(kViewLimit);
  ASSERT_EQ(rig.board().dm365.arm.failure(), "") << rig.board().uart_text();
  ASSERT_EQ(rig.shown().size(), 7u) << rig.board().uart_text();
  EXPECT_EQ(rig.board().uart_text().find("kernel: engine, ") != std::string::npos, by_engine);
  EXPECT_EQ(rig.board().uart_text().find("engine: events"), std::string::npos) << "a camera without a frame is read";
  const oracle::LutCheck check = rig.table_check();
  EXPECT_EQ(check.wrong, 0u) << check.first_wrong->text();
  EXPECT_LE(check.near_boundary, check.entries / 1000);
  auto lut = rig.table();
  ASSERT_EQ(rig.wrong_picture(lut), "");
  const auto& shown = rig.shown();
  for (std::size_t i = 1; i < shown.size(); ++i) {
    std::vector<unsigned> renewed;
    for (unsigned n = 0; n < 4; ++n)
      if (shown[i].number[n] != shown[i - 1].number[n]) renewed.push_back(n);
    if (p.quad) {
      for (unsigned n = 0; n < 4; ++n) {
        ASSERT_TRUE(shown[i].number[n] && shown[i - 1].number[n]) << i;
        EXPECT_EQ(*shown[i].number[n], *shown[i - 1].number[n] + 1) << i;
      }
      continue;
    }
    // In each displayed picture one part is new: that of the camera whose turn it was.
    ASSERT_EQ(renewed.size(), 1u) << i;
    const auto at = renewed.front(), before = (at + 3) % 4;
    ASSERT_TRUE(shown[i].number[at] && shown[i].number[before]) << i;
    EXPECT_EQ(*shown[i].number[at], *shown[i].number[before] + 1) << i;
    if (i >= 4) {
      ASSERT_TRUE(shown[i - 4].number[at]) << i;
      EXPECT_EQ(*shown[i].number[at], *shown[i - 4].number[at] + 4) << i;
    }
  }
  // The comparison complains of a table in which one entry is another one.
  lut[lut.size() / 3] ^= 4;
  EXPECT_NE(rig.wrong_picture(lut), "");
}
INSTANTIATE_TEST_SUITE_P(Small, ViewTest,
                         testing::Values(View{"FourWay", "four_way", false, "fastest", "fixed_point"},
                                         View{"BirdsEye", "birds_eye", false, "plain", "soft_float"},
                                         View{"FourWayTiny", "four_way", false, "ldm", "fixed_point", "32", "16"},
                                         View{"FourWayEngine", "four_way", false, "engine", "fixed_point", "32", "16"},
                                         View{"BirdsEyeEngine", "birds_eye", false, "engine", "fixed_point"},
                                         View{"BirdsEyeQuadEngine", "birds_eye", true, "engine", "fixed_point", "0",
                                              "0"}),
                         [](const auto& i) { return i.param.name; });

// The reader must be able to see what it looks for: at half size, with rows of either field.
TEST(FrameReader, RowsOfBothFieldsTogetherNameTheFrameAndContradictionsAreSeen) {
  const video::StampLayout layout = video::StampLayout::at(720, 576, 359.5, 287.5);
  const auto row_of = [](unsigned v) { return 2 * v + v / 2 % 2; };
  const auto read = [&](unsigned even, unsigned odd, unsigned even_camera, unsigned odd_camera) {
    video::Picture fields[2] = {{720, 576, 100}, {720, 576, 100}};
    video::stamp(fields[0], layout, even, even_camera);
    video::stamp(fields[1], layout, odd, odd_camera);
    oracle::Frame half{360, 288, std::vector<std::uint8_t>(std::size_t{360} * 288 * 2)};
    for (unsigned v = 0; v < 288; ++v)
      for (unsigned u = 0; u < 360; ++u)
        half.uyvy[(std::size_t{v} * 360 + u) * 2 + 1] = fields[row_of(v) % 2].row(row_of(v))[4 * u + 1];
    return read_frame(half, layout, [&](unsigned u, unsigned v) {
      return std::optional<SourcePixel>({{2.0 * u, 1.0 * row_of(v)}, row_of(v) % 2 != 0});
    });
  };
  for (unsigned camera = 0; camera < 4; ++camera) {
    const auto frame = read(1234, 1235, camera, camera);
    ASSERT_TRUE(frame) << camera;
    EXPECT_EQ(frame->number, 617u);
    EXPECT_EQ(frame->camera, camera);
  }
  EXPECT_FALSE(read(1235, 1234, 0, 0)) << "fields exchanged";
  EXPECT_FALSE(read(1234, 1237, 0, 0)) << "fields of two frames";
  EXPECT_FALSE(read(1234, 1235, 1, 2)) << "fields of two cameras";
  EXPECT_FALSE(read(1234, 1234, 0, 0)) << "one field twice";
}

// Whose frame a part shows is in its pixels; each captured frame is displayed, so with the stamps of all parts every
// frame of the raster is accounted for.
TEST(ViewStamps, EachPartsMarksNameTheFrameThatItsBytesAre) {
  ViewsRig rig;
  rig.set("cameras.count", "4").set("camera.kind", "chart").set("tvp5146.relock_fields", "0");
  // At half height neither field's rows alone show the whole code, so the parts are enlarged by two.
  rig.set("video.width", "240").set("video.height", "400").set("lens.focal", "255px").set("lens.out_focal", "510px");
  rig.set("firmware.view", "four_way").set("firmware.kernel", "fastest").set("run.frames", "7");
  rig.run(kViewLimit);
  ASSERT_EQ(rig.shown().size(), 7u) << rig.board().uart_text();
  ASSERT_EQ(rig.wrong_picture(rig.table()), "");
  std::optional<std::uint64_t> newest;
  for (const ViewsRig::Composed& s : rig.shown()) {
    std::uint64_t largest = 0;
    for (unsigned n = 0; n < 4; ++n) {
      const auto number = rig.stamp(s, n);
      EXPECT_EQ(number, s.number[n]) << "displayed frame " << s.index << ", camera " << n;
      if (number) largest = std::max(largest, *number);
    }
    if (newest) {
      EXPECT_EQ(largest, *newest + 1) << "no frame of the raster is missing, none comes twice";
    }
    newest = largest;
  }
}

/// Cameras that look straight down, so that their marks, above the middle of their pictures, are in their parts of the
/// mosaic: 80 px of a camera's picture to a metre of ground (255 px / 3.19 m), and 100 of the mosaic.
void look_down(ViewsRig& rig) {
  rig.set("cameras.count", "4").set("camera.kind", "chart").set("tvp5146.relock_fields", "0");
  rig.set("video.width", "480").set("video.height", "400").set("lens.focal", "255px");
  rig.set("firmware.view", "birds_eye").set("birds_eye.width", "4.8m").set("birds_eye.height", "4m");
  rig.set("birds_eye.car_length", "0.1m").set("birds_eye.car_width", "0.1m");
  const struct {
    const char *x, *y, *yaw;
  } sides[] = {{"0.2m", "0m", "0deg"}, {"0m", "-0.2m", "-90deg"}, {"-0.2m", "0m", "180deg"}, {"0m", "0.2m", "90deg"}};
  for (unsigned n = 0; n < 4; ++n) {
    const std::string mount = "camera." + std::to_string(n) + ".mount.";
    rig.set(mount + "x", sides[n].x).set(mount + "y", sides[n].y).set(mount + "yaw", sides[n].yaw);
    rig.set(mount + "height", "3.19m").set(mount + "pitch", "90deg").set(mount + "roll", "0deg");
  }
}

TEST(ViewStamps, EachMosaicIsComposedOfTheSentFramesThatItsMarksOrBytesName) {
  ViewsRig rig;
  look_down(rig);
  rig.set("firmware.kernel", "fastest").set("run.frames", "9");
  rig.run(kViewLimit);
  ASSERT_EQ(rig.shown().size(), 9u) << rig.board().uart_text();
  const oracle::LutCheck check = rig.table_check();
  EXPECT_EQ(check.wrong, 0u) << check.first_wrong->text();
  const auto lut = rig.table();
  ASSERT_EQ(rig.wrong_by_stamps(lut), "");
  const auto& shown = rig.shown();
  for (std::size_t i = 0; i < shown.size(); ++i) {
    // Genlocked cameras in turn: each mosaic has one frame that the one before had not, the next of the raster.
    unsigned seen = 0, renewed = 0;
    for (unsigned n = 0; n < 4; ++n) {
      seen += shown[i].number[n].has_value();
      if (i == 0 || shown[i].number[n] == shown[i - 1].number[n]) continue;
      ++renewed;
      ASSERT_TRUE(shown[i].number[n]) << i;
      const auto before = shown[i - 1].number[(n + 3) % 4];
      ASSERT_TRUE(before) << i;
      EXPECT_EQ(*shown[i].number[n], *before + 1) << i;
    }
    EXPECT_EQ(seen, std::min<std::size_t>(i + 1, 4)) << i;
    EXPECT_EQ(renewed, i == 0 ? 0u : 1u) << i;
  }
  // It complains of a wrong table: the row with the marks of camera 0, moved by a pair.
  auto wrong = lut;
  for (std::size_t i = 0; i < 240; ++i) wrong[100 * 240 + i] ^= 4;
  EXPECT_NE(rig.wrong_by_stamps(wrong), "");
  // And of a part that is older than its marks say: here the digits below them are of the round before.
  auto& last = rig.shown().back().frame.uyvy;
  const auto& older = rig.shown()[shown.size() - 5].frame.uyvy;
  for (std::size_t v = 135; v < 165; ++v)
    std::copy_n(older.begin() + static_cast<std::ptrdiff_t>((v * 480 + 200) * 2), 160,
                last.begin() + static_cast<std::ptrdiff_t>((v * 480 + 200) * 2));
  const std::string fault = rig.wrong_by_stamps(lut);
  EXPECT_EQ(fault.find("displayed frame 8: pixel "), 0u) << fault;
}

// Where the engine's kernel is asked for and there is no engine, the runs are listed a second time, in strips. The sum
// that notices a camera writing into a frame reads the first run of each camera.
TEST(ViewFailures, WithoutTheEngineEachCamerasFirstRunIsThatOfTheStrips) {
  ViewsRig rig;
  rig.set("cameras.count", "4").set("camera.kind", "chart").set("camera.stamp", "false");
  rig.set("tvp5146.relock_fields", "0").set("video.width", "320").set("video.height", "120");
  rig.set("firmware.view", "birds_eye").set("firmware.kernel", "engine").set("run.frames", "2");
  rig.run(kViewLimit);
  ASSERT_EQ(rig.shown().size(), 2u) << rig.board().uart_text();
  ASSERT_NE(rig.board().uart_text().find("kernel engine: "), std::string::npos) << rig.board().uart_text();
  ASSERT_NE(rig.board().uart_text().find("kernel: strips, "), std::string::npos) << rig.board().uart_text();
  const ViewsRig::Runs runs = rig.runs();
  for (unsigned n = 0; n < 4; ++n) {
    const auto first = std::find(runs.camera.begin(), runs.camera.end(), n);
    ASSERT_NE(first, runs.camera.end()) << n;
    EXPECT_EQ(runs.first[n], static_cast<std::uint32_t>(first - runs.camera.begin())) << n;
  }
}

TEST(ViewFailures, ACameraThatIsUnpluggedKeepsItsLastPicture) {
  ViewsRig rig;
  rig.set("cameras.count", "4").set("camera.kind", "chart").set("camera.stamp", "false");
  rig.set("tvp5146.relock_fields", "0").set("video.width", "160").set("video.height", "120");
  rig.set("firmware.view", "four_way").set("firmware.kernel", "fastest");
  // Four pictures are complete by then.
  rig.set("fault.kind", "unplugged").set("fault.camera", "2").set("fault.start", "1s").set("run.frames", "40");
  rig.run(kViewLimit);
  ASSERT_EQ(rig.shown().size(), 40u) << rig.board().uart_text();
  EXPECT_NE(rig.board().uart_text().find("camera 2: no signal"), std::string::npos);
  ASSERT_EQ(rig.wrong_picture(rig.table(), 40), "");
  const auto& last = rig.shown().back();
  for (unsigned n = 0; n < 4; ++n) ASSERT_TRUE(last.number[n]) << n;
  const std::uint64_t newest = *last.number[3];
  EXPECT_LT(*last.number[2], 26u);  // sent before the cable was pulled
  EXPECT_GT(newest, *last.number[2] + 6);
}

struct ShippedView {
  const char *file, *kernel = "fastest";
};
/// Cameras with clocks of their own: a picture shows a newer frame of the next camera in turn, or what the one
/// before it did while the decoder finds the syncs.
void expect_parts_renewed_in_turn(ViewsRig& rig) {
  const auto& shown = rig.shown();
  std::optional<unsigned> last;
  unsigned renewals = 0;
  for (std::size_t i = 1; i < shown.size(); ++i) {
    std::vector<unsigned> renewed;
    for (unsigned n = 0; n < 4; ++n)
      if (shown[i].number[n] != shown[i - 1].number[n]) renewed.push_back(n);
    ASSERT_LE(renewed.size(), 1u) << i;
    if (renewed.empty()) continue;
    const unsigned n = renewed[0];
    if (last) {
      EXPECT_EQ(n, (*last + 1) % 4) << i;
    }
    if (shown[i - 1].number[n]) {
      EXPECT_GT(*shown[i].number[n], *shown[i - 1].number[n]) << i;
    }
    last = n;
    ++renewals;
  }
  EXPECT_GE(renewals, 8u) << "each camera twice";
}

class ShippedViewTest : public testing::TestWithParam<ShippedView> {};
TEST_P(ShippedViewTest, IsComposedOfTheSentFramesThatItsMarksName) {
  ViewsRig rig;
  rig.load(GetParam().file).set("camera.stamp", "true");
  const bool by_engine = GetParam().kernel == std::string("engine");
  if (by_engine) rig.set("engine", "tlm").set("firmware.kernel", "engine");
  rig.run(kViewLimit);
  ASSERT_EQ(rig.shown().size(), rig.params.run.frames()) << rig.board().uart_text();
  const oracle::LutCheck check = rig.table_check();
  EXPECT_EQ(check.wrong, 0u) << check.first_wrong->text();
  EXPECT_LE(check.near_boundary, check.entries / 1000);
  std::printf("table: %zu entries, %zu within 0.02 px of a boundary and different\n", check.entries,
              check.near_boundary);
  const auto lut = rig.table();
  if (!rig.views().birds_eye) {
    // The code of no camera can be read in the quarters of four-way.yaml: they are half as high, and of other lenses.
    for (unsigned n = 0; n < 4; ++n) EXPECT_FALSE(rig.stamp(rig.shown().front(), n)) << "now it can: read it";
    EXPECT_EQ(rig.wrong_picture(lut), "");
    return;
  }
  // The marks of all four are in the bird's-eye views, in rows of one field or the other.
  ASSERT_EQ(rig.wrong_by_stamps(lut), "");
  const auto& shown = rig.shown();
  for (unsigned n = 0; n < 4; ++n) EXPECT_TRUE(shown.back().number[n]) << n;
  if (!rig.params.cameras.genlocked()) return expect_parts_renewed_in_turn(rig);
  for (std::size_t i = 1; i < shown.size(); ++i) {
    unsigned renewed = 0;
    for (unsigned n = 0; n < 4; ++n) {
      if (shown[i].number[n] == shown[i - 1].number[n]) continue;
      ++renewed;
      const auto before = shown[i - 1].number[rig.views().quad ? n : (n + 3) % 4];
      ASSERT_TRUE(before && shown[i].number[n]) << i;
      EXPECT_EQ(*shown[i].number[n], *before + 1) << i << ", camera " << n;
    }
    EXPECT_EQ(renewed, rig.views().quad ? 4u : 1u) << i;
  }
  // By the bytes alone no other frame fits, for which the marks are not needed.
  if (!by_engine) {
    EXPECT_EQ(rig.wrong_picture(lut), "");
  }
}
INSTANTIATE_TEST_SUITE_P(Nightly, ShippedViewTest,
                         testing::Values(ShippedView{"four-way.yaml"}, ShippedView{"birds-eye.yaml"},
                                         ShippedView{"birds-eye-quad.yaml"}, ShippedView{"birds-eye-free.yaml"},
                                         ShippedView{"four-way.yaml", "engine"},
                                         ShippedView{"birds-eye.yaml", "engine"},
                                         ShippedView{"birds-eye-quad.yaml", "engine"}),
                         [](const auto& i) {
                           std::string name = std::string(i.param.file) + i.param.kernel;
                           std::erase_if(name, [](char c) { return c == '-' || c == '.'; });
                           return name;
                         });

}  // namespace
}  // namespace fovea::e2e
