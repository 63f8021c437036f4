// SPDX-License-Identifier: Apache-2.0
// The operator's station alone, in virtual time: what the constraint does under a hand, as figures.
#pragma once

#include <functional>
#include <numbers>
#include <vector>

#include "common/recording/run_record.h"
#include "master/station.h"

namespace telekerf::experiments {

struct TrialSettings {
  master::StationSettings station;
  double duration_s = 20.0;
  /// Changes of the form while it runs, by time since the hand was guided.
  std::function<std::optional<master::ConstraintMode>(double)> form;
};

struct Trial {
  // True tool to contour / beta, in plane, while guided.
  double rms_m = 0.0;
  double max_m = 0.0;
  /// What a tick's new circle changes in the velocity across that is asked for, up to 30 mm/s.
  double max_handover_m_per_s = 0.0;
  double bandwidth_rad_s = 0.0;  ///< across the curve, as chosen for the robot
  /// How far that change of velocity would throw the tool before the law has brought it to rest; to be held
  /// against one count of the encoder.
  double handover_m() const { return max_handover_m_per_s / (std::numbers::e * bandwidth_rad_s); }
  double mean_speed_m_per_s = 0.0;
  double travelled_m = 0.0;
  bool saturated = false;  ///< a motor was at its limit while guided
  bool broken = false;     ///< the robot ended in a pose without kinematics
  std::vector<MasterRow> rows;
  std::vector<double> off_m;  ///< signed distance of each row; NaN while not guided
  std::vector<double> constraint_n;
};

/// A hand on the shipped operator's robot. Deterministic.
Trial run_trial(const ContourMessage& contour, const TrialSettings& settings);

/// Rounded square whose sides bulge inwards: all its corners, the inward ones too, have this radius.
ContourMessage rounded_outline(double radius_m, double size_m);
ContourMessage circle_outline(double radius_m);
ContourMessage figure_eight_outline(double half_width_m);

}  // namespace telekerf::experiments
