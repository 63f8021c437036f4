// SPDX-License-Identifier: Apache-2.0
// Works a job off without bus and clock: follower, interlock and beam, one step at a time.
#pragma once

#include <array>
#include <vector>

#include "common/geometry/nearest.h"
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

struct JobExecutorOutputs {
  Vec3 currents_a = Vec3::Zero();
  double laser_w = 0.0;
  laser::Permit permit;      ///< for laser_w
  std::int64_t time_ns = 0;  ///< of the steps made, by which the permit was made
  bool pilot = false;        ///< the visible beam that shows where the work will be
  JobPhase phase = JobPhase::kApproach;
  Interlock interlock = Interlock::kNoContour;
  std::size_t tick = 0;   ///< of the job's trajectory
  double progress = 0.0;  ///< share of the job's time
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
  JobExecutorOutputs step(const robot::JointReading& reading, bool stop) noexcept;

 private:
  /// The contour that is cut, or that comes next.
  void turn_to(std::size_t contour) noexcept;

  const Job& job_;
  std::vector<geometry::NearestIndex> corridors_;  ///< of the job's lines
  std::array<Controller, 2> controllers_;          ///< for open lines, for closed ones
  JobExecutorSettings settings_;
  std::int64_t period_ns_;
  laser::BeamInterlock interlock_;
  double unknown_m_;  ///< by which the tool may miss its predicted place within the reaction time
  PathFollower follower_;
  Trajectory hold_;  ///< one point: where the tool is held after a stop
  std::int64_t steps_ = 0;
  std::size_t tick_ = 0;
  std::size_t contour_ = 0;
  bool stopped_ = false;
};

}  // namespace telekerf::machining
