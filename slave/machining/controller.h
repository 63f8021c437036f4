// SPDX-License-Identifier: Apache-2.0
// The three ways to follow a path, behind one interface: measured state and references in, desired joint
// acceleration out (thesis 4.2, 4.3).
#pragma once

#include <string_view>
#include <variant>

#include "slave/machining/contouring_control.h"
#include "slave/machining/independent_control.h"
#include "slave/machining/preview_control.h"

namespace telekerf::machining {

using Controller = std::variant<IndependentControl, PreviewControl, ContouringControl>;

/// Desired joint acceleration, m/s^2. Real-time: noexcept, no allocation. Not finite only if the reference is
/// no pose of the robot.
inline Vec3 desired_acceleration(const Controller& controller, const Tracking& now) noexcept {
  switch (controller.index()) {
    case 0:
      return std::get_if<IndependentControl>(&controller)->update(now);
    case 1:
      return std::get_if<PreviewControl>(&controller)->update(now);
    default:
      return std::get_if<ContouringControl>(&controller)->update(now);
  }
}

}  // namespace telekerf::machining
