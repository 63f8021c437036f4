// SPDX-License-Identifier: Apache-2.0
// Contours as CSV files, and back.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <tl/expected.hpp>
#include <vector>

#include "common/geometry/polyline.h"

namespace telekerf::vision {

/// `x_m,y_m` and one line a point, enough digits to come back as the same number.
std::string to_csv(const geometry::Polyline& line);
/// `x_m,y_m,contour`: all contours, each point with its contour's number; `first` comes before the others.
std::string to_csv(std::span<const geometry::Polyline> contours, std::size_t first);
/// The points of a CSV file with two columns; one heading line is allowed. Where that names a third column
/// `contour`, the points of the first contour. The error names the line.
tl::expected<std::vector<Vec2>, std::string> points_from_csv(std::string_view text);

}  // namespace telekerf::vision
