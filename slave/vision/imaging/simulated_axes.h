// SPDX-License-Identifier: Apache-2.0
// The two axes in the computer: mass, dry and viscous friction, backlash, end stops, encoders.
#pragma once

#include <cstdint>

#include "slave/vision/imaging/axes.h"
#include "slave/vision/imaging/optics.h"

namespace telekerf::imaging {

/// Moves only in advance(): the caller owns the time, real or virtual. Same model, seed and calls: same
/// motion, bit by bit.
class SimulatedAxes final : public Axes {
 public:
  static constexpr double kEncoder_m = 0.5e-6;     ///< a count
  static constexpr double kLowerStop_m = -0.4e-3;  ///< the switch is pressed from 0 down to here

  /// At rest at `start_m`. The true masses, forces and friction are up to `mismatch` off the model's.
  SimulatedAxes(const AxesModel& model, const PerAxis& start_m, double mismatch, std::uint64_t seed);

  AxesReading read() noexcept override;
  void write(const PerAxis& currents_a) noexcept override;

  /// Integrates `dt_s` with the currents held.
  void advance(double dt_s) noexcept;

  /// The truth, for judges and the simulated optics: where the optics are, behind the play.
  AxisPositions optics_m() const noexcept { return {axis_[kMagnification].optics_m, axis_[kFocus].optics_m}; }
  double motor_m(std::size_t axis) const noexcept { return axis_[axis].motor_m; }
  double speed_m_per_s(std::size_t axis) const noexcept { return axis_[axis].speed_m_per_s; }

 private:
  struct Axis {
    AxisModel truth;
    double motor_m = 0.0;
    double speed_m_per_s = 0.0;
    double optics_m = 0.0;  ///< within half the backlash of the motor
    double zero_m = 0.0;    ///< what the encoder called zero when it was switched on
    double force_n = 0.0;
  };
  static void inner_step(Axis& axis, double h_s) noexcept;

  std::array<Axis, kAxes> axis_;
  std::uint64_t reads_ = 0;
};

}  // namespace telekerf::imaging
