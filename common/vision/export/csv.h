// SPDX-License-Identifier: Apache-2.0
// Contours as CSV files, and back.
#pragma once

#include <string>
#include <string_view>
#include <tl/expected.hpp>
#include <vector>

#include "common/geometry/polyline.h"

namespace telekerf::vision {

/// `x_m,y_m` and one line a point, enough digits to come back as the same number.
std::string to_csv(const geometry::Polyline& line);
/// The points of a CSV file with two columns; one heading line is allowed. The error names the line.
tl::expected<std::vector<Vec2>, std::string> points_from_csv(std::string_view text);

}  // namespace telekerf::vision
