// SPDX-License-Identifier: Apache-2.0
// Where the focus is at each magnification: a quadratic, learnt from locks by recursive least squares, with
// how well it is known.
#pragma once

#include <Eigen/Core>

#include "slave/vision/imaging/imaging_model.h"

namespace telekerf::imaging {

class RidgeEstimate {
 public:
  /// Nothing is known but the model's shape: where the workpiece lies, and how the ridge bends, has to be
  /// learnt.
  explicit RidgeEstimate(const ImagingModel& model);

  /// A focus was found there.
  void learn(const AxisPositions& lock);

  struct Prediction {
    double focus_m;
    double deviation_m;  ///< standard deviation
  };
  Prediction at(double magnification_axis_m) const;
  int locks() const noexcept { return locks_; }
  /// Into a model: where later runs begin.
  void write_to(ImagingModel& model) const;

 private:
  Eigen::Vector3d terms(double magnification_axis_m) const;

  double travel_m_;
  Eigen::Vector3d coefficients_m_;
  Eigen::Matrix3d covariance_m2_;
  int locks_ = 0;
};

}  // namespace telekerf::imaging
