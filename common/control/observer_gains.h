// SPDX-License-Identifier: Apache-2.0
// Gains of an observer of position, velocity and a constant acceleration beside what is known, in closed
// form.
#pragma once

#include <cmath>

namespace telekerf::control {

/// Poles exp(-p T), one at the disturbance's bandwidth, two at the velocity's. Per sample and innovation e:
/// q += alpha e, v += beta / T e, w += gamma / T^2 e.
struct ObserverGains {
  double alpha, beta, gamma;
};

inline ObserverGains observer_gains(double bandwidth_rad_per_s, double velocity_bandwidth_rad_per_s,
                                    double period_s) noexcept {
  const double r1 = 1 - std::exp(-bandwidth_rad_per_s * period_s);
  const double r2 = 1 - std::exp(-velocity_bandwidth_rad_per_s * period_s);
  const double c1 = r1 + 2 * r2;
  const double c2 = 2 * r1 * r2 + r2 * r2;
  const double c3 = r1 * r2 * r2;
  return {c1 - c2 + c3, c2 - 1.5 * c3, c3};
}

}  // namespace telekerf::control
