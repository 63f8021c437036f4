// SPDX-License-Identifier: Apache-2.0
// A trial's samples as columns of a regression: what drive_delay.cpp fits, without the delay.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "common/control/drive_trial.h"

namespace telekerf::control {

/// Everything went through the same symmetric low-pass, which keeps the shaking's band and little of the
/// sensor's noise. A row a control step.
struct DriveRecord {
  Eigen::MatrixXd asked;     ///< accelerations asked for, m/s^2, a column a joint
  Eigen::MatrixXd measured;  ///< second differences of the readings, likewise
  Eigen::MatrixXd
      others;  ///< friction's shapes and place, of every joint because they are coupled, and a constant
  std::vector<Eigen::Index> steps;  ///< rows around which nothing is missing, `look_back` steps into the past
};

/// From samples `period_s` apart, shaken up to `highest_hz`; `friction`: its velocities shape the columns.
DriveRecord drive_record(std::span<const DriveSample> samples, const robot::Friction& friction,
                         double period_s, double highest_hz, Eigen::Index look_back);

}  // namespace telekerf::control
