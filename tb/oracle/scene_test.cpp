// Colour conversion, lens models and picture sources of the camera.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>

#include "model/common/check.h"
#include "model/video/scene/ahead.h"
#include "model/video/scene/bars.h"
#include "model/video/scene/scene_params.h"
#include "tb/own_diagnostics.h"

namespace fovea::video {
namespace {

const double kPi = std::acos(-1.0);

const LensModel kFront = LensModel::kannala_brandt(302.453, 320.746, 496.640, 331.200,
                                                   {-0.0437356, 0.0216925, -0.0263888, 0.0084123});

/// A smooth picture whose colour tells the position.
RgbImage gradient(unsigned width, unsigned height) {
  RgbImage image{width, height, {}};
  for (unsigned y = 0; y < height; ++y)
    for (unsigned x = 0; x < width; ++x) {
      image.rgb.push_back(static_cast<std::uint8_t>(255 * x / (width - 1)));
      image.rgb.push_back(static_cast<std::uint8_t>(255 * y / (height - 1)));
      image.rgb.push_back(128);
    }
  return image;
}

TEST(ColourTest, HasTheLimitedRangeOfBt601) {
  EXPECT_EQ(to_ycbcr(0, 0, 0), (YCbCr{16, 128, 128}));
  EXPECT_EQ(to_ycbcr(255, 255, 255), (YCbCr{235, 128, 128}));
  // Full-range primaries: Y = 16 + 65.481, 128.553, 24.966; C from BT.601, to one level.
  const YCbCr red = to_ycbcr(255, 0, 0), green = to_ycbcr(0, 255, 0), blue = to_ycbcr(0, 0, 255);
  EXPECT_NEAR(red.y, 81.5, 1);
  EXPECT_NEAR(red.cb, 90.2, 1);
  EXPECT_EQ(red.cr, 240);
  EXPECT_NEAR(green.y, 144.6, 1);
  EXPECT_NEAR(green.cb, 53.8, 1);
  EXPECT_NEAR(green.cr, 34.2, 1);
  EXPECT_NEAR(blue.y, 41.0, 1);
  EXPECT_EQ(blue.cb, 240);
  EXPECT_NEAR(blue.cr, 109.8, 1);
}

TEST(ColourTest, NeverMakesAReservedCode) {
  for (int r = 0; r < 256; r += 15)
    for (int g = 0; g < 256; g += 15)
      for (int b = 0; b < 256; b += 15) {
        const YCbCr c = to_ycbcr(static_cast<std::uint8_t>(r), static_cast<std::uint8_t>(g),
                                 static_cast<std::uint8_t>(b));
        ASSERT_TRUE(c.y >= 16 && c.y <= 235 && c.cb >= 16 && c.cb <= 240 && c.cr >= 16 &&
                    c.cr <= 240);
      }
}

TEST(ColourTest, ChromaIsFiltered121OnEvenPixels) {
  const auto at = [](unsigned y, unsigned cb, unsigned cr) {
    return SampledImage::lanes({static_cast<std::uint8_t>(y), static_cast<std::uint8_t>(cb),
                                static_cast<std::uint8_t>(cr)});
  };
  const std::uint64_t row[] = {at(20, 100, 240), at(30, 120, 16), at(40, 200, 60), at(50, 41, 61)};
  std::uint8_t out[8];
  pack_row(row, 4, out);
  const std::uint8_t expected[] = {105, 20, 184, 30,   // (100+200+120+2)/4, (240+480+16+2)/4
                                   140, 40, 49,  50};  // (120+400+41+2)/4, (16+120+61+2)/4
  for (int i = 0; i < 8; ++i) EXPECT_EQ(out[i], expected[i]) << i;
}

TEST(ColourTest, SamplingInterpolatesAndEndsInBlack) {
  const RgbImage two{2, 1, {0, 0, 0, 255, 255, 255}};
  const SampledImage image(two);
  EXPECT_EQ(image.sample(0, 0) & 0xffff, 16u);
  EXPECT_EQ(image.sample(1, 0) & 0xffff, 235u);
  EXPECT_EQ(image.sample(0.5f, 0) & 0xffff, 126u);  // 125.5
  EXPECT_EQ(image.sample(1.4f, 0.4f) & 0xffff, 235u);
  EXPECT_EQ(image.sample(1.6f, 0), SampledImage::kBlackLanes);
  EXPECT_EQ(image.sample(0, -0.6f), SampledImage::kBlackLanes);
  EXPECT_EQ(image.sample(std::nanf(""), 0), SampledImage::kBlackLanes);
}

TEST(ColourTest, RefusesDataThatDoesNotFit) {
  EXPECT_THROW(to_picture({2, 2, std::vector<std::uint8_t>(11)}), UserError);
  EXPECT_THROW(to_picture({3, 1, std::vector<std::uint8_t>(9)}), UserError);
  EXPECT_THROW(SampledImage({0, 0, {}}), UserError);
}

TEST(LensModelTest, KannalaBrandtFollowsItsDefinition) {
  // theta = pi/4 to the right: theta_d = t (1 + k1 t^2 + k2 t^4 + k3 t^6 + k4 t^8), by hand.
  const double t = kPi / 4, q = 0.6168502750680849;
  const double theta_d = t * (1 - 0.0437356 * q + 0.0216925 * q * q - 0.0263888 * q * q * q +
                              0.0084123 * q * q * q * q);
  const Point right = kFront.project({1, 0, 1});
  EXPECT_NEAR(right.x, 496.640 + 302.453 * theta_d, 1e-9);
  EXPECT_NEAR(right.y, 331.200, 1e-9);
  const Point below = kFront.project({0, 2, 2});
  EXPECT_NEAR(below.y, 331.200 + 320.746 * theta_d, 1e-9);
}

TEST(LensModelTest, UnprojectInvertsProject) {
  for (const LensModel& lens : {kFront, LensModel::closed_form(LensKind::kLinear, 180, 720, 576),
                                LensModel::closed_form(LensKind::kEquisolid, 190, 720, 576),
                                LensModel::closed_form(LensKind::kStereographic, 180, 720, 576),
                                LensModel::closed_form(LensKind::kOrthographic, 170, 720, 576),
                                LensModel::closed_form(LensKind::kRectilinear, 100, 720, 576)})
    for (double theta = 0.01; theta < std::min(1.6, lens.theta_max()); theta += 0.1) {
      const Ray ray{std::sin(theta) * 0.6, std::sin(theta) * -0.8, std::cos(theta)};
      Ray back;
      ASSERT_TRUE(lens.unproject(lens.project(ray), back));
      EXPECT_NEAR(back.x, ray.x, 1e-9);
      EXPECT_NEAR(back.y, ray.y, 1e-9);
      EXPECT_NEAR(back.z, ray.z, 1e-9);
    }
}

TEST(LensModelTest, ClosedFormsHaveTheTabulatedFocalLength) {
  EXPECT_NEAR(LensModel::closed_form(LensKind::kLinear, 180, 720, 576).fx(), 229.18, 0.005);
  EXPECT_NEAR(LensModel::closed_form(LensKind::kOrthographic, 180, 720, 576).fx(), 360.00, 0.005);
  EXPECT_NEAR(LensModel::closed_form(LensKind::kEquisolid, 180, 720, 576).fx(), 254.56, 0.005);
  EXPECT_NEAR(LensModel::closed_form(LensKind::kStereographic, 180, 720, 576).fx(), 180.00, 0.005);
  EXPECT_THROW(LensModel::closed_form(LensKind::kOrthographic, 190, 720, 576), UserError);
}

TEST(LensModelTest, StretchingKeepsPictureEdgesInPlace) {
  const LensModel lens = kFront.scaled(0.75, 0.9);
  EXPECT_NEAR(lens.fx(), 226.84, 0.005);
  EXPECT_NEAR(lens.fy(), 288.67, 0.005);
  // The left edge of pixel 0 is at -0.5 in both pictures, the right edge at 959.5 and 719.5.
  EXPECT_NEAR((496.640 + 0.5) / 960, (lens.cx() + 0.5) / 720, 1e-12);
  EXPECT_NEAR((331.200 + 0.5) / 640, (lens.cy() + 0.5) / 576, 1e-12);
}

TEST(LensModelTest, FocalLengthsAreAboveNothing) {
  const std::pair<double, double> refused[] = {{0, 100}, {100, 0}, {-1, 100}, {100, -1}};
  for (const auto& [fx, fy] : refused)
    EXPECT_THROW(LensModel::kannala_brandt(fx, fy, 0, 0, {}), UserError) << fx << ' ' << fy;
  EXPECT_NO_THROW(LensModel::kannala_brandt(1e-3, 1e-3, 0, 0, {}));
}

TEST(LensModelTest, ACurveThatTurnsBackEndsWhereItDoes) {
  // d/dt (t - t^3 / 3) = 1 - t^2 = 0 at 1 rad.
  const LensModel lens = LensModel::kannala_brandt(100, 100, 0, 0, {-1.0 / 3, 0, 0, 0});
  EXPECT_NEAR(lens.theta_max(), 1.0, 2e-4);
  Ray ray;
  EXPECT_FALSE(lens.unproject({70, 0}, ray));  // r = 0.7 > 2/3
  EXPECT_TRUE(lens.unproject({66, 0}, ray));
}

TEST(LensModelTest, TableIsTheCurve) {
  const auto r = kFront.scaled(0.75, 0.9).table(129, 1.5);
  ASSERT_EQ(r.size(), 129u);
  EXPECT_EQ(r[0], 0);
  EXPECT_NEAR(r[128], 0.75 * 302.453 * kFront.radius(1.5), 1e-9);
  EXPECT_THROW(kFront.table(129, 3.0), UserError);
  EXPECT_THROW(kFront.table(129, 0), UserError);
  EXPECT_NO_THROW(kFront.table(2, 1e-9));
  // A rounding error of 1e-12 is allowed.
  EXPECT_NO_THROW(kFront.table(2, kFront.theta_max() + 1e-12));
  EXPECT_THROW(kFront.table(2, kFront.theta_max() + 2e-12), UserError);
}

TEST(SphereSourceTest, WithoutMotionShowsTheStillItself) {
  const RgbImage still = gradient(960, 640);
  SphereSource source(still, kFront, {960, 640, false}, {});
  const Picture expected = to_picture(still);
  const Picture& shown = source.field(0);
  // Inside the lens's reach only: the polynomial ends at some angle beyond the image circle.
  for (unsigned y = 30; y < 610; ++y)
    for (unsigned x = 120 * 2; x < 840 * 2; ++x)
      ASSERT_NEAR(shown.row(y)[x], expected.row(y)[x], 1) << x << " " << y;
}

TEST(SphereSourceTest, TurnsTheSceneThroughTheLens) {
  // A dot in the direction of d; after the turn it must be where the lens projects the turned d.
  RgbImage still{960, 640, std::vector<std::uint8_t>(960 * 640 * 3, 40)};
  const Point at{std::round(kFront.project({std::sin(0.6), 0, std::cos(0.6)}).x), 331};
  Ray d;
  ASSERT_TRUE(kFront.unproject(at, d));
  for (int y = -6; y <= 6; ++y)
    for (int x = -6; x <= 6; ++x)
      for (int c = 0; c < 3; ++c)
        still.rgb[(static_cast<std::size_t>(std::lround(at.y) + y) * 960 +
                   static_cast<std::size_t>(std::lround(at.x) + x)) *
                      3 +
                  c] = 255;
  SphereSource source(still, kFront, {720, 576, false}, {60, 8.0});
  const auto centroid = [](const Picture& p) {
    double sx = 0, sy = 0, n = 0;
    for (unsigned y = 0; y < p.height; ++y)
      for (unsigned x = 0; x < p.width; ++x)
        if (const int luma = p.row(y)[2 * x + 1]; luma > 80)
          sx += x * luma, sy += y * luma, n += luma;
    return Point{sx / n, sy / n};
  };
  // Phase 15 of 60: yaw = +8 deg, pitch = 0. Raster direction e shows the still at Rot e, so the
  // dot appears 8 degrees further to the left.
  const double yaw = 8 * kPi / 180;
  const Point want = source.raster_lens().project(
      {std::cos(yaw) * d.x - std::sin(yaw) * d.z, d.y, std::sin(yaw) * d.x + std::cos(yaw) * d.z});
  const Point seen = centroid(source.field(15));
  EXPECT_NEAR(seen.x, want.x, 0.3);
  EXPECT_NEAR(seen.y, want.y, 0.3);
  const Point still_at = source.raster_lens().project(d);
  EXPECT_NEAR(centroid(source.field(0)).x, still_at.x, 0.3);
  EXPECT_GT(std::abs(still_at.x - want.x), 25);
}

TEST(SphereSourceTest, TheScenePastTheStillsEdgeIsBlack) {
  const RgbImage still = gradient(320, 240);
  const LensModel lens = LensModel::closed_form(LensKind::kRectilinear, 60, 320, 240);
  SphereSource source(still, lens, {320, 240, false}, {4, 10.0});
  const Picture& p = source.field(1);  // yaw +10 deg: the right side looks past the still
  EXPECT_EQ(p.row(120)[2 * 318 + 1], 16);
  EXPECT_EQ(p.row(120)[2 * 318], 128);
  EXPECT_GT(p.row(120)[2 * 100 + 1], 30);
}

TEST(SphereSourceTest, IsAPureFunctionOfTheField) {
  const RgbImage still = gradient(480, 320);
  const LensModel lens = kFront.scaled(0.5, 0.5);
  SphereSource forward(still, lens, {480, 320, true}, {6, 3.0});
  SphereSource backward(still, lens, {480, 320, true}, {6, 3.0});
  std::vector<Picture> pictures;
  for (std::uint64_t k = 0; k < 14; ++k) pictures.push_back(forward.field(k));
  for (std::uint64_t k = 14; k-- > 0;) EXPECT_EQ(backward.field(k), pictures[k]) << k;
  EXPECT_NE(pictures[0], pictures[6]);  // same phase, other marks
  SphereSource bare(still, lens, {480, 320, false}, {6, 3.0});
  const Picture first = bare.field(1);
  EXPECT_EQ(bare.field(7), first);
  EXPECT_NE(bare.field(2), first);
}

TEST(SphereSourceTest, MarksAreReadableInThePicture) {
  SphereSource source(gradient(960, 640), kFront, {720, 576, true}, {60, 1.5});
  ASSERT_TRUE(source.stamps());
  for (std::uint64_t k : {0, 1, 59, 60, 777})
    EXPECT_EQ(decode_counter(source.field(k), CodeGrid(*source.stamps())), k);
}

TEST(StampTest, NamesTheCameraAndNoSingleWrongCellMakesAnotherCode) {
  const StampLayout layout = StampLayout::at(480, 320, 240, 160);
  Picture before(480, 320);
  stamp(before, layout, 0x1234);
  for (unsigned camera = 0; camera < kStampCameras; ++camera) {
    Picture picture(480, 320);
    stamp(picture, layout, 0x1234, camera);
    EXPECT_EQ(picture == before, camera == 0) << "the marks of camera 0 are those without a number";
    const auto code = decode_stamp(picture, CodeGrid(layout));
    ASSERT_TRUE(code);
    EXPECT_EQ(code->camera, camera);
    EXPECT_EQ(code->field, 0x1234);
    EXPECT_EQ(decode_counter(picture, CodeGrid(layout)).has_value(), camera == 0);
    constexpr unsigned kCell = StampLayout::kCellPixels;
    for (unsigned cell = 0; cell < StampLayout::kCodeColumns * StampLayout::kCodeRows; ++cell) {
      Picture wrong = picture;
      const unsigned x = layout.code_x + cell % StampLayout::kCodeColumns * kCell;
      const unsigned y = layout.code_y + cell / StampLayout::kCodeColumns * kCell;
      for (unsigned row = y; row < y + kCell; ++row)
        for (unsigned i = x; i < x + kCell; ++i) {
          std::uint8_t& luma = wrong.row(row)[2 * i + 1];
          luma = static_cast<std::uint8_t>(252 - luma);  // 32 and 220
        }
      EXPECT_FALSE(decode_stamp(wrong, CodeGrid(layout))) << "camera " << camera << " cell " << cell;
    }
  }
}

TEST(ChartTest, EachCameraShowsAnotherOne) {
  ChartSource first({64, 32, false, 0}), second({64, 32, false, 1});
  EXPECT_NE(first.field(5), second.field(5));
  EXPECT_EQ(second.field(5).row(3)[8], ChartSource::pair(4, 3, 5 + ChartSource::kCameraFields)[0]);
}

TEST(VideoSourceTest, ShowsEachFrameForTwoFieldsAndRepeats) {
  std::vector<RgbImage> frames;
  for (int i = 0; i < 3; ++i)
    frames.push_back(
        {16, 8, std::vector<std::uint8_t>(16 * 8 * 3, static_cast<std::uint8_t>(80 * i))});
  VideoSource source(frames, {16, 8, false});
  for (std::uint64_t k = 0; k < 14; ++k)
    EXPECT_EQ(source.field(k), to_picture(frames[k / 2 % 3])) << k;
}

TEST(VideoSourceTest, StretchesFramesOfAnotherSize) {
  VideoSource source({gradient(32, 16)}, {16, 8, false});
  const Picture& p = source.field(0);
  // Raster pixel 7 covers frame pixels 14 and 15: red = 255 * 14.5 / 31, row 3: 6.5 / 15.
  const YCbCr want = to_ycbcr(119, 110, 128);
  EXPECT_NEAR(p.row(3)[2 * 7 + 1], want.y, 2);
}

// Every pixel, where width, height or both differ from the raster's.
TEST(VideoSourceTest, StretchesEachDirectionByItself) {
  for (const auto& [w, h] : {std::pair{32u, 16u}, {16u, 16u}, {32u, 8u}, {8u, 4u}}) {
    VideoSource source({gradient(w, h)}, {16, 8, false});
    const Picture& p = source.field(0);
    // A pixel of the raster's border lies outside the smaller frame; black is drawn there, or the border.
    const unsigned edge = w < 16 ? 1 : 0;
    for (unsigned y = edge; y < 8 - edge; ++y)
      for (unsigned x = edge; x < 16 - edge; ++x) {
        const double u = (x + 0.5) * w / 16 - 0.5, v = (y + 0.5) * h / 8 - 0.5;
        const YCbCr want = to_ycbcr(static_cast<std::uint8_t>(std::lround(255 * u / (w - 1))),
                                    static_cast<std::uint8_t>(std::lround(255 * v / (h - 1))), 128);
        EXPECT_NEAR(p.row(y)[2 * x + 1], want.y, 2) << w << 'x' << h << " at " << x << ", " << y;
      }
  }
}

TEST(VideoSourceTest, BendsAFlatSceneIntoTheFishEye) {
  // A vertical bright stripe 45 degrees to the right of the axis.
  RgbImage flat{801, 401, std::vector<std::uint8_t>(801 * 401 * 3, 30)};
  const double focal = 400.5 / std::tan(60 * kPi / 180);
  const auto stripe = static_cast<unsigned>(std::lround(400 + focal));
  for (unsigned y = 0; y < 401; ++y)
    for (unsigned x = stripe - 2; x <= stripe + 2; ++x)
      for (int c = 0; c < 3; ++c) flat.rgb[(std::size_t{y} * 801 + x) * 3 + c] = 250;
  const LensModel lens = LensModel::closed_form(LensKind::kEquisolid, 180, 720, 576);
  VideoSource source({flat}, {720, 576, false}, Warp{lens, 120});
  const Picture& p = source.field(0);
  const auto brightest = [&](unsigned y) {
    double sum = 0, n = 0;
    for (unsigned x = 0; x < 720; ++x)
      if (const int v = p.row(y)[2 * x + 1]; v > 100) sum += x * v, n += v;
    return sum / n;
  };
  EXPECT_NEAR(brightest(287), 359.5 + 2 * 254.558 * std::sin(kPi / 8), 1.0);
  // Higher up, the direction (1, y, 1): its own angle, its own place.
  const Point high = lens.project({1, -0.5, 1});
  EXPECT_NEAR(brightest(static_cast<unsigned>(std::lround(high.y))), high.x, 1.5);
  EXPECT_EQ(p.row(287)[1], 16);  // 90 degrees to the left: not in the flat picture
}

TEST(VideoSourceTest, RefusesNoFramesAndMixedSizes) {
  EXPECT_THROW(VideoSource({}, {16, 8, false}), UserError);
  for (const auto& odd : {gradient(16, 4), gradient(8, 8)}) {
    EXPECT_THROW(VideoSource({gradient(16, 8), odd}, {16, 8, false}), UserError);
    EXPECT_THROW(VideoSource({gradient(16, 8), gradient(16, 8), odd}, {16, 8, false}), UserError);
  }
}

TEST(ChartSourceTest, TellsPlaceAndField) {
  ChartSource source({720, 576, false});
  const Picture a = source.field(5);
  EXPECT_EQ(a, source.field(5));
  const auto pair = ChartSource::pair(100, 33, 5);
  EXPECT_TRUE(std::equal(pair.begin(), pair.end(), a.row(33) + 200));
  for (std::uint8_t v : a.uyvy) ASSERT_TRUE(v >= 16 && v <= 240);
  const Picture b = source.field(6);
  std::size_t same = 0;
  for (std::size_t i = 0; i < a.uyvy.size(); ++i) same += a.uyvy[i] == b.uyvy[i];
  // Unrelated bytes of 220 or 225 levels agree about once in 222.
  EXPECT_NEAR(static_cast<double>(same) / static_cast<double>(a.uyvy.size()), 1 / 222.5, 0.001);
}

TEST(SceneParamsTest, DefaultsMakeTheFrontCamera) {
  SceneParams params;
  EXPECT_EQ(params.kind.key(), "camera.kind");
  const auto source = make_picture_source(params, {gradient(960, 640)}, 720, 576);
  EXPECT_EQ(source->width(), 720u);
  EXPECT_EQ(source->height(), 576u);
  EXPECT_EQ(decode_counter(source->field(9), CodeGrid(*source->stamps())), 9);
}

/// A calibration of another size of the same picture is stretched to it, in each direction by itself.
TEST(SceneParamsTest, CalibrationIsStretchedToThePicture) {
  SceneParams params;
  params.lens.set("kannala_brandt");
  params.kb.set("[300, 320, 490, 330, 0, 0, 0, 0]");
  EXPECT_EQ(params.lens_model(720, 576).fx(), 300.0) << "no size: it is this picture's";
  params.kb_width.set("960px");
  params.kb_height.set("640px");
  EXPECT_EQ(params.lens_model(960, 640).fy(), 320.0);
  EXPECT_EQ(params.lens_model(480, 640).fx(), 150.0);
  EXPECT_EQ(params.lens_model(480, 640).fy(), 320.0);
  EXPECT_EQ(params.lens_model(960, 320).fx(), 300.0);
  EXPECT_EQ(params.lens_model(960, 320).fy(), 160.0);
}

/// Its shape is the picture's, up to a pixel; without a size its centre is in the middle third.
TEST(SceneParamsTest, CalibrationThatCannotBelongToThePictureIsNamed) {
  SceneParams params;
  params.lens.set("kannala_brandt");
  const auto named = [&](unsigned width, unsigned height, const char* kb) {
    params.kb.set(kb);
    const OwnDiagnostics diagnostics;
    params.check_calibration(width, height);
    return !diagnostics.counts().empty();
  };
  // The middle of 61 x 31 is at 30, 15; a sixth of the sides is 10 1/6 and 5 1/6.
  EXPECT_FALSE(named(61, 31, "[20, 20, 40.1, 15, 0, 0, 0, 0]"));
  EXPECT_FALSE(named(61, 31, "[20, 20, 30, 9.9, 0, 0, 0, 0]"));
  EXPECT_TRUE(named(61, 31, "[20, 20, 40.2, 15, 0, 0, 0, 0]"));
  EXPECT_TRUE(named(61, 31, "[20, 20, 30, 9.8, 0, 0, 0, 0]"));
  const char* const any = "[20, 20, 1, 1, 0, 0, 0, 0]";
  params.kb_width.set("960px");
  EXPECT_TRUE(named(480, 320, any)) << "a width alone says no shape";
  params.kb_height.set("640px");
  for (const unsigned height : {319u, 320u, 321u}) EXPECT_FALSE(named(480, height, any)) << height;
  for (const unsigned height : {318u, 322u}) EXPECT_TRUE(named(480, height, any)) << height;
}

TEST(SceneParamsTest, ComplainsOfWhatCannotBe) {
  SceneParams params;
  EXPECT_THROW(make_picture_source(params, {}, 720, 576), UserError);
  params.kind.set("chart");
  EXPECT_NO_THROW(make_picture_source(params, {}, 720, 576));
  EXPECT_THROW(make_picture_source(params, {}, 721, 576), UserError);
  params.kind.set("video");
  params.video_fov.set("140deg");
  EXPECT_THROW(make_picture_source(params, {gradient(64, 48)}, 720, 576), UserError);
  params.lens.set("equisolid");
  EXPECT_NO_THROW(make_picture_source(params, {gradient(64, 48)}, 720, 576));
  params.fov.set("360deg");
  params.lens.set("orthographic");
  EXPECT_THROW(make_picture_source(params, {gradient(64, 48)}, 720, 576), UserError);
  EXPECT_THROW(params.kb.set("[1, 2, 3]"), UserError);
  EXPECT_THROW(params.motion_amplitude.set("3"), UserError);
}

TEST(AheadSourceTest, GivesTheSamePicturesInAnyOrder) {
  ChartSource direct({320, 240, true}), drawn({320, 240, true});
  AheadSource ahead(drawn);
  for (const std::uint64_t k : {0, 1, 2, 3, 7, 8, 4, 4, 5, 0}) {
    const Picture& shown = ahead.field(k);
    EXPECT_TRUE(shown == direct.field(k)) << k;
  }
  EXPECT_EQ(ahead.width(), 320u);
  EXPECT_EQ(ahead.height(), 240u);
}

struct FailingSource : PictureSource {
  Picture picture{4, 2};
  unsigned width() const override { return 4; }
  unsigned height() const override { return 2; }
  const Picture& field(std::uint64_t k) override {
    if (k == 2) throw UserError("field 2 cannot be drawn");
    return picture;
  }
};

TEST(AheadSourceTest, ErrorComesWithTheFieldThatIsWanted) {
  FailingSource failing;
  AheadSource ahead(failing);
  EXPECT_NO_THROW(ahead.field(0));
  EXPECT_NO_THROW(ahead.field(1));  // draws 2 meanwhile
  EXPECT_THROW(ahead.field(2), UserError);
  EXPECT_NO_THROW(ahead.field(3));
  EXPECT_NO_THROW(ahead.field(1));
  EXPECT_NO_THROW(ahead.field(4)) << "field 2 was never asked for";
}

/// Not a test of the clock: prints what a picture costs, fails only when it is absurd.
TEST(SphereSourceTest, PrintsItsCost) {
  using Clock = std::chrono::steady_clock;
  SphereSource source(gradient(960, 640), kFront, {720, 576, true}, {20, 1.5});
  const auto run = [&](std::uint64_t from) {
    const auto start = Clock::now();
    for (std::uint64_t k = from; k < from + 20; ++k) source.field(k);
    return std::chrono::duration<double, std::milli>(Clock::now() - start).count() / 20;
  };
  const double fresh = run(0), cached = run(20);
  std::printf("picture 720x576: new %.2f ms, cached %.3f ms\n", fresh, cached);
  EXPECT_LT(cached, fresh);
}

// ITU-R BT.601: Y = 16 + 219 E'Y, C = 128 + 224 E'C, with E'Y = 0.299 R + 0.587 G + 0.114 B, E'Cb = (B - E'Y) / 1.772
// and E'Cr = (R - E'Y) / 1.402, each to the nearest level.
TEST(Bars, HaveTheLevelsOfBt601) {
  for (const unsigned width : {640u, 720u, 800u}) {
    BarsSource source({width, 16, false, 0});
    const Picture p = source.field(0);
    ASSERT_EQ(p.width, width);
    for (unsigned x = 0; x < width; ++x) {
      const unsigned bar = x / (width / 8);
      // Of the bars, blue goes off after each, red after two, green after four.
      const double level = bar == 0 ? 1 : 0.75;
      const double r = bar & 2 ? 0 : level, g = bar & 4 ? 0 : level, b = bar & 1 ? 0 : level;
      const double y = 0.299 * r + 0.587 * g + 0.114 * b;
      for (const unsigned row : {0u, 15u}) {
        EXPECT_EQ(p.row(row)[2 * x + 1], std::lround(16 + 219 * y)) << x;
        const double c = x % 2 ? (r - y) / 1.402 : (b - y) / 1.772;
        EXPECT_EQ(p.row(row)[2 * x], std::lround(128 + 224 * c)) << x;
      }
    }
    EXPECT_EQ(source.field(3), p) << "a still";
  }
}

}  // namespace
}  // namespace fovea::video
