// SPDX-License-Identifier: Apache-2.0
// How old a drive's readings are, from a trial's record (drive_trial.h).
//
// A joint under forces that are held over each control period T, read D late: the second difference of three
// readings is the mean acceleration over the triangle from one period before to one after, D ago. With D =
// (n + f) T, 0 <= f < 1, the triangle weighs the accelerations asked for at the steps k - n, k - n - 1,
// k - n - 2 with (1 - f)^2 / 2, 1/2 + f (1 - f), f^2 / 2. So for a given D
//
//   (q[k+1] - 2 q[k] + q[k-1]) / T^2 = G a(D)[k] - friction(v[k]) + constant + stiffness q[k]
//
// is linear in all that is not known: G (masses and force constant off the file, and the joints' coupling),
// friction (viscous, and the file's two shapes of dry friction at any size), weight. D is where the fit is
// best. Both sides go through the same symmetric low-pass, which keeps the shaking's band and little of the
// sensor's noise. The trial's feedback is so slow that the noise in it can be left out of account.
#pragma once

#include <array>
#include <span>
#include <string>
#include <tl/expected.hpp>

#include "common/control/drive_trial.h"

namespace telekerf::control {

/// The longest that is looked for, control periods.
inline constexpr double kLongestDriveDelay = 8.0;

struct DriveDelay {
  struct Joint {
    double delay_s = 0.0;
    double gain = 0.0;  ///< measured over expected acceleration; 1: the file's inertia and force constant
    double explained = 0.0;  ///< share of the acceleration's variance that the fit explains
  };
  double delay_s =
      0.0;  ///< of all joints together, what `drive_delay_s` of a robot file says; never negative
  double deviation_s = 0.0;  ///< standard deviation over joints and quarters of the record
  double spread_s = 0.0;     ///< largest less least of these
  std::array<Joint, 3> joints;
  std::size_t steps = 0;  ///< that the fit used
  double missed = 0.0;    ///< share of the steps without a new reading
};

/// From samples `period_s` apart, shaken up to `highest_hz`. `friction`: the shapes (velocities) of the file.
/// The error says what is wrong, without a remedy: too few readings, a motion that the force does not
/// explain, or a delay that is not one.
tl::expected<DriveDelay, std::string> estimate_drive_delay(std::span<const DriveSample> samples,
                                                           const robot::Friction& friction, double period_s,
                                                           double highest_hz);

}  // namespace telekerf::control
