// SPDX-License-Identifier: Apache-2.0
// The width of the cut, compensated by moving the path to the waste's side.
#pragma once

#include <string>
#include <tl/expected.hpp>

#include "common/geometry/polyline.h"

namespace telekerf::geometry {

/// The closed contour moved by half the kerf: outwards (the piece inside keeps its size), or inwards for a
/// hole. Loops that the move makes at tight inner corners are cut off. An open line comes back as it is. An
/// error, one sentence: the contour is somewhere narrower than the kerf.
tl::expected<Polyline, std::string> compensated(const Polyline& contour, double kerf_m, bool hole);

}  // namespace telekerf::geometry
