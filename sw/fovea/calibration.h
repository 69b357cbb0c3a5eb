// Calibrations of fisheye lenses as OpenCV writes them, into the lens keys of an experiment.
#pragma once
#include <array>
#include <filesystem>

#include "sw/fovea/experiment.h"

namespace fovea::app {

/// A Kannala-Brandt lens in pixels of a picture of width x height.
struct Calibration {
  std::array<double, 8> kb{};        ///< fx fy cx cy k1 k2 k3 k4, as camera.kb has them
  unsigned width = 0, height = 0;    ///< 0: the file does not say
};

/// Reads YAML of OpenCV's FileStorage (`%YAML:1.0`, `!!opencv-matrix`) or plain YAML: the matrix
/// `camera_matrix` or `K`, four fisheye coefficients `dist_coeffs`, `distortion_coefficients` or
/// `D`, and `resolution`, `image_size` or `image_width` with `image_height`. Other keys are left
/// alone. @throws UserError naming the file
Calibration read_calibration(const std::filesystem::path& file);

/// Fills camera.kb and lens.kb with their sizes from camera.calibration and lens.calibration, which
/// defaults to the camera's. Numbers that were set in a place of higher precedence stay.
/// @throws UserError
void apply_calibrations(const ParamSet& params, Experiment& experiment);

}  // namespace fovea::app
