// The pictures of a report: which, how large, and how two of them differ.
#pragma once
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "sw/fovea/files/rgb_image.h"
#include "sw/fovea/report/results.h"

namespace fovea::report {

/// A picture as the page embeds it.
struct Picture {
  std::string uri;                 ///< data URI of a PNG
  unsigned width = 0, height = 0;  ///< of the original
  unsigned shrunk = 1;             ///< each pixel of the page stands for shrunk x shrunk of them
};

/// What two pictures of equal size differ in.
struct PictureDifference {
  std::size_t pixels = 0, all = 0;  ///< pixels that differ, and all
  double psnr = 0;                  ///< dB over R, G and B; infinite if they are equal
};

struct CameraPicture {
  unsigned camera = 0;
  std::uint64_t frame = 0;  ///< the displayed frame for which the camera sent it
  Picture picture;
};

struct RunPictures {
  std::optional<std::uint64_t> frame;           ///< number in the files' names
  std::optional<Picture> before;                ///< what the camera sent
  std::optional<Picture> after;                 ///< what the display showed
  std::vector<CameraPicture> cameras;           ///< of a composed view, instead of `before`
  std::optional<PictureDifference> from_first;  ///< `after` against that of the first run
};

/// Of each run the first frame that has both pictures, or else the first displayed one; of a composed
/// view the last frame, since the first ones still lack parts, with what each camera sent last. All
/// pictures together take at most `budget` bytes of the page; larger ones are shrunk by averaging.
/// @throws UserError for a damaged picture
std::vector<RunPictures> choose_pictures(const std::vector<Results>& runs, std::size_t budget);

/// @return empty if the sizes differ
std::optional<PictureDifference> difference(const app::RgbImage& a, const app::RgbImage& b);
/// The mean of each factor x factor pixels; what is left over at the right and below is dropped.
app::RgbImage shrink(const app::RgbImage& image, unsigned factor);

}  // namespace fovea::report
