// SPDX-License-Identifier: Apache-2.0
// The controller of the two axes: a disturbance observer (eq. 23) makes each an integrator of accelerations,
// and a velocity reference is tracked by eq. 159-161. Positions, homing and the focusing law all ask for
// velocities.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>

#include "common/control/disturbance_observer.h"
#include "slave/vision/imaging/axes.h"
#include "slave/vision/imaging/optics.h"

namespace telekerf::imaging {

struct AxesControlSettings {
  double period_s = 1e-3;
  double loop_delay = 0.0;  ///< periods from a reading to the effect of the currents that answer it
  double observer_rad_per_s = 400.0;
  double velocity_observer_rad_per_s = 1200.0;
  double convergence_rad_per_s = 120.0;  ///< C of eq. 160
  double settled_m = 5e-6;               ///< nearer than this to its goal and this slow an axis has arrived
  double settled_m_per_s = 5e-4;
};

/// Order within one step: step(reading), write the currents that it returns.
class AxesControl {
 public:
  enum class State : std::uint8_t { kHoming, kReady, kLost };

  AxesControl(const AxesModel& model, const AxesControlSettings& settings) noexcept;

  /// One control step. A reading that is invalid, no number, or of the tick before is none. Up to kMaxBridged
  /// in a row are bridged by the model; then the motors get no current, friction brakes them, and the next
  /// reading is a first one. After kMaxMissing the axes are lost: with the next reading they home anew and go
  /// where they were sent last.
  PerAxis step(const AxesReading& reading) noexcept;
  /// The caller was late: what it has read is old, and what was written has acted for too long. It gives the
  /// next step no reading.
  void lapse() noexcept { missing_ = std::max(missing_, kMaxBridged); }

  /// Goes to `position_m`, clamped to the travel less a margin before the end stops; a place that is no
  /// number changes nothing.
  void move_to(std::size_t axis, double position_m) noexcept;
  /// The same, but arrives from below: over-travels first where it lies below, so that play is always taken
  /// up on the same side.
  void approach(std::size_t axis, double position_m) noexcept;
  /// Follows a velocity (eq. 158) until the next order; stops at the ends of the travel.
  void drive(std::size_t axis, double velocity_m_per_s) noexcept;

  State state() const noexcept { return state_; }
  bool settled(std::size_t axis) const noexcept;
  bool settled() const noexcept { return settled(kMagnification) && settled(kFocus); }
  /// Measured, metres from the lower end; meaningless while homing.
  AxisPositions positions_m() const noexcept;
  double position_m(std::size_t axis) const noexcept { return observed_m(axis) - zero_m_[axis]; }
  double velocity_m_per_s(std::size_t axis) const noexcept;
  double goal_m(std::size_t axis) const noexcept { return goals_[axis].position_m; }
  double lowest_m() const noexcept { return kMargin_m; }
  double highest_m(std::size_t axis) const noexcept { return model_[axis].travel_m - kMargin_m; }

  static constexpr double kMargin_m = 0.5e-3;  ///< kept from the end stops
  static constexpr int kMaxBridged = 4;        ///< missing readings in a row; then the axes are let go
  static constexpr int kMaxMissing = 50;       ///< and then they are lost
  static constexpr double kHoming_m_per_s = 0.01;

  /// At which an axis looks for its switch, m/s: never faster than it may go, nor than it can stop within
  /// half the margin.
  static double homing_m_per_s(const AxisModel& axis) noexcept;
  /// What no way of these axes takes longer than, s: the whole travel at the speed of homing.
  static double longest_way_s(const AxesModel& model) noexcept;

 private:
  /// Down to the switch, up off it, and down once more so slowly that two readings hold its edge.
  enum class Homing : std::uint8_t { kSeek, kBackOff, kCreep, kDone };
  struct Goal {
    double position_m = kMargin_m;
    std::optional<double> first_m;  ///< the over-travel that comes before
    std::optional<double> velocity_m_per_s;
    double reference_m_per_s = 0.0;  ///< of the last step
  };
  double observed_m(std::size_t axis) const noexcept {
    return observer_.joints_m()[static_cast<Eigen::Index>(axis)];
  }
  bool is_news(const AxesReading& reading) const noexcept;
  double wanted_velocity(std::size_t axis, const AxesReading& reading) noexcept;
  double homing_velocity(std::size_t axis, const AxesReading& reading) noexcept;
  void lose() noexcept;
  void begin(const Vec3& encoders_m) noexcept;
  double velocity_to(std::size_t axis, double position_m) const noexcept;
  bool near(std::size_t axis, double position_m) const noexcept;

  AxesModel model_;
  AxesControlSettings settings_;
  /// Two axes in an observer of three: the third rests.
  control::DisturbanceObserver observer_;
  State state_ = State::kHoming;
  bool started_ = false;  ///< the observer goes on from the reading before
  int missing_ = 0;       ///< readings in a row
  int apart_ = 0;         ///< periods between the newest two readings
  std::optional<std::uint64_t> newest_tick_;
  std::array<Homing, kAxes> homing_{};
  PerAxis last_m_{};  ///< while homing: where the encoder was when the switch was last seen in its other state
  PerAxis zero_m_{};
  std::array<Goal, kAxes> goals_;
};

}  // namespace telekerf::imaging
