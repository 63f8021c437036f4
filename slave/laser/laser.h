// SPDX-License-Identifier: Apache-2.0
// The hardware seam of the laser, and the row by which users name one.
#pragma once

#include <memory>
#include <string_view>

#include "common/runtime/device_registry.h"

namespace telekerf::laser {

/// What a vendor implements. A laser is its own files, which define a LaserKind beside the Laser, and one row
/// in laser_output.cpp.
class Laser {
 public:
  virtual ~Laser() = default;
  /// Once every control step, and whenever the beam must be off: average power until the next call, finite
  /// and not negative, and the visible pilot beam. Neither allocates nor waits. False: the laser was not
  /// told, as far as can be known.
  virtual bool emit(double power_w, bool pilot) noexcept = 0;
};

/// Opened with the control rate, Hz: how often emit() will be called.
using LaserRegistry = DeviceRegistry<std::unique_ptr<Laser>, double>;
using LaserKind = LaserRegistry::Kind;

/// Gives what it is told to; the record holds that, and the workpiece is burnt from the record.
class SimulatedLaser final : public Laser {
 public:
  bool emit(double, bool) noexcept override { return true; }
};

inline std::unique_ptr<Laser> open_simulated_laser(std::string_view, double) {
  return std::make_unique<SimulatedLaser>();
}
inline constexpr LaserKind kSimulatedLaser{"simulated", "simulated", no_argument, open_simulated_laser};

}  // namespace telekerf::laser
