// SPDX-License-Identifier: Apache-2.0
// A delta robot in the computer: eq. 20 integrated by Runge-Kutta behind the hardware seam.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "common/robot/drivers/drive.h"
#include "common/robot/dynamics.h"
#include "common/robot/hall_sensor.h"
#include "common/robot/robot.h"
#include "common/robot/robot_model.h"

namespace telekerf::robot {

/// The plant of a run. It moves only in advance(): the caller owns the time, real or virtual. Same model,
/// seed and calls: same motion, bit by bit.
class SimulatedRobot final : public Robot {
 public:
  /// Largest inner step of the integrator.
  static constexpr double kInnerStep_s = 1e-4;

  /// At rest at `tool_in_base_m`. `true_model` may differ from what the controllers are given (see
  /// mismatched()). Throws StartupError if the pose cannot be taken.
  SimulatedRobot(const RobotModel& true_model, std::uint64_t seed, const Vec3& tool_in_base_m);

  JointReading read() noexcept override;
  /// Held until the next call; clipped to the motors' peak force.
  void write(const Vec3& currents_a) noexcept override;
  Capabilities capabilities() const override;

  /// Integrates `dt_s` with the currents and the tool's force held.
  void advance(double dt_s) noexcept;
  /// Force of the world on the tool, in base: the operator's hand.
  void set_tool_force(const Vec3& force_in_base_n) noexcept { tool_force_n_ = force_in_base_n; }

  /// The truth, for judges and plots; no controller reads it.
  const Vec3& true_tool_in_base_m() const noexcept { return state_.tool_m; }
  const Vec3& true_tool_velocity_m_per_s() const noexcept { return state_.tool_velocity_m_per_s; }
  const DeltaState& true_state() const noexcept { return state_; }
  const RobotModel& true_model() const noexcept { return model_; }
  double energy_j() const noexcept { return energy(model_, kinematics_, state_); }
  double time_s() const noexcept { return time_s_; }
  /// Set for good when the motion ran into a pose without kinematics; the robot then stands still.
  bool broken() const noexcept { return broken_; }

 private:
  bool acceleration(const DeltaState& state, Vec3& out) const noexcept;
  void inner_step(double h) noexcept;

  RobotModel model_;
  DeltaKinematics kinematics_;  // strokes widened: the end stops are springs, not walls
  DeltaState state_;
  Vec3 motor_force_n_ = Vec3::Zero();
  Vec3 tool_force_n_ = Vec3::Zero();
  Vec3 encoder_phase_m_ = Vec3::Zero();
  struct HallJoint {
    HallSensor sensor;
    HallDecoder decoder;
  };
  std::vector<HallJoint> hall_;  // empty: encoders
  /// Where the joints were when what is read now was measured.
  Vec3 read_joints_m() const noexcept;
  struct Past {
    double time_s;
    Vec3 joints_m;
  };
  std::vector<Past> past_;  // ring of the last steps, for a drive whose readings are old; empty: none is
  std::size_t newest_ = 0;
  double time_s_ = 0;
  std::uint64_t reads_ = 0;
  bool broken_ = false;
};

Drive open_simulated_drive(std::string_view rest, const DriveNeeds& needs);
inline constexpr DriveKind kSimulatedDrive{"simulated", "simulated", no_argument, open_simulated_drive};

}  // namespace telekerf::robot
