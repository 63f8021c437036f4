// SPDX-License-Identifier: Apache-2.0
#include "slave/vision/hand_drawing.h"

#include <fmt/format.h>

#include <algorithm>

#include "common/geometry/polyline.h"
#include "common/geometry/smoothing.h"

namespace telekerf::vision_process {

bool HandDrawing::add(const std::vector<Vec2>& places_m) {
  if (places_m_.size() + places_m.size() > kMostPlaces) return false;
  for (const Vec2& place_m : places_m) {
    if (places_m_.empty() || (place_m - places_m_.back()).norm() > 1e-6) places_m_.push_back(place_m);
  }
  return true;
}

tl::expected<ContourMessage, std::string> HandDrawing::contour(bool closed, double workspace_radius_m) const {
  geometry::Polyline line{places_m_, closed && places_m_.size() > 2};
  const double length_m = places_m_.size() < 2 ? 0.0 : geometry::length_m(line);
  if (length_m < kShortest_m)
    return tl::unexpected(fmt::format("what was drawn is {:.2f} mm long; a contour takes at least {:g} mm",
                                      1e3 * length_m, 1e3 * kShortest_m));
  const double spacing_m = std::max(kSpacing_m, length_m / static_cast<double>(kMaxContourPoints - 1));
  line = geometry::resampled(line, spacing_m);
  (void)geometry::smooth_keeping_bends(line.points_m, line.closed, kTremor_m / spacing_m);
  double reach_m = 0.0;
  for (const Vec2& point_m : line.points_m) reach_m = std::max(reach_m, point_m.norm());
  if (reach_m > workspace_radius_m) {
    return tl::unexpected(
        fmt::format("what was drawn reaches {:.1f} mm from the workspace's centre, but the "
                    "slave only {:.1f} mm; draw nearer to the middle",
                    1e3 * reach_m, 1e3 * workspace_radius_m));
  }
  ContourMessage message;
  message.closed = line.closed;
  message.source = "by hand";
  message.mode = "drawn";
  message.points_m = std::move(line.points_m);
  message.id = digest_of(message);
  return message;
}

}  // namespace telekerf::vision_process
