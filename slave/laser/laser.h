// SPDX-License-Identifier: Apache-2.0
// The hardware seam of the laser, and the row by which users name one.
#pragma once

#include <cstdint>
#include <memory>
#include <string_view>

#include "common/runtime/device_registry.h"

namespace telekerf::laser {

/// What a laser is told in one control step.
struct Emission {
  double power_w = 0.0;       ///< average, finite and not negative
  bool pilot = false;         ///< the visible beam that shows where the work will be
  std::int64_t lasts_ns = 0;  ///< from being told on; then beam and pilot are off, unless it was told anew
  std::uint64_t enable =
      0;  ///< number of the permit; there is no power without one that is larger than before
};

/// What a vendor implements. A laser is its own files, which define a LaserKind beside the Laser, and one row
/// in laser_output.cpp.
class Laser {
 public:
  virtual ~Laser() = default;
  /// Once every control step, and whenever the beam must be off. Neither allocates nor waits. False: the
  /// laser was not told, as far as can be known.
  virtual bool emit(const Emission& emission) noexcept = 0;
  /// The newest measurement of the light: there is some, though the laser had been told to be off, or more
  /// than half as much again as it had been told. A laser that measures nothing never says so.
  virtual bool stray() noexcept { return false; }
  /// What has come under its address and was no measurement of it, so that nothing was made of it.
  virtual std::uint64_t refused() const noexcept { return 0; }
};

/// Opened with the control rate, Hz: how often emit() will be called.
using LaserRegistry = DeviceRegistry<std::unique_ptr<Laser>, double>;
using LaserKind = LaserRegistry::Kind;

/// Gives what it is told to; the record holds that, and the workpiece is burnt from the record.
class SimulatedLaser final : public Laser {
 public:
  bool emit(const Emission&) noexcept override { return true; }
};

inline std::unique_ptr<Laser> open_simulated_laser(std::string_view, double) {
  return std::make_unique<SimulatedLaser>();
}
inline constexpr LaserKind kSimulatedLaser{"simulated", "simulated", no_argument, open_simulated_laser};

}  // namespace telekerf::laser
