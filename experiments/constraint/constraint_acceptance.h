// SPDX-License-Identifier: Apache-2.0
// What an operator would ask of the constraint before trusting it with a blade, each as one figure in SI
// units. Shipped operator's robot, ten per cent off its file, with friction and encoder counts; virtual time.
#pragma once

#include <vector>

#include "experiments/constraint/constraint_trial.h"

namespace telekerf::experiments {

/// Rate w of (1 + w t) e^(-w t), fitted to the true error from half a millimetre, over the rate that was
/// chosen (eq. 65). The tool rests at the edge of a corridor, then the corridor closes at once.
struct Decay {
  double rate_rad_s = 0.0;
  double chosen_rad_s = 0.0;
  double worst_residual_m = 0.0;  ///< of the fit
  std::vector<double> t_s, error_m, ideal_m;
};
Decay measure_decay(std::uint64_t seed, double mismatch = 0.1);

/// Mean force along the curve that keeps 20 mm/s round a circle, less the chosen virtual damping's.
double glide_force_n(std::uint64_t seed);
/// Least force along the curve that moves the tool by half a millimetre within a second.
double breakaway_force_n(std::uint64_t seed);
/// Speed along the curve with the hand off, over 8 s after it let go.
double drift_m_per_s(const ContourMessage& contour, std::uint64_t seed);

/// Largest move across the curve within 0.2 s after letting go, over many moments of work and out of a steady
/// 3 N push.
double letting_go_m(const ContourMessage& contour, std::uint64_t seed);

/// Nothing but a steady sideways force for half a second, then nothing.
struct Fight {
  double force_n = 0.0;
  double pushed_off_m = 0.0;    ///< largest
  double overshoot_m = 0.0;     ///< to the other side, after it ended
  double back_s = 0.0;          ///< until it stays within 50 um
  double return_m_per_s = 0.0;  ///< fastest, after it ended
  bool saturated = false;       ///< a motor reached its limit
  bool broken = false;          ///< the robot ended in a pose without kinematics
};
Fight fight(double force_n, std::uint64_t seed);

/// Free in a corridor of half a millimetre to either side, guided for some seconds, free again: how far a 3 N
/// push goes beyond the wall.
struct Region {
  double beyond_wall_m = 0.0;
  double used_m = 0.0;  ///< how far from the curve the hand came
};
Region measure_region(std::uint64_t seed);

}  // namespace telekerf::experiments
