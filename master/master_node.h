// SPDX-License-Identifier: Apache-2.0
// The master: modes, constraint, command stream. Pure: the same node runs in its process and in virtual time.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <utility>

#include "common/control/joint_acceleration_control.h"
#include "common/control/loop_design.h"
#include "common/control/tracking_law.h"
#include "common/protocol/messages.h"
#include "common/robot/robot.h"
#include "common/robot/robot_model.h"
#include "common/streaming/link_statistics.h"
#include "common/streaming/state_receiver.h"
#include "master/command_stream.h"
#include "master/constraint/constraint_controller.h"
#include "master/dead_man.h"
#include "master/force_feedback.h"
#include "master/modes.h"

namespace telekerf::master {

struct MasterSettings {
  double control_hz = 1000.0;
  double stream_hz = 1000.0;
  double constraint_rad_s = 0.0;   ///< bandwidth across the curve; 0: chosen from the robot (loop_design.h)
  double observer_rad_s = 0.0;     ///< of the disturbance observer; 0: likewise
  double approach_m_per_s = 0.05;  ///< mean speed at which the tool is brought to the curve
  double stale_s = 0.5;            ///< no state of the slave for this long: disengage
  /// The button is passed on only while the tool is nearer to the contour than this, in the slave's size: neither a
  /// hand that pushes harder than the constraint holds is to be seen in the cut, nor a bend that is too tight for the
  /// master at a large scale. In a corridor the hand is free.
  double max_off_line_m = 10e-6;
  double back_on_line_s = 0.02;    ///< it has to be there for this long before the button counts again
  CommandStreamSettings command;   ///< law, observer and codec of the command stream
  ConstraintSettings constraint;
};

struct MasterInputs {
  robot::JointReading joints;
  std::span<const Received<StateBlock>> states;  ///< since the last step, in order of arrival
  const GuidePath* guide = nullptr;  ///< null: no contour yet; outlives the step after which it is another
  bool button = false;               ///< the pen's laser button
  bool pedal = false;                ///< it is under a foot: no hand need be felt
  bool engage = false;               ///< the operator wants the slave to follow
  StopOrder stop;
  std::optional<ConstraintMode> constraint;  ///< guidance or corridor from now on; none: as it is
};

struct MasterOutputs {
  Vec3 currents_a = Vec3::Zero();
  std::optional<CommandBlock> command;
  MasterMode mode = MasterMode::kIdle;
  bool engage_spent = false;   ///< the operator has to engage anew
  const char* let_go = nullptr;  ///< why the slave is, or will not be taken hold of, a literal
  std::uint32_t stop = 0;      ///< number of the emergency stop that is obeyed; 0: none
  Vec3 tool_m = Vec3::Zero();  ///< measured, master's workpiece frame
  Vec3 velocity_m_per_s = Vec3::Zero();
  /// Commanded to the tool, without what leads it back to the curve.
  Vec3 acceleration_m_per_s2 = Vec3::Zero();
  Vec3 hand_n = Vec3::Zero();  ///< estimated force of the hand
  double constraint_n = 0.0;   ///< how hard the constraint answers, across the curve
  double corridor_m = 0.0;     ///< half width within which the hand is free; 0: guidance
  ActiveConstraint active;     ///< the circle in force, while the hand is guided
  bool off_line = false;       ///< so far off the contour, just now or before, that the button is not passed on
  bool saturated = false;      ///< a motor was at its limit
  Observed observed;           ///< the slave, as the network observer predicts it
  SlaveForce slave_force;      ///< on the slave's tool, as its states tell it
};

class MasterNode {
 public:
  MasterNode(const robot::RobotModel& model, const MasterSettings& settings, std::uint32_t epoch);

  /// As chosen for the robot, or as given.
  const control::LoopBandwidths& bandwidths() const noexcept { return bandwidths_; }

  MasterOutputs step(std::int64_t now_ns, const MasterInputs& inputs) noexcept;
  const streaming::LinkStatistics& link() const noexcept { return link_; }
  const streaming::StreamCounters& states() const noexcept { return states_.counters(); }
  Tick tick() const noexcept { return tick_; }
  /// The slave was heard, and is not any more.
  bool slave_gone(std::int64_t now_ns) const noexcept {
    return states_.heard() && states_.silent_s(now_ns) >= settings_.stale_s;
  }
  /// Since its newest state.
  double slave_silent_s(std::int64_t now_ns) const noexcept {
    return states_.heard() ? states_.silent_s(now_ns) : 0.0;
  }
  /// The newest that the slave has told; null: nothing yet.
  const StateHeader* slave() const noexcept { return states_.heard() ? &states_.header() : nullptr; }
  const Observed& observed() const noexcept { return stream_->observed(); }
  /// Another law, estimator or codec from the next block on; `next` then holds the stream that was. Between
  /// two engagements; allocates nothing.
  void exchange(std::unique_ptr<CommandStream>& next) noexcept {
    next->take_over(*stream_);
    std::swap(stream_, next);
  }
  /// What the hand feels of the cut.
  const FeltCut& felt() const noexcept { return constraint_.felt(); }

 private:
  KinematicState observe(const robot::JointReading& joints) noexcept;
  /// False: stamps that cannot be are among them.
  bool receive(std::span<const Received<StateBlock>> states) noexcept;
  /// Why the slave is not to be led, or not any more, as a sentence of letting it go; null: nothing hinders it.
  const char* hindrance(std::int64_t now_ns, const GuidePath* guide) const noexcept;
  /// The slave does not follow this engagement (any more).
  bool spent(std::uint32_t engage) const noexcept;
  void begin_engagement() noexcept;
  bool off_line(const Vec2& tool_m, double corridor_m) noexcept;
  bool guided() const noexcept {
    return modes_.mode() == MasterMode::kGuiding || modes_.mode() == MasterMode::kEngaged;
  }
  /// Acceleration that the tool is to have, by the mode; fills in what the constraint says.
  Vec3 wanted(const KinematicState& tool, const std::optional<ConstraintMode>& mode, bool button,
              MasterOutputs& out) noexcept;

  robot::RobotModel model_;
  control::LoopBandwidths bandwidths_;
  MasterSettings settings_;
  control::JointAccelerationControl joints_;
  control::SampledGains approach_law_;
  double hand_share_;
  double dt_s_;
  Vec3 hand_n_ = Vec3::Zero();
  Tick tick_ = 0;
  std::int64_t stepped_ns_ = 0;  ///< the step before; 0: none
  bool stood_still_ = false;     ///< between that and this one, for so long that the slave seems gone
  bool located_ = false;         ///< the robot has told where it stands

  Modes modes_;
  ConstraintController constraint_;
  std::unique_ptr<CommandStream> stream_;  ///< never null
  streaming::StateReceiver states_;
  ForceFeedback force_;
  std::uint32_t epoch_;
  std::uint32_t engage_ = 0;  ///< engagements so far
  DeadMan dead_man_;
  double off_line_s_ = 0.0;   ///< for which the button does not count yet
  bool button_seen_ = false;  ///< released, since the engagement began
  streaming::LinkStatistics link_;
};

}  // namespace telekerf::master
