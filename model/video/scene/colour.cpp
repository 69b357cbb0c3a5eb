#include "model/video/scene/colour.h"

#include "model/common/check.h"

namespace fovea::video {
namespace {

void check_image(const RgbImage& image) {
  if (image.width == 0 || image.height == 0)
    throw UserError("scene picture is empty: it needs at least 1x1 pixels");
  if (image.rgb.size() != std::size_t{image.width} * image.height * 3)
    throw UserError("scene picture of " + std::to_string(image.width) + "x" +
                    std::to_string(image.height) + " has " + std::to_string(image.rgb.size()) +
                    " bytes: 3 per pixel are needed");
}

}  // namespace

YCbCr to_ycbcr(std::uint8_t r, std::uint8_t g, std::uint8_t b) {
  const int y = 16 + ((66 * r + 129 * g + 25 * b + 128) >> 8);
  const int cb = 128 + ((-38 * r - 74 * g + 112 * b + 128) >> 8);
  const int cr = 128 + ((112 * r - 94 * g - 18 * b + 128) >> 8);
  return {static_cast<std::uint8_t>(y), static_cast<std::uint8_t>(cb),
          static_cast<std::uint8_t>(cr)};
}

void SampledImage::assign(const RgbImage& image) {
  check_image(image);
  width_ = image.width;
  height_ = image.height;
  stride_ = std::size_t{image.width} + 2;
  max_x_ = static_cast<float>(image.width) - 0.5f;
  max_y_ = static_cast<float>(image.height) - 0.5f;
  lanes_.resize(stride_ * (std::size_t{height_} + 2));
  for (unsigned row = 0; row < height_ + 2; ++row) {
    const unsigned y = row == 0 ? 0 : row > height_ ? height_ - 1 : row - 1;
    std::uint64_t* out = lanes_.data() + row * stride_;
    const std::uint8_t* p = image.pixel(0, y);
    for (unsigned x = 0; x < width_; ++x, p += 3) out[x + 1] = lanes(to_ycbcr(p[0], p[1], p[2]));
    out[0] = out[1];
    out[width_ + 1] = out[width_];
  }
}

void pack_row(const std::uint64_t* lanes, unsigned width, std::uint8_t* uyvy) {
  FOVEA_CHECK(width % 2 == 0, "4:2:2 rows have an even number of pixels");
  // Both chroma lanes are filtered at once: 255 * 4 + 2 fits into 16 bits.
  constexpr std::uint64_t kTwo = 2ull << 16 | 2ull << 32;
  constexpr std::uint64_t kChroma = 0x0000'ffff'ffff'0000;
  for (unsigned x = 0; x < width; x += 2, uyvy += 4) {
    const std::uint64_t left = lanes[x == 0 ? 0 : x - 1];
    const std::uint64_t sum =
        (left & kChroma) + 2 * (lanes[x] & kChroma) + (lanes[x + 1] & kChroma) + kTwo;
    uyvy[0] = static_cast<std::uint8_t>(sum >> 18);
    uyvy[1] = static_cast<std::uint8_t>(lanes[x]);
    uyvy[2] = static_cast<std::uint8_t>(sum >> 34);
    uyvy[3] = static_cast<std::uint8_t>(lanes[x + 1]);
  }
}

Picture to_picture(const RgbImage& image) {
  check_image(image);
  if (image.width % 2 != 0)
    throw UserError("scene picture is " + std::to_string(image.width) +
                    " pixels wide: 4:2:2 needs an even width");
  Picture picture(image.width, image.height);
  std::vector<std::uint64_t> row(image.width);
  for (unsigned y = 0; y < image.height; ++y) {
    const std::uint8_t* p = image.pixel(0, y);
    for (unsigned x = 0; x < image.width; ++x, p += 3)
      row[x] = SampledImage::lanes(to_ycbcr(p[0], p[1], p[2]));
    pack_row(row.data(), image.width, picture.row(y));
  }
  return picture;
}

}  // namespace fovea::video
