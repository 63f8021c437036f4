// SPDX-License-Identifier: Apache-2.0
// The motion of least jerk between two rests (Flash and Hogan, 1985), in normalised time and way.
#pragma once

namespace telekerf::geometry {

/// Fraction of the way that is done, and its derivatives by normalised time.
struct MinimumJerk {
  double place;
  double rate;   ///< times way / duration: speed
  double rate2;  ///< times way / duration^2: acceleration
};

/// s(u) = 10 u^3 - 15 u^4 + 6 u^5. `u`: fraction of the duration, 0..1.
constexpr MinimumJerk minimum_jerk(double u) noexcept {
  return {u * u * u * (10.0 + u * (-15.0 + 6.0 * u)), 30.0 * u * u * (1.0 - u) * (1.0 - u),
          60.0 * u * (1.0 - u) * (1.0 - 2.0 * u)};
}

/// Largest rate, at the middle, and a bound of the largest rate2 (10 / sqrt 3 = 5.7735).
inline constexpr double kMinimumJerkPeakRate = 1.875;
inline constexpr double kMinimumJerkPeakRate2 = 5.78;

}  // namespace telekerf::geometry
