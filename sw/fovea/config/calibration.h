// Reads fish-eye calibrations in OpenCV's formats into the lens keys of an experiment.
#pragma once
#include <array>
#include <filesystem>

#include "sw/fovea/config/experiment.h"

namespace fovea::app {

/// A Kannala–Brandt lens in pixels of a picture of width x height.
struct Calibration {
  std::array<double, 8> kb{};        ///< fx fy cx cy k1 k2 k3 k4, in the order of camera.kb
  unsigned width = 0, height = 0;    ///< 0: not in the file
};

/// Reads YAML of OpenCV's FileStorage (`%YAML:1.0`, `!!opencv-matrix`) or plain YAML: the matrix
/// `camera_matrix` or `K`; four fish-eye coefficients `dist_coeffs`, `distortion_coefficients` or
/// `D`; and `resolution`, `image_size`, or `image_width` with `image_height`. A file that names another lens model
/// (`distortion_model: plumb_bob`) is refused. Other keys are ignored. @throws UserError that names the file
Calibration read_calibration(const std::filesystem::path& file);

/// Sets camera.kb and lens.kb, with their sizes, from camera.calibration and lens.calibration
/// (default: the camera's). Values that were set with higher precedence are kept. @throws UserError
void apply_calibrations(const ParamSet& params, Experiment& experiment);

}  // namespace fovea::app
