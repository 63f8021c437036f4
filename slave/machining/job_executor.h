// SPDX-License-Identifier: Apache-2.0
// Works a job off without bus and clock: follower, interlock and beam, one step at a time.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "common/geometry/nearest.h"
#include "slave/laser/contour_place.h"
#include "slave/laser/dose_book.h"
#include "slave/laser/interlock.h"
#include "slave/machining/job.h"
#include "slave/machining/path_follower.h"

namespace telekerf::machining {

struct JobExecutorSettings {
  PathFollowerSettings follower;
  ControllerKind controller = ControllerKind::kAuto;
  double laser_w = 10.0;
  laser::InterlockSettings interlock;
};

/// What its devices and the clock say at one step, beside the reading of the joints.
struct DeviceState {
  bool fault = false;   ///< robot or laser has failed
  bool on_time = true;  ///< no step came late a short while ago
  bool emission_agrees = true;
  bool monitor_agrees = true;
};

struct JobExecutorOutputs {
  Vec3 currents_a = Vec3::Zero();
  double laser_w = 0.0;
  laser::Permit permit;      ///< for laser_w
  std::int64_t time_ns = 0;  ///< of the steps made, by which the permit was made
  bool pilot = false;        ///< the visible beam that shows where the work will be
  JobPhase phase = JobPhase::kApproach;
  Interlock interlock = Interlock::kNoContour;
  std::uint32_t forbidden = laser::Judgement{}.forbidden;  ///< bit n: guard n of laser::kGuards
  std::size_t tick = 0;                                    ///< of the job's trajectory
  double progress = 0.0;                                   ///< share of the job's time
  bool done = false;
  bool saturated = false;  ///< a motor at its limit
  Vec3 reference_m = Vec3::Zero();
  Vec3 tool_m = Vec3::Zero();  ///< measured
  Vec3 tool_velocity_m_per_s = Vec3::Zero();
};

class JobExecutor {
 public:
  /// The job must outlive the executor.
  JobExecutor(const robot::RobotModel& nominal, const Job& job, const JobExecutorSettings& settings);

  /// At rest at the job's start.
  void reset(const Vec3& joints_m) noexcept { follower_.reset(joints_m); }
  /// `stop` latches: beam off, the tool is held where it is.
  JobExecutorOutputs step(const robot::JointReading& reading, bool stop,
                          const DeviceState& devices = {}) noexcept;

 private:
  /// The contour that is cut, or that comes next.
  void turn_to(std::size_t contour) noexcept;
  laser::InterlockInputs judged(const JobExecutorOutputs& now, const Reference& reference, bool valid,
                                const DeviceState& devices) noexcept;

  const Job& job_;
  std::vector<geometry::NearestIndex> corridors_;  ///< of the job's lines
  std::array<Controller, 2> controllers_;          ///< for open lines, for closed ones
  JobExecutorSettings settings_;
  std::int64_t period_ns_;
  laser::BeamInterlock interlock_;
  double max_m_per_s2_;
  laser::ContourPlace contour_place_;
  laser::DoseBook dose_;
  double dt_s_;
  std::optional<std::size_t> lit_tick_;  ///< newest of the job that was lit
  struct {
    Vec2 place_m = Vec2::Zero();
    double power_w = 0.0;
  } lit_;  ///< of the step before
  PathFollower follower_;
  Trajectory hold_;  ///< one point: where the tool is held after a stop
  std::int64_t steps_ = 0;
  std::size_t tick_ = 0;
  std::size_t contour_ = 0;
  bool stopped_ = false;
};

}  // namespace telekerf::machining
