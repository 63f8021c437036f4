// SPDX-License-Identifier: Apache-2.0
// Along a line through a picture: its directions, and the field beside it.
#pragma once

#include <vector>

#include "common/vision/modes.h"

namespace telekerf::vision {

/// The field between pixels, bilinear; far outside the picture it is background.
double field_at(const Field& field, const Vec2& p);

/// Unit tangents of a line from the points `reach` before and after each.
std::vector<Vec2> tangents_of(const std::vector<Vec2>& p, bool closed, std::size_t reach);

}  // namespace telekerf::vision
