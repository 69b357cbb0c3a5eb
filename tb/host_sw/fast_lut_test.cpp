// The look-up table in fixed point: against the definition of the mappings, which is written out
// here once more, and against the table in double precision, which it has to equal.
#include "sw/lens/fast_lut.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <random>
#include <string>
#include <vector>

namespace {

const long double kPi = std::acos(-1.0L);

struct Size {
  unsigned width, height;
};
constexpr Size kSizes[] = {{720, 576}, {720, 480}, {640, 480}, {320, 240}, {716, 572}};

/// The geometry of sw/lens/README.md with numbers of type T, without the lens library.
template <typename T>
class Definition {
 public:
  Definition(const lens_view_t& view, Size size) : view_(view), size_(size) {
    const T fov = static_cast<T>(view.fov_deg) * static_cast<T>(kPi) / 180, w = size.width;
    if (view.focal_px != 0)
      f_ = view.focal_px;
    else if (view.mapping == LENS_RECTILINEAR)
      f_ = w / (2 * std::tan(fov / 2));
    else if (view.mapping == LENS_LINEAR)
      f_ = w / fov;
    else if (view.mapping == LENS_ORTHOGRAPHIC)
      f_ = w / (2 * std::sin(fov / 2));
    else if (view.mapping == LENS_EQUISOLID)
      f_ = w / (4 * std::sin(fov / 4));
    else if (view.mapping == LENS_STEREOGRAPHIC)
      f_ = w / (4 * std::tan(fov / 4));
    else
      f_ = static_cast<T>(view.table_r[1]) * (view.table_count - 1) / view.theta_max;
    out_f_ = view.out_focal_px != 0 ? static_cast<T>(view.out_focal_px) : f_;
  }

  struct Source {
    T column, row;
    bool visible;
  };
  Source source(unsigned pair, unsigned v) const {
    const T mid_x = (static_cast<T>(size_.width) - 1) / 2;
    const T mid_y = (static_cast<T>(size_.height) - 1) / 2;
    const T u = 2 * static_cast<T>(pair) + (view_.pair_method == PAIR_CENTRE ? T{0.5} : T{0});
    const T x = (u - mid_x + view_.shift_x) / out_f_;
    const T y = (v - mid_y + view_.shift_y) / (out_f_ * view_.out_aspect);
    const T r = std::sqrt(x * x + y * y), theta = std::atan(r);
    const T gain = r == 0 ? T{0} : radius(theta) / r;
    return {mid_x + view_.centre_x + gain * x, mid_y + view_.centre_y + view_.in_aspect * gain * y,
            !(view_.theta_max > 0) || theta <= view_.theta_max};
  }

  std::uint32_t entry(const Source& s, unsigned pitch) const {
    const T column = std::floor(s.column + T{0.5}), row = std::floor(s.row + T{0.5});
    if (!s.visible || column < 0 || row < 0 || column >= size_.width || row >= size_.height)
      return size_.height * pitch;
    return static_cast<unsigned>(row) * pitch + static_cast<unsigned>(column) / 2 * 4;
  }

 private:
  T radius(T theta) const {
    switch (view_.mapping) {
      case LENS_RECTILINEAR:
        return f_ * std::tan(theta);
      case LENS_LINEAR:
        return f_ * theta;
      case LENS_ORTHOGRAPHIC:
        return f_ * std::sin(theta);
      case LENS_EQUISOLID:
        return 2 * f_ * std::sin(theta / 2);
      case LENS_STEREOGRAPHIC:
        return 2 * f_ * std::tan(theta / 2);
      default:
        break;
    }
    const T at = theta * (view_.table_count - 1) / view_.theta_max;
    const unsigned i = std::min(static_cast<unsigned>(at), view_.table_count - 2);
    const T first = view_.table_r[i], second = view_.table_r[i + 1];
    return first + (second - first) * (at - i);
  }

