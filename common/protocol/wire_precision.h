// SPDX-License-Identifier: Apache-2.0
// What the wire does to numbers: beta is carried in single precision, anchors on a grid. A sender rounds
// before it uses a value itself, so that its codec and its model hold exactly what the receiver will see.
#pragma once

#include <cmath>

#include "common/protocol/blocks.h"

namespace telekerf {

/// 60 nm, and 15 um/s: over a block of 16 ms that comes to no more.
inline constexpr double kPositionGrid_m = 0x1p-24;
inline constexpr double kVelocityGrid_m_per_s = 0x1p-16;

/// Through memory: g++ 12.2 at -O2 vectorizes double -> float -> double and forgets the rounding of some
/// elements.
inline double to_wire_precision(double value) noexcept {
  const volatile float single = static_cast<float>(value);
  return static_cast<double>(single);
}

/// The anchor as the receiver sees it.
inline Anchor to_wire_precision(Anchor anchor) noexcept {
  for (int i = 0; i < 3; ++i) {
    anchor.position_m[i] = std::nearbyint(anchor.position_m[i] / kPositionGrid_m) * kPositionGrid_m;
    anchor.velocity_m_per_s[i] =
        std::nearbyint(anchor.velocity_m_per_s[i] / kVelocityGrid_m_per_s) * kVelocityGrid_m_per_s;
  }
  return anchor;
}

}  // namespace telekerf
