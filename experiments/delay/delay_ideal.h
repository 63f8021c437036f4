// SPDX-License-Identifier: Apache-2.0
// The estimators on an exact double integrator behind a constant delay: what theory can be held against.
#pragma once

#include <vector>

#include "master/observer/estimators.h"

namespace telekerf::experiments {

struct IdealStart {
  double position_m = 0.0;  ///< of the slave, while the observer believes it at rest in the origin
  double velocity_m_per_s = 0.0;
  double disturbance_m_per_s2 = 0.0;
};

/// Prediction error (m) over time, a value a millisecond, while the command is a slow sine.
std::vector<double> prediction_error(master::MakeEstimator estimator, double delay_s, double duration_s,
                                     const IdealStart& start);

/// Does u = -2 w v - w^2 x on the estimator's idea of the slave bring it to rest?
bool law_is_stable(master::MakeEstimator estimator, double w_rad_s, double delay_s);

}  // namespace telekerf::experiments
