// SPDX-License-Identifier: Apache-2.0
// Thesis 8.3 read out of a run's record: both motions along the contour, their speeds, and what the beam left
// where the operator held the button.
#pragma once

#include <nlohmann/json.hpp>
#include <vector>

#include "common/recording/run_record.h"
#include "common/workpiece/workpiece.h"

namespace telekerf::experiments {

/// What the slave did at one of its ticks, and what the master had done at the tick that was applied then.
struct RemoteSample {
  double time_s = 0.0;             ///< of the slave, since its first one
  Vec2 master_m = Vec2::Zero();    ///< master's workpiece frame
  Vec2 slave_m = Vec2::Zero();     ///< workpiece frame
  Vec2 rescaled_m = Vec2::Zero();  ///< slave / beta
  /// Along the contour in its drawing direction.
  double master_m_per_s = 0.0, slave_m_per_s = 0.0, rescaled_m_per_s = 0.0;
  bool beam = false;
};

/// A hundred samples a second, from the end of the first approach on, while the slave follows.
std::vector<RemoteSample> remote_motion(const RunRecord& record);

/// The same of every tick: a row of CSV each, a head above. Lengths in m, speeds in m/s along the contour.
std::string motion_csv(const RunRecord& record);

/// Speeds of both in mm/s, and how far they are from each other when the slave's is rescaled.
nlohmann::ordered_json speed_json(const std::vector<RemoteSample>& motion);

/// The factor between both motions, by least squares about their means; null without a motion.
nlohmann::ordered_json measured_beta(const std::vector<RemoteSample>& motion);

/// Ticks with the beam on, those among them at which the operator did not hold the button (at the tick that
/// was applied), and the share of the time with the button held.
nlohmann::ordered_json button_json(const RunRecord& record);

enum class BeamPower {
  kConstant,  ///< as the thesis' laser: what the operator's speed is decides the depth
  kRecorded,  ///< what the slave asked for, which follows the speed
};

/// Along the contour, of its bins; those that the beam did not reach have neither dwell nor depth.
struct DepthAlong {
  std::vector<double> arc_m = {};
  std::vector<double> dwell_s_per_m = {};  ///< with the beam on, all passes together
  std::vector<double> depth_m = {};        ///< mean over the bin
};

struct RemoteMark : DepthAlong {
  workpiece::Workpiece workpiece;
};

/// Throws StartupError if the record has no contour.
RemoteMark burn_record(const RunRecord& record, const workpiece::Material& material, BeamPower power,
                       double laser_w);

/// Marked is a bin of 0.25 mm in which, as in both of its neighbours, the beam was on for a tick or more: its
/// share of the contour, mean and largest depth of what was marked, its spread as a share of the mean, the
/// share that is cut through, how the depth goes with the dwell (Pearson's correlation), and what the beam
/// left where it was never on.
nlohmann::ordered_json mark_json(const RemoteMark& mark);

}  // namespace telekerf::experiments
