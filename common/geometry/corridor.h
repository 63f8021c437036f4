// SPDX-License-Identifier: Apache-2.0
// The strip about a contour that the laser may not leave.
#pragma once

namespace telekerf::geometry {

/// To either side of the contour, judged at the beam's centre: the interlock, the machining and every report
/// measure by it.
inline constexpr double kCorridorHalfWidth_m = 0.5e-3;

}  // namespace telekerf::geometry