  const lens_view_t& view_;
  Size size_;
  T f_, out_f_;
};

/// A lens, its table in double precision and the prepared one in fixed point.
class Lens {
 public:
  Lens(const lens_view_t& view, Size size, unsigned pitch = 1440)
      : view_(std::make_unique<lens_view_t>(view)),
        fast_(std::make_unique<fast_lut_t>()),
        size_(size),
        pitch_(pitch) {
    EXPECT_EQ(lens_init(&lens_, view_.get(), size.width, size.height), LENS_OK);
    result_ = fast_lut_prepare(fast_.get(), &lens_);
  }
  Lens(const Lens&) = delete;

  fast_lut_result_t result() const { return result_; }
  fast_lut_t& fast() { return *fast_; }
  const lens_view_t& view() const { return *view_; }

  std::vector<std::uint32_t> exact_table() const {
    std::vector<std::uint32_t> lut(lens_lut_entries(size_.width, size_.height));
    lens_build_lut(&lens_, lut.data(), pitch_);
    return lut;
  }
  std::vector<std::uint32_t> table() {
    std::vector<std::uint32_t> lut(lens_lut_entries(size_.width, size_.height) + 1, 0xDEADBEEF);
    exact_entries = fast_lut_build(fast_.get(), lut.data(), pitch_);
    EXPECT_EQ(lut.back(), 0xDEADBEEF) << "written behind the table";
    lut.pop_back();
    return lut;
  }
  std::size_t differing() {
    const auto a = table(), b = exact_table();
    std::size_t n = 0;
    for (std::size_t i = 0; i < a.size(); ++i) n += a[i] != b[i];
    return n;
  }
  /// Largest difference of a position from the definition, in units of fixed point, over every
  /// step-th pair of the picture.
  double worst_error(unsigned step) const {
    const Definition<long double> definition(*view_, size_);
    const long double unit = 1u << FAST_LUT_FRACTION;
    long double worst = 0;
    for (unsigned n = 0; n < lens_lut_entries(size_.width, size_.height); n += step) {
      const unsigned pair = n % (size_.width / 2), v = n / (size_.width / 2);
      std::int32_t column, row;
      if (!fast_lut_source(fast_.get(), pair, v, &column, &row)) continue;
      const auto s = definition.source(pair, v);
      worst = std::max({worst, std::abs((s.column + 0.5L) * unit - column),
                        std::abs((s.row + 0.5L) * unit - row)});
    }
    return static_cast<double>(worst);
  }
  std::uint32_t exact_entries = 0;

