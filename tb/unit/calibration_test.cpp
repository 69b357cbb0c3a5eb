// sw/fovea/config/calibration.h: OpenCV's files, and the keys that they set.
#include "sw/fovea/config/calibration.h"

#include "tb/own_diagnostics.h"
#include "tb/unit/support.h"

namespace fovea::app {
namespace {

using test::TempDir;
using test::user_error;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr const char* kMatrix = "K: [[300, 0, 480], [0, 320, 330], [0, 0, 1]]\n";

class CalibrationTest : public testing::Test {
 protected:
  Calibration read(const std::string& text) { return read_calibration(dir.write("c.yaml", text)); }
  std::string error(const std::string& text) {
    const auto file = dir.write("c.yaml", text);
    return user_error([&] { read_calibration(file); });
  }
  TempDir dir;
};

// The numbers are those of the file, typed in by hand.
TEST_F(CalibrationTest, ReadsTheShippedFiles) {
  const auto c = read_calibration(SHIPPED "/left.yaml");
  EXPECT_THAT(c.kb, ElementsAre(3.0334009006384287e+02, 3.2229678244636966e+02,
                                4.8649280066241465e+02, 3.2388095214561167e+02,
                                -3.5510560636666778e-02, -1.9848228876245811e-02,
                                2.6080053057044101e-02, -9.7183762742328750e-03));
  EXPECT_EQ(c.width, 960u);
  EXPECT_EQ(c.height, 640u);
  for (const char* name : {"/front.yaml", "/back.yaml", "/right.yaml"})
    EXPECT_EQ(read_calibration(std::string(SHIPPED) + name).width, 960u) << name;
}

TEST_F(CalibrationTest, ReadsPlainYamlAndOtherNames) {
  auto c = read(std::string(kMatrix) + "D: [0.1, 0.2, 0.3, 0.4]\nimage_size: [640, 480]\n");
  EXPECT_THAT(c.kb, ElementsAre(300, 320, 480, 330, 0.1, 0.2, 0.3, 0.4));
  EXPECT_EQ(c.width, 640u);
  EXPECT_EQ(c.height, 480u);
  c = read(std::string(kMatrix) +
           "distortion_coefficients: [[1], [2], [3], [4]]\nimage_width: 16\nimage_height: 8192\n");
  EXPECT_THAT(c.kb, ElementsAre(300, 320, 480, 330, 1, 2, 3, 4));
  EXPECT_EQ(c.width, 16u);
  EXPECT_EQ(c.height, 8192u);
  EXPECT_EQ(read(std::string(kMatrix) + "D: [0, 0, 0, 0]\n").width, 0u) << "size not known";
}

TEST_F(CalibrationTest, ErrorsNameTheFileAndWhatIsAllowed) {
  const std::string m = kMatrix, d = "D: [0, 0, 0, 0]\n";
  EXPECT_THAT(error(d), AllOf(HasSubstr("c.yaml"), HasSubstr("no camera matrix"),
                              HasSubstr("dist_coeffs (4 numbers)")));
  EXPECT_THAT(error("K: [1, 2]\n" + d), HasSubstr("matrix has 2 numbers"));
  EXPECT_THAT(error(m), HasSubstr("0 distortion coefficients"));
  EXPECT_THAT(error(m + "D: [0, 0, 0]\n"), HasSubstr("3 distortion coefficients"));
  EXPECT_THAT(error(m + "D: [0, 0, 0, 0, 0]\n"),
              HasSubstr("5 distortion coefficients, those of a lens that is not a fisheye"));
  EXPECT_THAT(error("K: [[300, 1, 480], [0, 320, 330], [0, 0, 1]]\n" + d), HasSubstr("skew"));
  EXPECT_THAT(error(m + "D: [0, 0, x, 0]\n"), HasSubstr("'D' holds something"));
  EXPECT_THAT(error(m + "D: [0, 0, .inf, 0]\n"), HasSubstr("'D' holds something"));
  for (const char* bad : {"[15, 480]", "[8193, 480]", "[640.5, 480]"})
    EXPECT_THAT(error(m + d + "image_size: " + bad + "\n"), HasSubstr("has a side of")) << bad;
  EXPECT_THAT(error(m + d + "image_size: [640]\n"), HasSubstr("size has 1 numbers"));
  EXPECT_THAT(error("[1, 2"), HasSubstr("not valid YAML"));
  EXPECT_THAT(error("just words"), HasSubstr("no camera matrix"));
  EXPECT_THAT(error(std::string(100'000, '[')), HasSubstr("not valid YAML"));
  EXPECT_THAT(user_error([&] { read_calibration(dir / "none.yaml"); }), HasSubstr("none.yaml"));
}

// Four coefficients are a lens of another kind if the file says so; the numbers cannot tell.
TEST_F(CalibrationTest, AnotherLensModelIsRefusedByItsName) {
  const std::string lens = std::string(kMatrix) + "D: [0.2, 0.2, 0, 0]\n";
  EXPECT_THAT(error(lens + "distortion_model: plumb_bob\n"),
              AllOf(HasSubstr("c.yaml"), HasSubstr("line 3: its lens model is 'distortion_model: plumb_bob'"),
                    HasSubstr("allowed")));
  for (const char* other : {"distortion_model: rational_polynomial", "distortion_model: radtan", "camera_model: omni",
                            "model_type: MEI", "fisheye_model: 0", "camera_model: pinhole", "Camera.type: \"PinHole\"",
                            "camera_model: pinhole\ndistortion_model: radtan"})
    EXPECT_THAT(error(lens + other + "\n"), HasSubstr("its lens model is '")) << other;
  for (const char* fisheye : {"distortion_model: equidistant", "distortion_model: fisheye",
                              "model_type: KANNALA_BRANDT", "Camera.type: \"KannalaBrandt8\"", "fisheye_model: 1",
                              "camera_model: pinhole\ndistortion_model: equidistant", "camera_name: davis"})
    EXPECT_EQ(read(lens + fisheye + "\n").kb[4], 0.2) << fisheye;
}

// An alias can make a short file endless, or as large as memory.
TEST_F(CalibrationTest, WhatAnAliasWouldExpandToIsNeverBuilt) {
  EXPECT_THAT(error("K: &a [*a, 300, 0, 480, 0, 300, 320, 0, 0, 1]\nD: [0, 0, 0, 0]\n"),
              HasSubstr("line 1: YAML anchors and aliases"));
  std::string bomb = "a0: &a0 [1,1,1,1,1,1,1,1,1,1]\n";
  for (int n = 1; n < 12; ++n) {
    bomb += "a" + std::to_string(n) + ": &a" + std::to_string(n) + " [";
    for (int k = 0; k < 10; ++k) bomb += (k ? ",*a" : "*a") + std::to_string(n - 1);
    bomb += "]\n";
  }
  EXPECT_THAT(error(bomb + "K: *a11\n"), HasSubstr("YAML anchors and aliases"));
  EXPECT_THAT(error(std::string("K: ") + std::string(17, '[') + std::string(17, ']') + "\n"),
              HasSubstr("nested deeper than the 16 levels"));
  EXPECT_THAT(error(std::string(kMatrix) + "---\nD: [0, 0, 0, 0]\n"), HasSubstr("line 2: only one YAML document"));
  EXPECT_THAT(error(std::string(kMatrix) + "D: [0, 0, 0, 0]\nD: [1, 0, 0, 0]\n"),
              HasSubstr("line 3: key 'D' is written twice (first in line 2)"));
}

struct CameraParams : ParamGroup {
  CameraParams() : ParamGroup("camera") {}
  ListParam kb{*this, "kb", {1, 1, 1, 1, 0, 0, 0, 0}, {8}, "lens", Origin::kChoice, ""};
  RealParam kb_width{*this, "kb_width", "px", 0, 0, 8192, "width", Origin::kChoice, ""};
  RealParam kb_height{*this, "kb_height", "px", 0, 0, 8192, "height", Origin::kChoice, ""};
  TextParam calibration{*this, "calibration", "", "file"};
};
struct LensParams : ParamGroup {
  LensParams() : ParamGroup("lens") {}
  ListParam kb{*this, "kb", {2, 2, 2, 2, 0, 0, 0, 0}, {8}, "lens", Origin::kChoice, ""};
  RealParam kb_width{*this, "kb_width", "px", 960, 16, 8192, "width", Origin::kChoice, ""};
  RealParam kb_height{*this, "kb_height", "px", 640, 16, 8192, "height", Origin::kChoice, ""};
  TextParam calibration{*this, "calibration", "", "file"};
};

class ApplyTest : public CalibrationTest {
 protected:
  OwnDiagnostics diagnostics;
  ApplyTest() {
    params.add(camera);
    params.add(lens);
    dir.write("one.yaml", std::string(kMatrix) + "D: [0, 0, 0, 0]\nimage_size: [800, 600]\n");
    dir.write("two.yaml", "K: [700, 0, 1, 0, 2, 3, 0, 0, 1]\nD: [0, 0, 0, 0]\nresolution: [64, 32]\n");
  }
  void apply(const std::string& text, const std::vector<std::string>& sets = {}) {
    experiment.load(dir.write("e.yaml", text));
    for (const auto& s : sets) experiment.override_with(s);
    apply_calibrations(params, experiment);
  }
  CameraParams camera;
  LensParams lens;
  ParamSet params;
  Experiment experiment{params};
};

TEST_F(ApplyTest, OneFileSetsCameraAndFirmware) {
  apply("camera.calibration: one.yaml\n");
  EXPECT_EQ(camera.kb()[0], 300);
  EXPECT_EQ(camera.kb_width(), 800);
  EXPECT_EQ(lens.kb(), camera.kb());
  EXPECT_EQ(lens.kb_width(), 800);
  EXPECT_EQ(lens.kb_height(), 600);
  EXPECT_THAT(experiment.origin("lens.kb").text(), testing::EndsWith("one.yaml"));
  EXPECT_TRUE(diagnostics.counts().empty());
}

TEST_F(ApplyTest, TheFirmwareMayHaveItsOwn) {
  apply("camera.calibration: one.yaml\nlens.calibration: two.yaml\n");
  EXPECT_EQ(camera.kb()[0], 300);
  EXPECT_EQ(lens.kb()[0], 700);
  EXPECT_EQ(lens.kb_width(), 64);
}

TEST_F(ApplyTest, TheFirmwaresOwnNumbersStay) {
  apply("camera.calibration: one.yaml\nlens.kb: [9, 9, 9, 9, 0, 0, 0, 0]\n");
  EXPECT_EQ(lens.kb()[0], 9);
  EXPECT_EQ(lens.kb_width(), 960);
  EXPECT_EQ(camera.kb()[0], 300);
}

TEST_F(ApplyTest, TheCommandLineWins) {
  apply("camera.calibration: one.yaml\n", {"camera.kb=[5, 5, 5, 5, 0, 0, 0, 0]"});
  EXPECT_EQ(camera.kb()[0], 5);
  EXPECT_EQ(lens.kb()[0], 300);
}

TEST_F(ApplyTest, NumbersBesideAFileAreWarnedOf) {
  apply("camera.calibration: one.yaml\ncamera.kb: [5, 5, 5, 5, 0, 0, 0, 0]\n");
  EXPECT_EQ(camera.kb()[0], 300);
  const auto counts = diagnostics.counts();
  ASSERT_EQ(counts.size(), 1u);
  EXPECT_THAT(counts.begin()->first.second, HasSubstr("'camera.kb' is set"));
}

TEST_F(ApplyTest, WithoutASizeTheFirmwareNeedsOne) {
  dir.write("bare.yaml", std::string(kMatrix) + "D: [0, 0, 0, 0]\n");
  EXPECT_THAT(user_error([&] { apply("camera.calibration: bare.yaml\n"); }),
              HasSubstr("lens.kb_width"));
}

TEST_F(ApplyTest, AGivenSizeWillDo) {
  dir.write("bare.yaml", std::string(kMatrix) + "D: [0, 0, 0, 0]\n");
  apply("camera.calibration: bare.yaml\nlens.kb_width: 320px\nlens.kb_height: 240px\n");
  EXPECT_EQ(camera.kb_width(), 0) << "the size of the still";
  EXPECT_EQ(lens.kb()[0], 300);
  EXPECT_EQ(lens.kb_width(), 320);
}

}  // namespace
}  // namespace fovea::app
