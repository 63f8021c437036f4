// SPDX-License-Identifier: Apache-2.0
// The hardware seam: what a vendor's drive must offer. See docs/how-to/add-a-drive.md.
#pragma once

#include <cstdint>
#include <string>

#include "common/runtime/vectors.h"

namespace telekerf::robot {

/// One reading of the three joint sensors.
struct JointReading {
  Vec3 joints_m = Vec3::Zero();
  bool valid = false;        ///< false: no (new) reading; the observers then run on their model
  std::uint64_t tick = 0;    ///< counts readings of the device; unchanged: nothing new
  std::int64_t time_ns = 0;  ///< device's own monotonic time of the sample
};

struct Capabilities {
  std::string name;
  bool simulated = false;
  double resolution_m = 0.0;  ///< of one joint position
  double peak_force_n = 0.0;  ///< of one motor
  double max_rate_hz = 0.0;   ///< largest rate of read/write
};

/// Three joints with position measurement and current control. Neither read nor write may block, allocate or
/// throw: they are called from the control step. A robot holds the last currents until it gets others; a
/// vendor's implementation adds its own watchdog (no write for a while: currents to zero).
class Robot {
 public:
  virtual ~Robot() = default;
  virtual JointReading read() noexcept = 0;
  virtual void write(const Vec3& currents_a) noexcept = 0;
  virtual Capabilities capabilities() const = 0;
  /// What has come under its address and was not a reading of it, so that nothing was made of it.
  virtual std::uint64_t refused() const noexcept { return 0; }
};

}  // namespace telekerf::robot
