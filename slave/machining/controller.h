// SPDX-License-Identifier: Apache-2.0
// The ways to follow a path, behind one interface: measured state and references in, desired joint
// acceleration out (thesis 4.2, 4.3). A controller is its own header (gains, tuned() and update()), and what
// this page says of it: a type, a kind, a row and a case.
#pragma once

#include <cstdint>
#include <variant>

#include "common/runtime/enum_table.h"
#include "slave/machining/contouring_control.h"
#include "slave/machining/independent_control.h"
#include "slave/machining/preview_control.h"

namespace telekerf::machining {

using Controller = std::variant<IndependentControl, PreviewControl, ContouringControl>;

enum class ControllerKind : std::uint8_t {
  kAuto,  ///< contouring on closed contours, preview on open ones
  kIndependent,
  kPreview,
  kContouring,
};
inline constexpr EnumRow<ControllerKind> kControllerRows[] = {
    {"auto", ControllerKind::kAuto, "contouring on closed contours, preview on open ones"},
    {"independent", ControllerKind::kIndependent, "every joint for itself"},
    {"preview", ControllerKind::kPreview, "joints with the accelerations of the samples to come"},
    {"contouring", ControllerKind::kContouring, "loops along and across the path"},
};
inline constexpr EnumTable<ControllerKind> kControllers(kControllerRows);

/// What "auto" is on such a contour; any other kind is itself.
inline ControllerKind chosen(ControllerKind kind, bool closed) noexcept {
  if (kind != ControllerKind::kAuto) return kind;
  return closed ? ControllerKind::kContouring : ControllerKind::kPreview;
}

/// The controller of a kind with gains and preview that match the loop.
inline Controller make_controller(ControllerKind kind, bool closed, const PathFollowerSettings& s) noexcept {
  switch (chosen(kind, closed)) {
    case ControllerKind::kIndependent:
      return IndependentControl::tuned(s);
    case ControllerKind::kContouring:
      return ContouringControl::tuned(s);
    case ControllerKind::kPreview:
    case ControllerKind::kAuto:
      break;
  }
  return PreviewControl::tuned(s);
}

/// Desired joint acceleration, m/s^2. Real-time: noexcept, no allocation. Not finite only if the reference is
/// no pose of the robot.
inline Vec3 desired_acceleration(const Controller& controller, const Tracking& now) noexcept {
  return std::visit([&](const auto& law) noexcept { return law.update(now); }, controller);
}

}  // namespace telekerf::machining