 private:
  std::unique_ptr<lens_view_t> view_;
  lens_t lens_;
  std::unique_ptr<fast_lut_t> fast_;
  Size size_;
  unsigned pitch_;
  fast_lut_result_t result_;
};

lens_view_t view_of(std::uint32_t mapping, double fov_deg, double out_focal_px = 0) {
  lens_view_t view;
  lens_view_default(&view);
  view.mapping = mapping;
  view.fov_deg = fov_deg;
  view.out_focal_px = out_focal_px;
  return view;
}

/// A table like that of a car's camera: R = f theta (1 + k1 theta^2 + ...).
void set_table(lens_view_t& view, double f, unsigned count, double theta_max) {
  view.table_count = count;
  view.theta_max = theta_max;
  for (unsigned i = 0; i < count; ++i) {
    const double t = i * theta_max / (count - 1), t2 = t * t;
    view.table_r[i] = f * t * (1 + t2 * (-0.05 + t2 * (0.012 + t2 * -0.004)));
  }
}

/// Seven views of each mapping: both methods, shifts, a centre off the middle, aspects, a rim that
/// the lens does not show, out_focal from 120 to 260 px and that of the lens.
std::vector<lens_view_t> lenses() {
  std::vector<lens_view_t> all;
  for (std::uint32_t mapping = LENS_RECTILINEAR; mapping <= LENS_TABLE; ++mapping)
    for (unsigned n = 0; n < 7; ++n) {
      lens_view_t view = view_of(mapping, mapping == LENS_RECTILINEAR ? 120 : 150 + 5 * n);
      view.out_focal_px = n == 0 ? 0 : 120 + (n - 1) * 28;
      if (mapping == LENS_TABLE)
        set_table(view, 230 + 5 * n, 129 - 21 * n, (95 - n) / 180.0 * M_PI);
      if (n % 2 == 1) view.pair_method = PAIR_CENTRE;
      if (n == 2 || n == 5) view.theta_max = view.theta_max > 0 ? view.theta_max / 2 : 1.0;
      if (n >= 3) {
        view.centre_x = 2.125 * n - 11;
        view.centre_y = 10.53 - n;
        view.shift_x = n == 4 ? -32 : 3.25;
      }
      if (n >= 4) view.shift_y = n == 6 ? 32 : -1.75;
      if (n == 1 || n >= 5) {
        view.in_aspect = 1.06;
        view.out_aspect = 0.93;
      }
      all.push_back(view);
    }
  return all;
}

std::string name(const lens_view_t& view, Size size) {
  return "mapping " + std::to_string(view.mapping) + ", out_focal " +
         std::to_string(view.out_focal_px) + ", " + std::to_string(size.width) + "x" +
         std::to_string(size.height);
}

TEST(FastLutTest, EveryEntryIsThatOfTheDefinitionAndOfDoublePrecision) {
  std::size_t black = 0, exact = 0, tables = 0;
  for (const lens_view_t& view : lenses())
    for (const Size size : kSizes) {
      SCOPED_TRACE(name(view, size));
      Lens lens(view, size);
      ASSERT_EQ(lens.result(), FAST_LUT_OK) << fast_lut_result_text(lens.result());
      const auto lut = lens.table();
      EXPECT_EQ(lut, lens.exact_table());
      const Definition<double> definition(lens.view(), size);
      std::size_t wrong = 0, i = 0;
      for (unsigned v = 0; v < size.height; ++v)
        for (unsigned pair = 0; pair < size.width / 2; ++pair, ++i) {
          wrong += lut[i] != definition.entry(definition.source(pair, v), 1440);
          black += lut[i] == size.height * 1440;
        }
      EXPECT_EQ(wrong, 0u);
      // A position is near the edge of a pair once in 2 px and near that of a row once in 1 px. The
      // rectilinear mapping is linear: a whole column or row of its picture can be near one.
      const double near = 1.5 * (2.0 * lens.fast().guard + 1) / (1 << FAST_LUT_FRACTION);
      const double lines = view.mapping == LENS_RECTILINEAR ? size.width + size.height : 12;
      EXPECT_LE(lens.exact_entries, near * static_cast<double>(lut.size()) * 1.5 + lines);
      exact += lens.exact_entries;
      ++tables;
    }
  std::printf("  %zu tables, %zu entries in double precision, %zu black\n", tables, exact, black);
  EXPECT_EQ(tables, 210u);
  EXPECT_GT(black, 1'000'000u);
}

// Over all positions, not only those at which an error would change an entry.
TEST(FastLutTest, NoPositionIsWrongByMoreThanTheGuard) {
  double tightest = 0;
  for (const lens_view_t& view : lenses()) {
    SCOPED_TRACE(name(view, kSizes[0]));
    Lens lens(view, kSizes[0]);
    const double error = lens.worst_error(17);
    EXPECT_LE(error, lens.fast().guard);
    EXPECT_LT(lens.fast().guard, (1u << FAST_LUT_FRACTION) / 4096) << "1/4096 px";
    tightest = std::max(tightest, error / lens.fast().guard);
  }
  std::printf("  largest error: %.0f %% of the guard\n", 100 * tightest);
  EXPECT_GT(tightest, 0.5) << "the bound is far too large";
}

TEST(FastLutTest, WithoutAGuardEntriesAreWrong) {
  std::size_t wrong = 0;
  for (const lens_view_t& view : lenses()) {
    Lens lens(view, kSizes[0]);
    lens.fast().guard = 0;
    wrong += lens.differing();
  }
  EXPECT_GT(wrong, 30u);
}

TEST(FastLutTest, AWrongPieceIsSeen) {
  const lens_view_t view = view_of(LENS_EQUISOLID, 180, 200);
  Lens lens(view, kSizes[0]);
  ASSERT_EQ(lens.differing(), 0u);
  const std::uint32_t guard = lens.fast().guard;
  // As much as makes the first column wrong by 20 guards; the middle piece is nearer to the axis.
  fast_lut_piece_t& piece = lens.fast().piece[lens.fast().piece_count / 2];
  const double x = std::abs(lens.fast().column[0].x) / 4294967296.0;
  piece.c0 += static_cast<std::int32_t>(20 * guard / x);
  EXPECT_GT(lens.worst_error(1), guard);
  EXPECT_GT(lens.differing(), 0u);
}

/// Independent of the standard library's distributions.
class Random {
 public:
  double between(double low, double high) {
    return low + (high - low) * (static_cast<double>(generator_()) / 4294967296.0);
  }
  unsigned below(unsigned n) { return generator_() % n; }

