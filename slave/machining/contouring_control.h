// SPDX-License-Identifier: Apache-2.0
// Contouring control (eq. 36-57, corrected): the error is controlled along and across the path, each with its
// own gains.
//
// Law, at the measured joints, with e = x_ref - F(q) and R the moving frame's rows (tangent, normal,
// binormal):
//   q''des = J^-1 { x''ref + R' [(2 Rdot + K2 R) e' + (Rddot + K2 Rdot + K1 R) e] - Jdot q' }
// which makes o = R e obey o'' + K2 o' + K1 o = 0 exactly, without coupling from the turning of the frame.
// Where the frame turns faster than the loop along the path (70 rad/s: corners, arcs of less than 0.1 mm at 8
// mm/s) Rdot and Rddot fade out and the gains along become those across; from twice that on each step takes
// the frame as standing, with one gain in all directions of the plane. The normal is horizontal and to the
// left of travel (eq. 38); with constant z the binormal is z.
#pragma once

#include "slave/machining/follower_settings.h"
#include "slave/machining/tracking.h"

namespace telekerf::machining {

/// The moving frame: rows are tangent, normal, binormal; derivatives by time.
struct MovingFrame {
  Mat3 rows = Mat3::Identity();
  Mat3 rate = Mat3::Zero();
  Mat3 rate2 = Mat3::Zero();
};

/// The frame of a reference. A tangent along z has no horizontal normal: then the frame stands still.
MovingFrame moving_frame(const Reference& reference) noexcept;

struct ContouringControl {
  /// Along the path, across it, and along the binormal.
  Vec3 bandwidth_rad_s{60.0, 160.0, 160.0};
  Vec3 damping{1.0, 1.0, 1.0};
  double acceleration_ahead = 0.5;  ///< samples, as in preview control

  static ContouringControl tuned(const PathFollowerSettings& s) noexcept {
    ContouringControl control;
    control.bandwidth_rad_s = {s.along_rad_s, s.across_rad_s, s.across_rad_s};
    control.acceleration_ahead = s.preview ? s.loop_delay + 0.5 : 0.0;
    return control;
  }

  Vec3 update(const Tracking& now) const noexcept;
};

}  // namespace telekerf::machining
