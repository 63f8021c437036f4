// SPDX-License-Identifier: Apache-2.0
#include "common/vision/extraction/local_level.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "common/vision/extraction/tangents.h"

namespace telekerf::vision {
namespace {

constexpr double kLight_px = 40.0;  ///< to either side along the border: light changes slowly, noise does not

/// Mean of what is there in a window of `half` to either side of each of the closed line's points; nothing
/// where less than an eighth of the window is there.
std::vector<std::optional<double>> averaged(const std::vector<std::optional<double>>& values,
                                            std::ptrdiff_t half) {
  const auto n = static_cast<std::ptrdiff_t>(values.size());
  half = std::min(half, (n - 1) / 2);
  double sum = 0.0;
  std::ptrdiff_t count = 0;
  const auto take = [&](std::ptrdiff_t i, int sign) {
    const auto& value = values[static_cast<std::size_t>(((i % n) + n) % n)];
    if (!value) return;
    sum += sign * *value;
    count += sign;
  };
  for (std::ptrdiff_t i = -half; i < half; ++i) take(i, 1);
  std::vector<std::optional<double>> out(values.size());
  for (std::ptrdiff_t i = 0; i < n; ++i) {
    take(i + half, 1);
    if (4 * count > half) out[static_cast<std::size_t>(i)] = sum / static_cast<double>(count);
    take(i - half, -1);
  }
  return out;
}

}  // namespace

void move_to_local_level(const Field& field, double blur_px, std::vector<Vec2>& points) {
  const double reach = 2.5 * blur_px + 1.0;
  const std::vector<Vec2> tangents = tangents_of(points, true, 3);
  std::vector<std::optional<double>> middle(points.size());
  std::vector<std::optional<double>> step(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    // Round a corner both sides' values are mixed.
    const auto n = points.size();
    const auto near = static_cast<std::size_t>(std::ceil(1.3 * reach)) % n;
    if (tangents[(i + near) % n].dot(tangents[i]) < 0.8 ||
        tangents[(i + n - near) % n].dot(tangents[i]) < 0.8)
      continue;
    const Vec2 left(-tangents[i].y(), tangents[i].x());
    const double a = field.value(points[i] + reach * left);
    const double b = field.value(points[i] - reach * left);
    // Where the two sides are not drawing and background (a thin part) they say nothing.
    if (a * b >= 0.0 || std::abs(a - b) < 0.4 * field.contrast) continue;
    middle[i] = 0.5 * (a + b);
    step[i] = a - b;
  }
  const auto levels = averaged(middle, std::lround(kLight_px));
  const auto steps = averaged(step, std::lround(kLight_px));
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!levels[i] || !steps[i]) continue;
    // Across a border of blur sigma the field is step * Phi(x / sigma); Phi's inverse about its middle.
    const double u = std::clamp(*levels[i] / *steps[i], -0.3, 0.3);
    const double way = blur_px * std::sqrt(2.0 * M_PI) * u * (1.0 + M_PI / 3.0 * u * u);
    points[i] += way * Vec2(-tangents[i].y(), tangents[i].x());
  }
}

}  // namespace telekerf::vision
