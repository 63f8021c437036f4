// SPDX-License-Identifier: Apache-2.0
#include "common/protocol/wire_precision.h"

#include <gtest/gtest.h>

namespace telekerf {
namespace {

TEST(WirePrecision, IsSinglePrecisionAndStaysAsItIs) {
  for (const double value : {0.0, 0.1, -1.0 / 3.0, 1e-9, 60e-3, 1e30}) {
    const double once = to_wire_precision(value);
    EXPECT_EQ(once, static_cast<double>(static_cast<float>(value)));
    EXPECT_EQ(to_wire_precision(once), once);
  }
  EXPECT_NE(to_wire_precision(0.1), 0.1);
}

TEST(WirePrecision, AnAnchorIsOnItsGridAndStaysAsItIs) {
  Anchor anchor;
  anchor.position_m = Vec3(0.1, -0.2, 0.3);
  anchor.velocity_m_per_s = Vec3(1.1, -1.2, 1.3);
  const Anchor wire = to_wire_precision(anchor);
  const Anchor again = to_wire_precision(wire);
  for (int i = 0; i < 3; ++i) {
    EXPECT_NE(wire.position_m[i], anchor.position_m[i]);
    EXPECT_NEAR(wire.position_m[i], anchor.position_m[i], 30e-9);
    EXPECT_NEAR(wire.velocity_m_per_s[i], anchor.velocity_m_per_s[i], 7.7e-6);
    EXPECT_EQ(std::fmod(wire.position_m[i], kPositionGrid_m), 0.0);
    EXPECT_EQ(std::fmod(wire.velocity_m_per_s[i], kVelocityGrid_m_per_s), 0.0);
    EXPECT_EQ(again.position_m[i], wire.position_m[i]);
    EXPECT_EQ(again.velocity_m_per_s[i], wire.velocity_m_per_s[i]);
  }
}

}  // namespace
}  // namespace telekerf
