// SPDX-License-Identifier: Apache-2.0
// The hardware seam of the laser.
#pragma once

namespace telekerf::slave {

/// What a vendor implements (docs/attach-a-drive.md). It is entered in beam.cpp, and nowhere else.
class Laser {
 public:
  virtual ~Laser() = default;
  /// Once every control step, and whenever the beam must be off: average power until the next call, finite
  /// and not negative, and the visible pilot beam. Neither allocates nor waits. False: the laser was not
  /// told, as far as can be known.
  virtual bool emit(double power_w, bool pilot) noexcept = 0;
};

/// Gives what it is told to; the record holds that, and the workpiece is burnt from the record.
class SimulatedLaser final : public Laser {
 public:
  bool emit(double, bool) noexcept override { return true; }
};

}  // namespace telekerf::slave
