// SPDX-License-Identifier: Apache-2.0
// Calibration with a printed grid: at several magnifications the grid is brought into focus and measured.
#pragma once

#include <functional>
#include <opencv2/core/mat.hpp>
#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "slave/vision/imaging/grid_view.h"
#include "slave/vision/imaging/imaging_model.h"

namespace telekerf::imaging {

/// An imaging unit as the routine uses it.
struct CalibrationRig {
  /// Brings the magnification there; the focus stays. The error is one sentence.
  std::function<tl::expected<void, std::string>(double magnification_m)> zoom;
  /// Brings the focus there, from below, and takes a picture: 8-bit grey levels.
  std::function<tl::expected<cv::Mat, std::string>(double focus_m)> look;
  std::function<AxisPositions()> positions;
  double lowest_m = 0.0;  ///< of the focus axis
  double highest_m = 0.0;
};

struct CalibrationSettings {
  double pitch_m = 0.5e-3;  ///< of the grid
  int magnifications = 6;   ///< evenly over the travel
  double region = 0.5;      ///< share of the picture that the focus is judged by
};

struct Calibration {
  ImagingModel model;
  std::vector<AxisPositions> places;  ///< where the grid was in focus
  std::vector<GridView> views;        ///< what was seen there
  double scale_residual = 0.0;        ///< largest deviation of a view's scale from the model, as a share
};

/// `known`: travels, optics, and about where ridge and scale are (20 % off will do). The error is one
/// sentence.
tl::expected<Calibration, std::string> calibrate(const CalibrationRig& rig, const ImagingModel& known,
                                                 const CalibrationSettings& settings);

}  // namespace telekerf::imaging
