// SPDX-License-Identifier: Apache-2.0
// The slave: play-out, local reference, tracking law (eq. 87), limits, laser interlock, feedback stream.
// Pure: the same node runs in its process and in virtual time.
#pragma once

#include <optional>
#include <span>

#include "common/control/acceleration_control.h"
#include "common/control/friction_feedforward.h"
#include "common/geometry/nearest.h"
#include "common/protocol/messages.h"
#include "common/robot/robot.h"
#include "common/robot/robot_model.h"
#include "common/streaming/command_receiver.h"
#include "common/streaming/state_stream.h"
#include "slave/joiner.h"
#include "slave/laser/interlock.h"

namespace telekerf::slave {

struct SlaveSettings {
  double control_hz = 1000.0;
  double stream_hz = 1000.0;
  double bandwidth_rad_s = 60.0;  ///< of the tracking law, critically damped
  double observer_rad_s = 600.0;  ///< of the disturbance observer
  double stale_s = 0.15;          ///< no command for this long: laser off, hold
  double laser_w = 10.0;
  codec::StreamSettings feedback;  ///< of the positions in the state stream, m
  /// Of the force beside them, N. Codec, block, redundancy and period are the positions'.
  codec::StreamSettings force{.max_rms = 0.01, .quantum = 0.01, .anchored = false};
  PlayoutSettings playout;
  BumplessTransferSettings joiner;
  laser::InterlockSettings interlock;
};

/// The contour as the interlock needs it; built outside the loop.
struct Corridor {
  std::uint32_t contour_id = 0;
  geometry::NearestIndex contour;
};

struct SlaveInputs {
  robot::JointReading joints;
  std::span<const Received<CommandBlock>> commands;  ///< since the last step, in order of arrival
  std::span<const EventMessage> events;
  const Corridor* corridor = nullptr;  ///< null: no contour yet; must outlive its use
};

enum class SlaveMode : std::uint8_t {
  kWaiting,    ///< no commands yet, or disengaged: holds its pose
  kFollowing,  ///< applies the stream
  kHolding,    ///< was following, but the stream has dried up: holds, laser off
  kStopped,    ///< latched emergency stop
};

struct SlaveCounters : CommandReceiverCounters, StateStreamCounters {
  std::uint64_t missed_ticks = 0;  ///< applied while their sample was not there
};

struct SlaveOutputs {
  Vec3 currents_a = Vec3::Zero();
  double laser_w = 0.0;
  std::optional<StateBlock> state;
  SlaveMode mode = SlaveMode::kWaiting;
  Interlock interlock = Interlock::kNoContour;
  double applied_tick = -1.0;  ///< master tick applied at this step; negative: none
  bool settled = false;        ///< following without a rest of an approach
  KinematicState reference;
  Vec3 tool_m = Vec3::Zero();   ///< measured
  Vec3 force_n = Vec3::Zero();  ///< estimated, of the world on the tool, workpiece frame
};

class SlaveNode {
 public:
  SlaveNode(const robot::RobotModel& model, const SlaveSettings& settings, std::uint32_t epoch);

  SlaveOutputs step(std::int64_t now_ns, const SlaveInputs& inputs) noexcept;
  /// Emergency stop and its end alone; step() does it itself. For a robot that does not tell yet where it
  /// stands.
  void heed(std::span<const EventMessage> events) noexcept;

  /// Another codec, block length or redundancy of the state stream, from where its next block begins; the
  /// rate stays. Throws StartupError.
  void change(const codec::StreamSettings& feedback, const codec::StreamSettings& force) {
    states_.change(feedback, force);
  }

  SlaveCounters counters() const noexcept { return {intake_.counters(), states_.counters(), missed_ticks_}; }
  const PlayoutClock& playout() const noexcept { return intake_.clock(); }

 private:
  KinematicState choose_source(std::int64_t now_ns, const KinematicState& tool, SlaveOutputs& out) noexcept;
  KinematicState follow(const StreamSample& sample, const KinematicState& found) noexcept;
  KinematicState hold_on() noexcept;
  void rejoin(const KinematicState& source) noexcept;
  /// Slow enough, and to be stopped before the workspace ends.
  bool obeys_limits(const KinematicState& motion) const noexcept;
  void keep_inside(KinematicState& motion) const noexcept;

  robot::RobotModel model_;
  robot::DeltaKinematics kinematics_;
  SlaveSettings settings_;
  control::AccelerationControl acceleration_;
  control::FrictionFeedforward friction_;
  robot::Mat3 inertia_kg_ = robot::Mat3::Identity();
  double dt_s_;
  Tick tick_ = 0;

  CommandReceiver intake_;

  // Reference.
  SlaveMode mode_ = SlaveMode::kWaiting;
  BumplessTransfer joiner_;
  KinematicState reference_;
  KinematicState hold_;  ///< source while not following
  bool reference_known_ = false;
  std::uint32_t source_generation_ = 0;  ///< 0: holding
  std::uint32_t source_block_ = 0;
  Law source_law_ = Law::kLocal;
  bool rejoined_ = false;  ///< the reference was joined to a new source at this very step
  bool tripped_ = false;   ///< bare accelerations led out of bounds: held until disengaged
  bool button_ = false;
  std::uint64_t missed_ticks_ = 0;

  StateStream states_;
};

}  // namespace telekerf::slave
