// sw/fovea/config/shared_pictures.h: whose pictures cameras without one show.
#include "sw/fovea/config/shared_pictures.h"

#include <fmt/format.h>

#include <optional>

#include "sw/fovea/machine/effective.h"
#include "tb/unit/support.h"

namespace fovea::app {
namespace {

using testing::HasSubstr;

struct Scene : ParamGroup {
  explicit Scene(const std::string& prefix) : ParamGroup(prefix) {}
  TextParam file{*this, "file", "", "file"};
  EnumParam kind{*this, "kind", "chart", {"chart", "sphere", "video"}, "kind", Origin::kChoice, ""};
  IntParam motion_period{*this, "motion_period", IntParam::Unit::kCount, 1, 1, 99, "motion", Origin::kChoice, ""};
  ListParam kb{*this, "kb", {1, 1, 1, 1, 0, 0, 0, 0}, {8}, "lens", Origin::kChoice, ""};
  RealParam kb_width{*this, "kb_width", "px", 960, 16, 8192, "width", Origin::kChoice, ""};
  RealParam kb_height{*this, "kb_height", "px", 640, 16, 8192, "height", Origin::kChoice, ""};
  TextParam calibration{*this, "calibration", "", "file"};
};
struct Lens : ParamGroup {
  explicit Lens(const std::string& prefix) : ParamGroup(prefix) {}
  RealParam theta_max{*this, "theta_max", "deg", 90, 1, 180, "angle", Origin::kChoice, ""};
  ListParam kb{*this, "kb", {2, 2, 2, 2, 0, 0, 0, 0}, {8}, "lens", Origin::kChoice, ""};
  RealParam kb_width{*this, "kb_width", "px", 960, 16, 8192, "width", Origin::kChoice, ""};
  RealParam kb_height{*this, "kb_height", "px", 640, 16, 8192, "height", Origin::kChoice, ""};
  TextParam calibration{*this, "calibration", "", "file"};
};
struct Wire : ParamGroup {
  explicit Wire(const std::string& prefix) : ParamGroup(prefix) {}
  IntParam phase{*this, "phase", IntParam::Unit::kTime, 0, 0, 40 * kPsPerMs, "phase", Origin::kChoice, ""};
};
struct Cameras : ParamGroup {
  Cameras() : ParamGroup("cameras") {}
  IntParam count{*this, "count", IntParam::Unit::kCount, 1, 1, 8, "count", Origin::kChoice, ""};
};
struct Row {
  explicit Row(unsigned n)
      : wire(fmt::format("camera.{}", n)), scene(fmt::format("camera.{}", n)), lens(fmt::format("camera.{}.lens", n)) {}
  Wire wire;
  Scene scene;
  Lens lens;
};

class SharedPicturesTest : public testing::Test {
 protected:
  SharedPicturesTest() {
    for (ParamGroup* g : std::initializer_list<ParamGroup*>{&cameras, &camera, &lens}) params.add(*g);
    for (Row& row : rows)
      for (ParamGroup* g : std::initializer_list<ParamGroup*>{&row.wire, &row.scene, &row.lens}) params.add(*g);
    dir.write("one.yaml", "K: [[300, 0, 4], [0, 320, 3], [0, 0, 1]]\nD: [0, 0, 0, 0]\nimage_size: [800, 600]\n");
    dir.write("two.yaml", "K: [[500, 0, 4], [0, 520, 3], [0, 0, 1]]\nD: [0, 0, 0, 0]\nimage_size: [64, 32]\n");
  }
  std::string share(const std::string& text, const std::vector<std::string>& sets = {}) {
    experiment.load(dir.write("e.yaml", text));
    for (const auto& s : sets) experiment.override_with(s);
    return complete_experiment(params, experiment);
  }
  /// Name of the file that a camera shows.
  std::string file(unsigned n) const { return std::filesystem::path(rows[n].scene.file()).filename().string(); }
  test::TempDir dir;
  Cameras cameras;
  Scene camera{"camera"};
  Lens lens{"lens"};
  std::array<Row, 8> rows{Row(0), Row(1), Row(2), Row(3), Row(4), Row(5), Row(6), Row(7)};
  ParamSet params;
  Experiment experiment{params};
};

constexpr const char* kThree =
    "camera.kind: sphere\n"
    "camera.0: {file: a.png, calibration: one.yaml, phase: 5ms}\n"
    "camera.1: {file: b.png, calibration: two.yaml, lens: {theta_max: 86deg}}\n"
    "camera.2: {file: c.mp4, kind: video, motion_period: 7}\n";

TEST_F(SharedPicturesTest, GoRoundAmongTheCamerasThatHaveOne) {
  const std::string said = share(std::string("cameras.count: 8\n") + kThree);
  EXPECT_EQ(said, "cameras without a picture of their own take that of another one: 3 that of 0, 4 that of 1, "
                  "5 that of 2, 6 that of 0, 7 that of 1");
  const char* const expected[] = {"a.png", "b.png", "c.mp4", "a.png", "b.png", "c.mp4", "a.png", "b.png"};
  for (unsigned n = 0; n < 8; ++n) EXPECT_EQ(file(n), expected[n]) << n;
  // With the picture come its kind, its motion and its lens, in the camera and in the firmware.
  EXPECT_TRUE(rows[5].scene.kind.is("video"));
  EXPECT_EQ(rows[5].scene.motion_period(), 7u);
  EXPECT_EQ(rows[4].scene.kb()[0], 500);
  EXPECT_EQ(rows[4].scene.kb_width(), 64);
  EXPECT_EQ(rows[7].lens.kb()[0], 500);
  EXPECT_EQ(rows[7].lens.kb_height(), 32);
  EXPECT_EQ(rows[7].lens.theta_max(), 86);
  EXPECT_EQ(rows[3].lens.theta_max(), 90);
  EXPECT_EQ(rows[3].lens.kb()[1], 320);
  // Not what belongs to the cable.
  EXPECT_FALSE(rows[3].wire.phase.user_set());
  // The origin is the key whose value it is.
  EXPECT_EQ(experiment.origin("camera.6.file").text(), "as camera.0.file");
  EXPECT_EQ(experiment.origin("camera.4.lens.theta_max").text(), "as camera.1.lens.theta_max");
}

TEST_F(SharedPicturesTest, OnlyCamerasThatThereAreTakePart) {
  EXPECT_EQ(share(std::string("cameras.count: 3\n") + kThree), "");
  EXPECT_FALSE(rows[3].scene.file.user_set());
  EXPECT_EQ(share(std::string("cameras.count: 4\n") + kThree),
            "cameras without a picture of their own take that of another one: 3 that of 0");
}

TEST_F(SharedPicturesTest, ACameraBetweenOthersTakesTheFirstOnes) {
  share("cameras.count: 3\ncamera.kind: sphere\ncamera.0.file: a.png\ncamera.2.file: c.png\n");
  EXPECT_EQ(file(1), "a.png");
}

TEST_F(SharedPicturesTest, ThePictureOfAllCamerasIsEnough) {
  EXPECT_EQ(share("cameras.count: 3\ncamera: {kind: sphere, file: x.png}\ncamera.0.file: a.png\n"), "");
  EXPECT_FALSE(rows[1].scene.file.user_set());
}

TEST_F(SharedPicturesTest, WithoutAnyPictureNothingIsTaken) {
  EXPECT_EQ(share("cameras.count: 3\ncamera.kind: sphere\n"), "");
  // A camera beyond the count is none of them.
  EXPECT_EQ(share("cameras.count: 3\ncamera.kind: sphere\ncamera.3.file: a.png\n"), "");
}

TEST_F(SharedPicturesTest, ACameraThatShowsAChartNeedsNone) {
  EXPECT_EQ(share("cameras.count: 3\ncamera.0: {kind: sphere, file: a.png}\ncamera.1.kind: sphere\n"),
            "cameras without a picture of their own take that of another one: 1 that of 0");
  EXPECT_EQ(file(2), "");
}

TEST_F(SharedPicturesTest, WhatTheCameraSetsItselfStays) {
  share(std::string("cameras.count: 5\ncamera.3.calibration: two.yaml\ncamera.4.lens.kb: [9, 9, 9, 9, 0, 0, 0, 0]\n") +
            kThree,
        {"camera.3.motion_period=3"});
  EXPECT_EQ(file(3), "a.png");
  EXPECT_EQ(rows[3].scene.kb()[0], 500);
  EXPECT_EQ(rows[3].scene.kb_width(), 64);
  EXPECT_EQ(rows[3].lens.kb()[0], 500);
  EXPECT_EQ(rows[3].scene.motion_period(), 3u);
  // Half a lens model of one camera and half of another one would be neither.
  EXPECT_EQ(rows[4].lens.kb()[0], 9);
  EXPECT_EQ(rows[4].lens.kb_width(), 960);
  EXPECT_EQ(rows[4].scene.kb_width(), 64);
}

TEST_F(SharedPicturesTest, TakenValuesAreNoKeysWithoutEffect) {
  share(std::string("cameras.count: 4\n") + kThree);
  EXPECT_TRUE(experiment.origin("camera.3.kb").preset());
}

}  // namespace
}  // namespace fovea::app
