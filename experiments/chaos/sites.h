// SPDX-License-Identifier: Apache-2.0
// The two sites of a chaos run: a station that can sleep, end and begin anew, on a clock of its own.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/protocol/stop_latch.h"
#include "experiments/chaos/faulty_devices.h"
#include "master/station.h"
#include "slave/station.h"

namespace telekerf::experiments {

/// Counted by what was refused.
using Refused = std::map<std::string, std::uint64_t>;

/// A machine's monotonic clock, off the true time by its rate and its jumps.
class SiteClock {
 public:
  std::int64_t local(std::int64_t true_ns) const noexcept {
    return local_ns_ + static_cast<std::int64_t>(rate_ * static_cast<double>(true_ns - true_ns_));
  }
  /// `rate`: local seconds a true second.
  void change(std::int64_t true_ns, double rate, double jump_s) noexcept {
    local_ns_ = local(true_ns) + static_cast<std::int64_t>(jump_s * 1e9);
    true_ns_ = true_ns;
    rate_ = rate;
  }
  double rate() const noexcept { return rate_; }

 private:
  // No clock begins at zero.
  std::int64_t local_ns_ = 5'000'000'000;
  std::int64_t true_ns_ = 0;
  double rate_ = 1.0;
};

/// What both sites have: a clock, and when they are there.
struct SiteTime {
  SiteClock clock;
  std::int64_t next_ns = 0;         ///< true time of the next step
  std::int64_t awake_since_ns = 0;  ///< what came before is stamped then
  bool asleep = false;

  /// True time from one step to the next.
  std::int64_t period_ns() const noexcept { return static_cast<std::int64_t>(1e6 / clock.rate()); }
  std::int64_t stamp(std::int64_t came_ns) const noexcept {
    return clock.local(std::max(came_ns, awake_since_ns));
  }
};

class MasterSite {
 public:
  MasterSite(const master::StationSettings& settings, const bool& pressed);
  /// Another process, under another epoch; the robot stays where it is.
  void start(std::uint32_t epoch, const ContourMessage& contour, Refused& refused);
  void end(Refused& refused);
  bool running() const noexcept { return station_ != nullptr; }
  void publish(const ContourMessage& contour, Refused& refused);
  master::StationOutputs step(std::int64_t now_ns, std::span<const Received<StateBlock>> states,
                              std::span<const EventMessage> events, Refused& refused);
  /// The latch outlives a restart, as it does in a file.
  void hear(const StopMessage& message) { (void)stops_.hear(message); }
  std::uint32_t epoch() const noexcept { return settings_.epoch; }
  /// Of the step that comes next.
  Tick tick() const noexcept { return station_->node().tick(); }
  bool failed() const noexcept { return station_->machine().failed(); }

  SiteTime time;

 private:
  void prepare(Refused& refused);

  master::StationSettings settings_;
  robot::RobotModel model_;
  robot::RobotModel truth_;
  const bool& pressed_;
  StopLatch stops_;
  SensorFault sound_;
  Vec3 rest_in_base_m_;
  ContourMessage contour_;
  std::unique_ptr<master::Station> station_;
  std::vector<std::unique_ptr<master::GuidedContour>> guided_;  // the station may still use an old one
};

class SlaveSite {
 public:
  explicit SlaveSite(const slave::StationSettings& settings);
  void start(std::uint32_t epoch, const ContourMessage& contour, Refused& refused);
  void end(Refused& refused);
  bool running() const noexcept { return station_ != nullptr; }
  /// False: refused, the one in work stays.
  bool publish(const ContourMessage& contour, Refused& refused);
  slave::SlaveOutputs step(std::int64_t now_ns, std::span<const Received<CommandBlock>> commands);
  void hear(const StopMessage& message) { (void)stops_.hear(message); }
  /// The robot has told where it stands; before that there is no reference.
  bool started() const noexcept { return station_->machine().started(); }
  /// Its process would end by itself: the robot or the laser has failed.
  bool failed() const noexcept { return station_->machine().failed() || station_->beam().failed(); }
  const robot::RobotModel& model() const noexcept { return model_; }
  Vec3 tool_m() const noexcept { return *station_->machine().true_tool_m(); }
  Vec3 velocity_m_per_s() const noexcept { return *station_->machine().true_tool_velocity_m_per_s(); }

  SiteTime time;
  SensorFault sensor;
  LaserState laser;

 private:
  slave::StationSettings settings_;
  robot::RobotModel model_;
  robot::RobotModel truth_;
  Vec3 rest_in_base_m_;
  StopLatch stops_;
  std::unique_ptr<slave::Station> station_;
  std::vector<std::unique_ptr<slave::Corridor>> corridors_;
};

}  // namespace telekerf::experiments
