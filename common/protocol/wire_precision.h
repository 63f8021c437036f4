// SPDX-License-Identifier: Apache-2.0
// What the wire does to numbers: blocks carry single precision. A sender rounds before it uses a value
// itself, so that its codec and its model hold exactly what the receiver will see.
#pragma once

#include "common/protocol/blocks.h"

namespace telekerf {

/// Through memory: g++ 12.2 at -O2 vectorizes double -> float -> double and forgets the rounding of some
/// elements.
inline double to_wire_precision(double value) noexcept {
  const volatile float single = static_cast<float>(value);
  return static_cast<double>(single);
}

/// The anchor as the receiver sees it. Number by number: g++ 12 at -O2 loses the rounding of chained Eigen
/// casts.
inline Anchor to_wire_precision(Anchor anchor) noexcept {
  for (int i = 0; i < 3; ++i) {
    anchor.position_m[i] = to_wire_precision(anchor.position_m[i]);
    anchor.velocity_m_per_s[i] = to_wire_precision(anchor.velocity_m_per_s[i]);
  }
  return anchor;
}

}  // namespace telekerf
