// SPDX-License-Identifier: Apache-2.0
#include "slave/vision/imaging/simulated_axes.h"

#include <algorithm>
#include <cmath>
#include <random>

namespace telekerf::imaging {
namespace {

constexpr double kInnerStep_s = 2.5e-4;
constexpr double kStick_m_per_s = 1e-3;  ///< over which dry friction comes up
constexpr double kStop_n_per_m = 4e5;    ///< of an end stop
constexpr double kStopDamping_n_s_per_m = 2e3;

}  // namespace

SimulatedAxes::SimulatedAxes(const AxesModel& model, const PerAxis& start_m, double mismatch,
                             std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const auto off = [&] {
    return 1.0 + mismatch * (2.0 * static_cast<double>(random() >> 11) * 0x1p-53 - 1.0);
  };
  for (const std::size_t i : kBothAxes) {
    Axis& axis = axis_[i];
    axis.truth = model[i];
    axis.truth.moving_mass_kg *= off();
    axis.truth.force_constant_n_per_a *= off();
    axis.truth.coulomb_n *= off();
    axis.truth.viscous_n_s_per_m *= off();
    axis.motor_m = axis.optics_m = axis.zero_m = start_m[i];
  }
}

AxesReading SimulatedAxes::read() noexcept {
  AxesReading reading;
  for (const std::size_t i : kBothAxes) {
    const Axis& axis = axis_[i];
    reading.encoders_m[i] = std::round((axis.motor_m - axis.zero_m) / kEncoder_m) * kEncoder_m;
    reading.at_lower_end[i] = axis.motor_m <= 0.0;
  }
  reading.valid = true;
  reading.tick = ++reads_;
  return reading;
}

void SimulatedAxes::write(const PerAxis& currents_a) noexcept {
  for (const std::size_t i : kBothAxes) {
    const double wanted_n = axis_[i].truth.force_constant_n_per_a * currents_a[i];
    axis_[i].force_n = std::clamp(wanted_n, -axis_[i].truth.peak_force_n, axis_[i].truth.peak_force_n);
  }
}

void SimulatedAxes::inner_step(Axis& axis, double h_s) noexcept {
  double force_n = axis.force_n;
  const double beyond_m = axis.motor_m - std::clamp(axis.motor_m, kLowerStop_m, axis.truth.travel_m);
  if (beyond_m != 0.0) force_n -= kStop_n_per_m * beyond_m + kStopDamping_n_s_per_m * axis.speed_m_per_s;
  // Friction implicitly: at the end of the step it brakes the speed that is then, so that it can stop the
  // axis but never turn it round, however steep it is.
  const double m = axis.truth.moving_mass_kg;
  const double free = axis.speed_m_per_s + h_s * force_n / m;
  const double viscous = 1.0 + h_s * axis.truth.viscous_n_s_per_m / m;
  const double dry = h_s * axis.truth.coulomb_n / m;
  // v viscous + dry clamp(v / stick) = free
  const double sticking = free / (viscous + dry / kStick_m_per_s);
  axis.speed_m_per_s =
      std::abs(sticking) < kStick_m_per_s ? sticking : (free - std::copysign(dry, free)) / viscous;
  axis.motor_m += h_s * axis.speed_m_per_s;
  const double play = 0.5 * axis.truth.backlash_m;
  axis.optics_m = std::clamp(axis.optics_m, axis.motor_m - play, axis.motor_m + play);
}

void SimulatedAxes::advance(double dt_s) noexcept {
  const int steps = std::max(1, static_cast<int>(std::ceil(dt_s / kInnerStep_s - 1e-9)));
  for (Axis& axis : axis_) {
    for (int i = 0; i < steps; ++i) inner_step(axis, dt_s / steps);
  }
}

}  // namespace telekerf::imaging
