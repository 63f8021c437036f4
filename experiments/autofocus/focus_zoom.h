// SPDX-License-Identifier: Apache-2.0
// Steps of the magnification once the ridge has been learnt, with the scale of a calibrated unit.
#pragma once

#include <cstdint>
#include <vector>

#include "experiments/autofocus/focus_trial.h"
#include "slave/vision/imaging/calibration.h"

namespace telekerf::experiments {

/// Calibrates a unit with its printed grid, in pictures of 640 x 480, from a model that is 10 % off in scale
/// and knows of no distortion. Throws StartupError if that fails.
imaging::Calibration calibrated_unit(std::uint64_t seed);

struct ZoomStep {
  bool found = false;
  int pictures = 0;
  double error_dof = 0.0;
  double scale_error = 0.0;  ///< metres per pixel against the truth, as a share
};

/// Four full searches along the travel teach the ridge; then `steps` steps to magnifications drawn at random.
std::vector<ZoomStep> zoom_steps(imaging::Target target, std::uint64_t seed, int steps,
                                 const imaging::ImagingModel& calibrated);

}  // namespace telekerf::experiments
