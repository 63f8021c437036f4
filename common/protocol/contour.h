// SPDX-License-Identifier: Apache-2.0
// The contour that vision publishes, true size, metres in the workpiece frame.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "common/runtime/vectors.h"

namespace telekerf {

/// Bounds of a published contour (idl/telekerf.idl): points of the contour itself, and of all further lines
/// together; further lines.
inline constexpr std::size_t kMaxContourPoints = 100'000;
inline constexpr std::size_t kMaxContourLines = 1000;

/// Points in drawing order; a closed line does not repeat its first.
struct ContourLine {
  bool closed = true;
  std::vector<Vec2> points_m;
};

/// Vision -> everyone, latched and reliable; points as in ContourLine.
struct ContourMessage {
  std::uint32_t id = 0;
  bool closed = true;
  std::string source;  ///< file or camera
  std::string mode;    ///< outline, stroke or thesis
  double metres_per_pixel = 0.0;
  double deviation_m = 0.0;  ///< quality record: estimated noise of the points, rms
  std::vector<Vec2> points_m;
  std::vector<ContourLine> further;  ///< the picture's other contours: a hand follows one, a machine cuts all
};

/// The id that a contour has: the same lines have the same after a restart, others have another. Never 0,
/// which is nobody's. Whoever receives a contour computes it again.
std::uint32_t digest_of(const ContourMessage& message);

}  // namespace telekerf
