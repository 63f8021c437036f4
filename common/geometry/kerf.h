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

/// Where the contour's slots and notches are narrower than the kerf the moved line passes them by. One
/// sentence that says how deep the deepest is; empty where none is deeper than 1.5 times the kerf.
std::string passed_by(const Polyline& contour, const Polyline& moved, double kerf_m);

}  // namespace telekerf::geometry
