// How alike two pictures are, in their luma.
#pragma once
#include "model/video/core/picture.h"

namespace fovea::video {

/// Peak signal-to-noise ratio in dB, of 255; infinite if all luma samples are equal. @throws UserError if the sizes
/// differ
double psnr_y(const Picture& a, const Picture& b);

/// Structural similarity (Wang, Bovik, Sheikh, Simoncelli, IEEE Trans. Image Processing 13-4, 2004): Gaussian window of
/// 11 x 11 with a standard deviation of 1.5, K1 = 0.01, K2 = 0.03, L = 255; the mean over all windows that lie in the
/// picture. @throws UserError if the sizes differ, or are below 11
double ssim_y(const Picture& a, const Picture& b);

}  // namespace fovea::video