 private:
  std::mt19937 generator_{2024};
};

TEST(FastLutTest, RandomLensesGiveTheTableInDoublePrecision) {
  Random random;
  unsigned refused = 0;
  for (unsigned n = 0; n < 600; ++n) {
    lens_view_t view = view_of(1 + random.below(6), random.between(20, 175));
    const Size size = {2 + 2 * random.below(120), 1 + random.below(160)};
    view.pair_method = random.below(2);
    const double scale = size.width / 2.0;
    if (random.below(4) != 0) view.focal_px = scale * std::exp(random.between(-2, 1.5));
    if (random.below(4) != 0) view.out_focal_px = scale * std::exp(random.between(-3, 2));
    if (random.below(2)) view.shift_x = random.between(-50, 50);
    if (random.below(2)) view.shift_y = random.below(2) ? random.between(-50, 50) : -0.5;
    if (random.below(2)) view.centre_x = random.between(-50, 50);
    if (random.below(2)) view.centre_y = random.between(-50, 50);
    if (random.below(2)) view.in_aspect = std::exp(random.between(-1, 1));
    if (random.below(2)) view.out_aspect = std::exp(random.between(-1, 1));
    if (random.below(2)) view.theta_max = random.between(0.05, 1.8);
    if (view.mapping == LENS_TABLE) {
      set_table(view, scale, 2 + random.below(128), random.between(0.2, 1.7));
      const double roughness = random.below(2) ? 0 : random.between(0, 0.9);
      double rise = 0;
      for (unsigned i = 1; i < view.table_count; ++i) {
        rise += 1 + random.between(-roughness, roughness);
        if (roughness > 0) view.table_r[i] = scale * rise / view.table_count;
      }
    }
    SCOPED_TRACE(testing::Message() << n << ": " << name(view, size));
    Lens lens(view, size, 512);
    if (lens.result() != FAST_LUT_OK) {
      ++refused;
      continue;
    }
    EXPECT_EQ(lens.differing(), 0u);
    EXPECT_LE(lens.worst_error(7), lens.fast().guard);
  }
  std::printf("  %u of 600 refused\n", refused);
  EXPECT_LE(refused, 60u);
}

// The largest angle shown is that of a position, or the next number above or below.
TEST(FastLutTest, TheRimIsExact) {
  Random random;
  const Size size = {200, 150};
  for (unsigned n = 0; n < 300; ++n) {
    lens_view_t view = view_of(1 + random.below(6), 150, 60);
    view.focal_px = 70;
    if (view.mapping == LENS_TABLE) set_table(view, 70, 33, 1.5);
    const double x = (2 * random.below(100) - 99.5) / 60, y = (random.below(150) - 74.5) / 60;
    const double theta = std::atan(std::sqrt(x * x + y * y));
    view.theta_max = std::nextafter(theta, random.below(3));
    if (n % 3 == 0) view.theta_max = theta;
    SCOPED_TRACE(n);
    Lens lens(view, size, 512);
    ASSERT_EQ(lens.result(), FAST_LUT_OK);
    EXPECT_EQ(lens.differing(), 0u);
    EXPECT_GE(lens.exact_entries, 1u);
  }
  for (double theta : {1e-9, 1e-5, 0.003}) {
    lens_view_t view = view_of(LENS_LINEAR, 150, 60);
    view.theta_max = theta;
    view.shift_x = 0.5 - 1;  // position 50, 74 ...
    view.shift_y = 0.5;      // ... is on the axis
    Lens lens(view, {102, 150}, 512);
    ASSERT_EQ(lens.result(), FAST_LUT_OK);
    EXPECT_EQ(lens.differing(), 0u) << theta;
  }
}

// Views so wide that a unit of s counts, and lenses so small that a long piece were exact enough:
// its coefficients would not fit.
TEST(FastLutTest, ExtremesThatAreAcceptedAreRight) {
  lens_view_t view = view_of(LENS_LINEAR, 90, 0.105);
  view.focal_px = 2.3;
  double worst = 0;
  for (int n = 0; n < 8; ++n) {
    view.shift_x = view.shift_y = -0.42 - 0.01 * n;  // a position near the axis, where s is steep
    Lens wide(view, kSizes[3]);
    ASSERT_EQ(wide.result(), FAST_LUT_OK);
    EXPECT_EQ(wide.differing(), 0u);
    const double error = wide.worst_error(1);
    EXPECT_LE(error, wide.fast().guard);
    worst = std::max(worst, error);
  }
  EXPECT_GT(worst, 16) << "no more than interpolation and rounding";
  for (std::uint32_t mapping = LENS_LINEAR; mapping <= LENS_STEREOGRAPHIC; ++mapping)
    for (double focal : {0.5, 0.05, 0.005}) {
      view = view_of(mapping, 90, 0.005);
      view.focal_px = focal;
      Lens lens(view, {64, 48}, 128);
      ASSERT_EQ(lens.result(), FAST_LUT_OK) << mapping;
      EXPECT_EQ(lens.differing(), 0u) << mapping;
      EXPECT_LE(lens.worst_error(1), lens.fast().guard) << mapping;
    }
}

// All of a picture's positions on boundaries: every entry is an exact one, and right.
TEST(FastLutTest, PositionsOnBoundariesAreLeftToDoublePrecision) {
  lens_view_t view = view_of(LENS_RECTILINEAR, 90);
  view.shift_y = 0.5;
  Lens lens(view, {64, 48}, 128);
  ASSERT_EQ(lens.result(), FAST_LUT_OK);
  EXPECT_EQ(lens.differing(), 0u);
  EXPECT_EQ(lens.exact_entries, 32u * 48u);
}

TEST(FastLutTest, WhatItCannotDoIsRefused) {
  const auto result = [](const lens_view_t& view, Size size = kSizes[0]) {
    return Lens(view, size).result();
  };
  EXPECT_EQ(result(view_of(LENS_NONE, 0)), FAST_LUT_NO_LENS);

  // The middle of the picture plus half a pixel is column 360.
  lens_view_t view = view_of(LENS_EQUISOLID, 180);
  view.centre_x = 8191 - 360 - 0.001;
  EXPECT_EQ(result(view), FAST_LUT_OK);
  view.centre_x = 8191 - 360;
  EXPECT_EQ(result(view), FAST_LUT_RANGE);
  view.centre_x = -8191 - 360 + 0.001;
  EXPECT_EQ(result(view), FAST_LUT_OK);
  view.centre_x = -8191 - 360;
  EXPECT_EQ(result(view), FAST_LUT_RANGE);
  view.centre_x = std::nan("");
  EXPECT_EQ(result(view), FAST_LUT_RANGE);
  view = view_of(LENS_EQUISOLID, 180);
  view.centre_y = 8191 - 288;
  EXPECT_EQ(result(view), FAST_LUT_RANGE);
  for (double bad : {std::nan(""), HUGE_VAL, 1e300}) {
    view = view_of(LENS_EQUISOLID, 180);
    view.shift_x = bad;
    EXPECT_EQ(result(view), FAST_LUT_RANGE);
    view = view_of(LENS_EQUISOLID, 180);
    view.shift_y = bad;
    EXPECT_EQ(result(view), FAST_LUT_RANGE);
  }

  // Bends so much near the axis that pieces of two and three units are not accurate enough.
  view = view_of(LENS_TABLE, 0);
  view.table_count = 3;
  view.table_r[0] = 0;
  view.table_r[1] = 0.5;
  view.table_r[2] = 0.7;
  view.theta_max = 0.1;
  view.out_focal_px = 0.5;
  view.focal_px = 0;
  for (const Size& size : kSizes) EXPECT_NE(result(view, size), FAST_LUT_NO_LENS);

  // 2^13 * 31/32 px from the centre; the picture's edge is 360.5 px from it, behind the last pixel.
  view = view_of(LENS_RECTILINEAR, 90, 1);
  view.focal_px = 7935.9 / 360.5;
  EXPECT_EQ(result(view), FAST_LUT_OK);
  view.focal_px = 7936.1 / 360.5;
  EXPECT_EQ(result(view), FAST_LUT_RANGE);
  view.focal_px = 20;
  view.in_aspect = 7935.9 / 288.5 / 20;
  EXPECT_EQ(result(view), FAST_LUT_OK);
  view.in_aspect = 7936.1 / 288.5 / 20;
  EXPECT_EQ(result(view), FAST_LUT_RANGE);

  // So wide a view that a unit of s moves a position by more than 1/256 px.
  view = view_of(LENS_LINEAR, 90, 0.105);
  view.focal_px = 2.3;
  EXPECT_EQ(result(view), FAST_LUT_OK);
  view = view_of(LENS_LINEAR, 90, 0.084);
  view.focal_px = 1.84;
  EXPECT_EQ(result(view), FAST_LUT_GUARD);

  view = view_of(LENS_TABLE, 0, 120);
  set_table(view, 230, 129, 1.6);
  for (unsigned i = 1; i < 129; ++i) view.table_r[i] = 5 * i + (i % 2 ? 4.9 : 0);
  EXPECT_EQ(result(view), FAST_LUT_PIECES);

  // tan(theta) squared up to 1e8.
  view = view_of(LENS_LINEAR, 90, 0.04);
  view.focal_px = 0.3;
  EXPECT_EQ(result(view), FAST_LUT_RANGE);

  // A gain that rises from next to nothing to 4000 px within three units of s.
  view = view_of(LENS_TABLE, 0, 250);
  set_table(view, 4000, 129, 1e-3);
  for (unsigned i = 1; i < 64; ++i) view.table_r[i] = 1e-6 * i;
  EXPECT_EQ(result(view), FAST_LUT_RANGE);

  for (int r = FAST_LUT_OK; r < FAST_LUT_RESULTS; ++r)
    EXPECT_NE(std::string(fast_lut_result_text(static_cast<fast_lut_result_t>(r))), "unknown");
}

// The largest pictures that lens_init() accepts.
TEST(FastLutTest, LargePicturesFit) {
  const lens_view_t view = view_of(LENS_EQUISOLID, 180);
  for (const Size size : {Size{4096, 4}, Size{2, 4096}, Size{2, 1}}) {
    Lens lens(view, size, 8192);
    ASSERT_EQ(lens.result(), FAST_LUT_OK) << size.width;
    EXPECT_EQ(lens.differing(), 0u) << size.width;
  }
}

}  // namespace
