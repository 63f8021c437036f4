// SPDX-License-Identifier: Apache-2.0
// From y(x) to x(t), y(t): denser points, and steps of the length that a tangential speed asks for
// (thesis 3.1.5, 3.2).
#pragma once

#include <Eigen/Core>
#include <functional>
#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "common/geometry/polyline.h"

namespace telekerf::geometry {

/// Eq. 5: `times` passes of the sliding quadratic; N -> 2^k (N - 1) + 1 points, closed with wrap 2^k N. The
/// limit curve is C1 only and depends on the direction: never differentiate it. Lines of fewer than three
/// points come back unchanged.
Polyline doubled(const Polyline& line, int times);

/// Tangential speed in m/s at a time and a distance travelled.
using SpeedLaw = std::function<double(double time_s, double arc_length_m)>;
inline SpeedLaw constant_speed(double speed_m_per_s) {
  return [speed_m_per_s](double, double) { return speed_m_per_s; };
}

/// What becomes of the last step, which fits by luck only.
enum class Remainder {
  kStretch,    ///< all steps are scaled a little so that the last one ends on the end (constant speed law
               ///< wanted)
  kShortStep,  ///< the end is reached by one shorter step
};

struct StepSettings {
  double period_s = 1e-3;
  Remainder remainder = Remainder::kShortStep;
  std::size_t max_steps = 20'000'000;  ///< a speed of almost zero must not fill the memory
};

/// References at each period, the first at the line's start; a closed line ends where it began.
struct Steps {
  std::vector<Vec2> points_m;
  std::vector<double> arc_lengths_m;  ///< distance travelled along the line
  double speed_scale = 1.0;           ///< what kStretch made of the speed
};

/// Eq. 6-7 solved exactly: each point lies at the *chord* R = V T from its predecessor. Searches forwards
/// only, so crossings do no harm; cuts corners by up to R/2 and travels R^2 / (24 rho^2) more arc than chord.
tl::expected<Steps, std::string> chord_steps(const Polyline& line, const SpeedLaw& speed,
                                             const StepSettings& settings);
/// The same with R measured along the line.
tl::expected<Steps, std::string> arc_steps(const Polyline& line, const SpeedLaw& speed,
                                           const StepSettings& settings);

/// Eq. 10 for a whole path at constant height; `inverse` returns false where the machine cannot reach. The
/// error names the first such point.
using InverseKinematics = std::function<bool(const Eigen::Vector3d& tool_in_base_m, Eigen::Vector3d& joints)>;
tl::expected<std::vector<Eigen::Vector3d>, std::string> to_joint_space(const std::vector<Vec2>& points_m,
                                                                       double z_m,
                                                                       const InverseKinematics& inverse);

}  // namespace telekerf::geometry
