// SPDX-License-Identifier: Apache-2.0
// What hands do beside their work: push suddenly, slip, let go, fight the constraint with all they have.
#pragma once

#include <cstdint>
#include <span>

#include "common/protocol/messages.h"

namespace telekerf::master {

struct OperatorDisturbance {
  enum class Kind : std::uint8_t {
    kPush,   ///< a knock: half a sine of force, `force_n` at its top, on top of the work
    kSlip,   ///< the wrist gives way: `force_n` at once, fading over its time, on top of the work
    kLetGo,  ///< no force at all
    kFight,  ///< nothing but `force_n`, from one moment to the next
  };
  Kind kind = Kind::kPush;
  double at_s = 0.0;  ///< after the hand was first guided
  double for_s = 0.1;
  double force_n = 0.0;    ///< across the curve, positive to the left of travel
  double along_n = 0.0;    ///< along it
  double upwards_n = 0.0;  ///< in z
};

/// The work's force, changed by what happens at `since_s`. `tangent`: unit, of the curve at the pen.
Vec3 disturbed(std::span<const OperatorDisturbance> disturbances, double since_s, const Vec2& tangent,
               const Vec3& work_n) noexcept;

}  // namespace telekerf::master
