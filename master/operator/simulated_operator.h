// SPDX-License-Identifier: Apache-2.0
// Where hand motion comes from without a hand: a seeded simulated operator.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "common/geometry/nearest.h"
#include "common/protocol/messages.h"
#include "master/operator/operator_disturbance.h"

namespace telekerf::master {

/// What the simulated hand does to the pen.
struct HandSample {
  Vec3 force_n = Vec3::Zero();  ///< on the tool, master's workpiece frame
  bool trigger = false;         ///< the laser is wanted
};

struct SimulatedOperatorSettings {
  double speed_m_per_s = 0.02;       ///< mean along the curve
  double stiffness_n_per_m = 250.0;  ///< of the arm
  double damping_n_s_per_m = 8.0;
  double lead_m = 3e-3;                           ///< the hand aims at most this far ahead of the pen
  double max_sideways_n = 3.0;                    ///< how hard it pushes off the curve at most
  std::optional<double> wander_n;                 ///< rms of the sideways push; without: 2/3 of the most
  double tremor_n = 0.05;                         ///< amplitude, 9 Hz
  double press_share = 0.8;                       ///< of the time that the button is held, in stretches
  std::vector<OperatorDisturbance> disturbances;  ///< beside the work
};

/// An arm that wants to go round and round the curve (to and fro on an open one) but wanders off it:
/// impedance to a point that runs along the curve, a slowly varying sideways push (bounded), tremor, and a
/// button pressed in stretches. Same seed, same hand.
class SimulatedOperator {
 public:
  SimulatedOperator(const geometry::Polyline& curve_m, const SimulatedOperatorSettings& settings,
                    std::uint64_t seed);
  /// `tool_m`, `velocity_m_per_s`: the pen's true state, master workpiece frame. `guided`: the constraint
  /// holds the pen.
  HandSample sample(double now_s, const Vec3& tool_m, const Vec3& velocity_m_per_s, bool guided) noexcept;

 private:
  double uniform() noexcept;
  double normal() noexcept;
  void choose_button(double now_s) noexcept;

  SimulatedOperatorSettings settings_;
  geometry::NearestIndex curve_;
  std::uint64_t random_;
  std::optional<double> goal_arc_m_;  ///< where on the curve the arm aims, once it is guided
  geometry::Nearest place_;           ///< of the pen on the curve
  std::optional<double> last_s_;
  double guided_since_s_ = 0.0;
  double pace_ = 1.0;  ///< slow variation of the speed
  double way_ = 1.0;   ///< -1: back along an open curve
  double sideways_n_ = 0.0;
  double tremor_phase_rad_ = 0.0;
  bool button_ = false;
  double button_until_s_ = 0.0;
};

}  // namespace telekerf::master
