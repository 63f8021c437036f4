// SPDX-License-Identifier: Apache-2.0
// The axes' control loop: a thread of its own, or steps by hand in virtual time. Orders go in and positions
// come out through atomics; the loop waits for nobody.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <thread>

#include "slave/vision/imaging/axes_control.h"
#include "slave/vision/imaging/axes_kinds.h"

namespace telekerf::imaging {

class AxesRunner {
 public:
  static constexpr double kPeriod_s = 1e-3;

  AxesRunner(AxesDevice device, const AxesModel& model);
  ~AxesRunner();
  AxesRunner(const AxesRunner&) = delete;
  AxesRunner& operator=(const AxesRunner&) = delete;

  /// Steps once a period in a thread of its own, until it is destroyed; the motors then get no current.
  void start();
  /// One control step; not while the thread runs. `late`: the one before was long ago.
  void step(bool late = false) noexcept;

  /// As AxesControl's, from one other thread.
  void move_to(std::size_t axis, double position_m) noexcept { order(axis, Kind::kMove, position_m); }
  void approach(std::size_t axis, double position_m) noexcept { order(axis, Kind::kApproach, position_m); }
  void drive(std::size_t axis, double velocity_m_per_s) noexcept {
    order(axis, Kind::kDrive, velocity_m_per_s);
  }

  /// Has arrived where the newest order leads.
  bool settled(std::size_t axis) const noexcept;
  bool settled() const noexcept { return settled(kMagnification) && settled(kFocus); }
  AxesControl::State state() const noexcept { return state_.load(std::memory_order_acquire); }
  /// Measured.
  AxisPositions positions_m() const noexcept { return {measured_m_[kMagnification], measured_m_[kFocus]}; }
  /// Of simulated axes the truth behind the play; of others what is measured.
  AxisPositions optics_m() const noexcept { return {optics_m_[kMagnification], optics_m_[kFocus]}; }
  double longest_way_s() const noexcept { return AxesControl::longest_way_s(model_); }
  double lowest_m() const noexcept { return AxesControl::kMargin_m; }
  double highest_m(std::size_t axis) const noexcept { return model_[axis].travel_m - AxesControl::kMargin_m; }
  /// Time of the steps taken.
  double time_s() const noexcept {
    return static_cast<double>(steps_.load(std::memory_order_relaxed)) * kPeriod_s;
  }

 private:
  static constexpr std::uint64_t kNone = ~std::uint64_t{0};
  enum class Kind : std::uint8_t { kMove, kApproach, kDrive };
  struct Order {
    std::atomic<double> value{0.0};
    std::atomic<Kind> kind{Kind::kMove};
    std::atomic<std::uint64_t> count{0};    ///< stored last: what it counts is there
    std::atomic<std::uint64_t> settled{kNone};  ///< the order that the axis has arrived at
    std::uint64_t taken = 0;                ///< the loop's own
  };
  void order(std::size_t axis, Kind kind, double value) noexcept;
  void take_orders() noexcept;

  AxesModel model_;
  AxesDevice device_;
  AxesControl control_;
  std::array<Order, kAxes> orders_;
  std::array<std::atomic<double>, kAxes> measured_m_{};
  std::array<std::atomic<double>, kAxes> optics_m_{};
  std::atomic<AxesControl::State> state_{AxesControl::State::kHoming};
  std::atomic<std::uint64_t> steps_{0};
  std::jthread thread_;  // last: it ends before what it uses
};

}  // namespace telekerf::imaging
