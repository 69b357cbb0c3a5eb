// How alike two pictures are, in their luma.
#pragma once
#include <cstdint>
#include <vector>

#include "model/video/core/picture.h"

namespace fovea::video {

inline constexpr unsigned kSsimWindow = 11;  ///< side of the window of structural similarity

/// Peak signal-to-noise ratio in dB, of 255; infinite if all luma samples are equal. @throws UserError if the sizes
/// differ
double psnr_y(const Picture& a, const Picture& b);

/// Structural similarity (Wang, Bovik, Sheikh, Simoncelli, IEEE Trans. Image Processing 13-4, 2004): Gaussian window of
/// 11 x 11 with a standard deviation of 1.5, K1 = 0.01, K2 = 0.03, L = 255; the mean over all windows that lie in the
/// picture. @throws UserError if the sizes differ, or are below 11
double ssim_y(const Picture& a, const Picture& b);

/// Which pixels are compared, row by row: those that are not 0.
using PictureMask = std::vector<std::uint8_t>;

/// The same for a part of two pictures: of the compared pixels, and of the windows all of whose pixels are. Not a
/// number if there are none. @throws UserError if the sizes of pictures or mask differ
double psnr_y(const Picture& a, const Picture& b, const PictureMask& mask);
double ssim_y(const Picture& a, const Picture& b, const PictureMask& mask);

}  // namespace fovea::video
