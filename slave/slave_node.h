// SPDX-License-Identifier: Apache-2.0
// The slave: what the command stream brings is selected, tracked (eq. 87), lit by the laser where the
// interlock allows it, and reported. Pure: the same node runs in its process and in virtual time.
#pragma once

#include <optional>
#include <span>

#include "common/control/joint_acceleration_control.h"
#include "common/control/loop_design.h"
#include "common/control/standstill.h"
#include "common/control/tracking_law.h"
#include "common/geometry/nearest.h"
#include "common/protocol/messages.h"
#include "common/robot/robot.h"
#include "common/robot/robot_model.h"
#include "common/streaming/command_receiver.h"
#include "slave/laser/beam_monitor.h"
#include "slave/laser/beam_power.h"
#include "slave/laser/contour_place.h"
#include "slave/laser/dose_book.h"
#include "slave/laser/interlock.h"
#include "slave/laser/punctuality.h"
#include "slave/reference_selector.h"
#include "slave/state_report.h"

namespace telekerf::slave {

struct SlaveSettings {
  double control_hz = 1000.0;
  double stream_hz = 1000.0;
  double bandwidth_rad_s = 0.0;     ///< of the tracking law, critically damped; 0: chosen from the robot
  double observer_rad_s = 0.0;      ///< of the disturbance observer; 0: likewise (loop_design.h)
  double command_timeout_s = 0.15;  ///< no command for this long: laser off, hold
  double laser_w = 10.0;            ///< at beam_power's speed
  bool real_laser = false;          ///< it is not simulated: told to the master
  laser::BeamPowerSettings beam_power;
  BareAccelerations bare_accelerations = BareAccelerations::kObeyed;
  codec::StreamSettings feedback;  ///< of the positions in the state stream, m
  /// Of the force beside them, N. Codec, block, redundancy and period are the positions'.
  codec::StreamSettings force{.max_rms = 0.025, .quantum = 0.01, .anchored = false};
  streaming::PlayoutSettings playout;
  control::BumplessTransferSettings transfer{.rate_rad_per_s = 200.0, .max_acceleration_m_per_s2 = 5.0};
  bool touched = false;       ///< something may push the tool: what the currents do not explain is no doubt
  double follow_age_s = 2.5;  ///< commands older than this are not followed
  laser::InterlockSettings interlock;  ///< what is the robot's and the work's in it is filled in by the node
};

/// The contour as the interlock needs it; built outside the loop.
struct Corridor {
  std::uint32_t contour_id = 0;
  geometry::NearestIndex contour;
  std::optional<laser::CorridorRaster> raster;  ///< for the second judgement; none: it knows no contour
};

struct SlaveInputs {
  robot::JointReading joints;
  std::span<const Received<CommandBlock>> commands;  ///< since the last step, in order of arrival
  StopOrder stop;
  const Corridor* corridor = nullptr;  ///< null: no contour yet; must outlive its use
  bool fault = false;                  ///< robot or laser has failed
  double look_age_s = laser::kAbsent;  ///< since vision last saw this contour; absent: it has not
  bool monitor_agrees = true;          ///< see laser::BeamMonitor
  bool emission_agrees = true;         ///< see LaserOutput::emission_agrees()
};

struct SlaveCounters : streaming::StreamCounters, StateReportCounters {
  std::uint64_t missed_ticks = 0;  ///< applied while their sample was not there
  std::uint64_t late_steps = 0;    ///< after which the beam was off for a while
};

struct SlaveOutputs {
  Vec3 currents_a = Vec3::Zero();
  double laser_w = 0.0;
  laser::Permit permit;                                    ///< for laser_w
  std::uint32_t forbidden = laser::Judgement{}.forbidden;  ///< bit n: guard n of laser::kGuards
  std::optional<StateBlock> state;
  SlaveMode mode = SlaveMode::kWaiting;
  HoldReason reason = HoldReason::kNoCommands;
  std::uint32_t stop = 0;       ///< number of the emergency stop that is obeyed; 0: none
  double command_age_s = -1.0;  ///< of the command applied, by this side's clock; negative: none
  Interlock interlock = Interlock::kNoContour;
  double applied_tick = -1.0;  ///< master tick applied at this step; negative: none
  bool button = false;         ///< of the sample that is applied
  bool settled = false;        ///< following without a rest of an approach
  KinematicState reference;
  Vec3 tool_m = Vec3::Zero();   ///< measured
  Vec3 force_n = Vec3::Zero();  ///< estimated, of the world on the tool, workpiece frame
};

class SlaveNode {
 public:
  SlaveNode(const robot::RobotModel& model, const SlaveSettings& settings, std::uint32_t epoch);

  /// As chosen for the robot, or as given.
  const control::LoopBandwidths& bandwidths() const noexcept { return bandwidths_; }

  SlaveOutputs step(std::int64_t now_ns, const SlaveInputs& inputs) noexcept;
  /// Another codec, block length or redundancy of the state stream, from where its next block begins; the
  /// rate stays. Throws StartupError.
  void change(const codec::StreamSettings& feedback, const codec::StreamSettings& force) {
    report_.change(feedback, force);
  }

  SlaveCounters counters() const noexcept {
    return {commands_.counters(), report_.counters(), selector_.missed_ticks(), punctuality_.late_steps()};
  }
  /// Whether the robot does what its motors are told.
  const robot::Doubt& doubt() const noexcept { return joints_.doubt(); }
  /// What the work has got so far.
  const laser::DoseBook& dose() const noexcept { return dose_; }
  /// Another workpiece lies there. Between two steps.
  void new_workpiece() noexcept { dose_.clear(); }
  const streaming::PlayoutClock& playout() const noexcept { return commands_.clock(); }

 private:
  KinematicState observe(const robot::JointReading& joints) noexcept;
  /// Joint accelerations by the tracking law.
  Vec3 track(const Selected& selected, const KinematicState& tool, const robot::JointReading& read) noexcept;
  laser::InterlockInputs judged(const SlaveInputs& inputs, const Selected& selected,
                                const KinematicState& tool, bool on_time) noexcept;
  /// No sample was lit that is not older.
  bool unlit(const Selected& selected) const noexcept;
  /// The energy of the step before is in the account when this one is judged.
  void book(std::int64_t now_ns) noexcept;

  robot::RobotModel model_;
  SlaveSettings settings_;
  control::LoopBandwidths bandwidths_;
  control::SampledGains law_;
  control::JointAccelerationControl joints_;
  control::Standstill standstill_;
  double dt_s_;
  Tick tick_ = 0;
  bool located_ = false;  ///< the robot has told where it stands

  streaming::CommandReceiver commands_;
  ReferenceSelector selector_;
  std::uint32_t stop_ = 0;  ///< number of the emergency stop in force; 0: none
  Tick stop_tick_ = 0;      ///< since when
  laser::BeamInterlock interlock_;
  laser::ContourPlace contour_place_;
  laser::CutSpeed cut_speed_;
  laser::DoseBook dose_;
  struct {
    std::int64_t time_ns = 0;
    Vec2 place_m = Vec2::Zero();
    double power_w = 0.0;
  } lit_;  ///< of the step before
  struct {
    std::uint32_t master_epoch = 0;
    double tick = -1.0;
  } lit_sample_;  ///< newest that was lit
  laser::Punctuality punctuality_;
  StateReport report_;
};

}  // namespace telekerf::slave
