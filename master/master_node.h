// SPDX-License-Identifier: Apache-2.0
// The master: constraint generator and controller, state machine, command stream. Pure: the same node runs in
// its process and in virtual time.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "common/control/acceleration_control.h"
#include "common/control/friction_feedforward.h"
#include "common/protocol/messages.h"
#include "common/robot/robot.h"
#include "common/robot/robot_model.h"
#include "common/streaming/link_statistics.h"
#include "master/command_stream.h"
#include "master/constraint/constraint.h"
#include "master/force_feedback.h"

namespace telekerf::master {

struct MasterSettings {
  double control_hz = 1000.0;
  double stream_hz = 1000.0;
  double observer_rad_s = 500.0;   ///< of the disturbance observer
  double approach_m_per_s = 0.05;  ///< mean speed at which the tool is brought to the curve
  double stale_s = 0.5;            ///< no state of the slave for this long: disengage
  CommandStreamSettings command;   ///< law, observer and codec of the command stream
  ConstraintSettings constraint;
};

struct MasterInputs {
  robot::JointReading joints;
  std::span<const Received<StateBlock>> states;  ///< since the last step, in order of arrival
  std::span<const EventMessage> events;
  const GuidePath* guide = nullptr;    ///< null: no contour yet; outlives the step after which it is another
  bool button = false;                 ///< the pen's laser button
  bool engage = false;                 ///< the operator wants the slave to follow
  std::optional<ConstraintMode> form;  ///< guidance or corridor from now on; none: as it is
};

enum class MasterMode : std::uint8_t {
  kIdle,      ///< no contour: holds its pose
  kApproach,  ///< brings the tool to the curve
  kGuiding,   ///< the hand moves on the curve, the slave does not follow
  kEngaged,   ///< the slave follows
  kStopped,   ///< latched emergency stop: holds its pose
};

struct MasterOutputs {
  Vec3 currents_a = Vec3::Zero();
  std::optional<CommandBlock> command;
  MasterMode mode = MasterMode::kIdle;
  Vec3 tool_m = Vec3::Zero();  ///< measured, master's workpiece frame
  Vec3 velocity_m_per_s = Vec3::Zero();
  Vec3 acceleration_m_per_s2 = Vec3::Zero();  ///< commanded to the tool
  Vec3 hand_n = Vec3::Zero();                 ///< estimated force of the hand
  double constraint_n = 0.0;                  ///< how hard the constraint answers, across the curve
  double corridor_m = 0.0;                    ///< half width within which the hand is free; 0: guidance
  ActiveConstraint active;                    ///< the circle in force, while the hand is guided
  bool saturated = false;                     ///< a motor was at its limit
  Observed observed;                          ///< the slave, as the network observer predicts it
  SlaveForce slave_force;                     ///< on the slave's tool, as its states tell it
};

class MasterNode {
 public:
  MasterNode(const robot::RobotModel& model, const MasterSettings& settings, std::uint32_t epoch);

  MasterOutputs step(std::int64_t now_ns, const MasterInputs& inputs) noexcept;
  /// Emergency stop and its end alone; step() does it itself. For a robot that does not tell yet where it
  /// stands.
  void heed(std::span<const EventMessage> events) noexcept;

  const LinkStatistics& link() const noexcept { return link_; }
  Tick tick() const noexcept { return tick_; }
  const Observed& observed() const noexcept { return stream_.observed(); }
  /// The slave's newest state block; meaningful once link().states() > 0.
  const StateBlock& slave() const noexcept { return slave_; }

 private:
  struct Tool {
    Vec3 position_m = Vec3::Zero();
    Vec3 velocity_m_per_s = Vec3::Zero();
  };
  void choose_mode(std::int64_t now_ns, const MasterInputs& inputs, const Tool& tool) noexcept;
  Vec3 held(const Tool& tool, const Vec3& goal_m, const Vec3& goal_velocity,
            const Vec3& goal_acceleration) const noexcept;
  Vec3 approach(const Tool& tool) noexcept;

  robot::RobotModel model_;
  robot::DeltaKinematics kinematics_;
  MasterSettings settings_;
  control::AccelerationControl acceleration_;
  control::FrictionFeedforward friction_;
  robot::Mat3 inertia_kg_ = robot::Mat3::Identity();
  double dt_s_;
  Tick tick_ = 0;
  bool started_ = false;

  MasterMode mode_ = MasterMode::kIdle;
  ConstraintController constraint_;
  const GuidePath* guide_ = nullptr;
  Vec3 hold_m_ = Vec3::Zero();
  Vec3 approach_from_m_ = Vec3::Zero();
  Vec3 approach_to_m_ = Vec3::Zero();
  double approach_s_ = 0.0;
  double approach_duration_s_ = 0.0;

  CommandStream stream_;
  ForceFeedback force_;
  LinkStatistics link_;
  StateBlock slave_;
  std::int64_t slave_heard_ns_ = 0;
};

}  // namespace telekerf::master
