// SPDX-License-Identifier: Apache-2.0
// Automatic machining without bus and clock: robot, laser, job and record, one step at a time.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "common/protocol/messages.h"
#include "common/robot/supervisor.h"
#include "common/runtime/loop.h"
#include "common/workpiece/material.h"
#include "slave/laser/beam_monitor.h"
#include "slave/laser/laser_output.h"
#include "slave/laser/punctuality.h"
#include "slave/machining/job_executor.h"
#include "slave/machining/work_report.h"

namespace telekerf {
class Settings;
}

namespace telekerf::machining {

struct StationSettings {
  std::string robot = "slave-keops";
  robot::RobotSupervisorSettings machine;
  double mismatch = 0.1;  ///< how far the simulated robot is off its file, as a fraction
  std::uint64_t seed = 1;
  robot::Sensor::Kind sensor =
      robot::Sensor::Kind::kHall;  ///< of the simulated robot, whatever its file says
  double laser_w = 10.0;
  laser::InterlockSettings interlock;  ///< what of it is the robot's is filled in
  laser::LaserOutputSettings beam;
  double speed_mm_s = 8.0;
  ControllerKind controller = ControllerKind::kAuto;
  CornerPolicy corner = CornerPolicy::kRounded;
  const workpiece::Material* material = &workpiece::kWood;
  double kerf_um = 0.0;        ///< closed contours are moved by half of it
  std::vector<double> select;  ///< contours by their numbers, the largest is 0; none: all
  bool no_framing = false;
  double machining_hz = 2400.0;  ///< control rate
  void add_parameters(Settings& settings);
  /// Throws StartupError if they do not go together.
  void validate() const;
};

class Station {
 public:
  /// Throws StartupError.
  explicit Station(const StationSettings& settings);

  /// The contours of a message as one piece of work. Throws StartupError if they cannot be machined or leave
  /// the workspace. Allocates: call it outside the loop.
  std::unique_ptr<Job> prepare(const ContourMessage& message) const;

  /// From now on `job` is worked off, from wherever the tool stands; it must outlive the work. Waits for the
  /// robot. Throws StartupError if it does not tell where it stands.
  void begin(const Job& job);
  /// One control step. `stop` latches: beam off, the tool is held; the work ends when it stands. After a step
  /// that comes late the beam is off for a while.
  JobExecutorOutputs step(std::int64_t now_ns, bool stop) noexcept;
  /// Nothing is left to do, or the robot or laser has failed.
  bool ended() const noexcept { return ended_; }
  /// False for good: there was light where the second judgement allows none, see laser::BeamMonitor.
  bool monitor_agrees() const noexcept { return monitor_.agrees(); }
  /// After the last step: beam off, then the robot without current.
  void release() noexcept;

  const robot::RobotSupervisor& machine() const { return machine_; }
  const laser::LaserOutput& beam() const { return beam_; }
  double control_hz() const { return settings_.machining_hz; }
  /// Everything was worked off.
  bool finished() const noexcept { return work_.finished; }
  double time_s() const { return job_->time_s(); }
  /// What came of the step before; there has been one.
  const WorkRow& last() const noexcept { return work_.rows.back(); }

  /// Writes all that the work left; returns what result.json holds. Throws StartupError.
  nlohmann::ordered_json report(const std::filesystem::path& folder, const LoopStatistics& loop) const;

 private:
  StationSettings settings_;
  robot::RobotModel model_;
  JobSettings jobs_;
  robot::RobotSupervisor machine_;
  laser::LaserOutput beam_;
  std::optional<Job> from_here_;  ///< the job with a way to its start
  const Job* job_ = nullptr;
  std::optional<JobExecutor> executor_;
  laser::BeamMonitor monitor_;
  std::optional<laser::CorridorRaster> corridor_;  ///< of the job's lines, for the second judgement
  laser::Punctuality punctuality_;
  WorkRecord work_;
  std::size_t held_ = 0;  ///< ticks since the stop
  bool ended_ = false;
};

}  // namespace telekerf::machining
