// SPDX-License-Identifier: Apache-2.0
// The seam to the two motors of an imaging unit: magnification and focus. See docs/how-to/imaging-unit.md.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>

#include "common/runtime/device_registry.h"

namespace telekerf::imaging {

inline constexpr std::size_t kAxes = 2;
/// Places in all arrays below.
inline constexpr std::size_t kMagnification = 0;
inline constexpr std::size_t kFocus = 1;
inline constexpr std::array kBothAxes{kMagnification, kFocus};
using PerAxis = std::array<double, kAxes>;

/// One reading of both encoders.
struct AxesReading {
  PerAxis encoders_m{};  ///< from wherever they were switched on: homing finds the lower end
  std::array<bool, kAxes> at_lower_end{};  ///< the switch there is pressed
  bool valid = false;                      ///< false: no (new) reading
  std::uint64_t tick = 0;                  ///< counts readings of the device; unchanged: nothing new
};

/// Two motors with encoders and a switch at each lower end. Neither read nor write may block, allocate or
/// throw: they are called from the axes' control step. The motors hold the last currents until they get
/// others; an implementation adds its own watchdog (no write for a while: currents to zero).
class Axes {
 public:
  Axes() = default;
  virtual ~Axes() = default;
  Axes(const Axes&) = delete;
  Axes& operator=(const Axes&) = delete;

  virtual AxesReading read() noexcept = 0;
  virtual void write(const PerAxis& currents_a) noexcept = 0;
};

/// What the controller knows of one axis, its spindle and gear included.
struct AxisModel {
  double travel_m = 0.03;       ///< from the lower end stop to the upper one
  double moving_mass_kg = 2.0;  ///< what the motor feels, as a mass on the spindle
  double force_constant_n_per_a = 20.0;
  double peak_force_n = 20.0;
  double coulomb_n = 3.0;  ///< dry friction, for the simulation
  double viscous_n_s_per_m = 30.0;
  double backlash_m = 0.0;      ///< between the encoder and the optics
  double speed_m_per_s = 0.03;  ///< largest that is asked for
  double acceleration_m_per_s2 = 0.6;
};
using AxesModel = std::array<AxisModel, kAxes>;

/// A stiff ball screw for the magnification; a small screw with play for the focus (thesis 7.1.4).
AxesModel default_axes();

}  // namespace telekerf::imaging
