// SPDX-License-Identifier: Apache-2.0
// The directions of a line of points.
#pragma once

#include <cstddef>
#include <vector>

#include "common/runtime/vectors.h"

namespace telekerf::vision {

/// Unit tangents of a line from the points `reach` before and after each.
std::vector<Vec2> tangents_of(const std::vector<Vec2>& p, bool closed, std::size_t reach);

}  // namespace telekerf::vision
