// SPDX-License-Identifier: Apache-2.0
#include "common/vision/extraction/ends.h"

#include <algorithm>
#include <cstddef>

namespace telekerf::vision {

void apply_ends(Contours& contours, const std::optional<Vec2>& start, const std::optional<Vec2>& end) {
  if (!start && !end) return;
  const auto nearest = [](const PixelContour& c, const Vec2& p) {
    std::size_t best = 0;
    for (std::size_t i = 1; i < c.points_px.size(); ++i) {
      if ((c.points_px[i] - p).squaredNorm() < (c.points_px[best] - p).squaredNorm()) best = i;
    }
    return best;
  };
  // The contour that the first given point lies on comes first.
  const Vec2 wanted = start ? *start : *end;
  const auto distance = [&](const PixelContour& c) {
    return (c.points_px[nearest(c, wanted)] - wanted).norm();
  };
  const auto chosen = std::min_element(contours.begin(), contours.end(), [&](const auto& a, const auto& b) {
    return distance(a) + 1e-6 < distance(b);
  });
  std::rotate(contours.begin(), chosen, chosen + 1);
  PixelContour& c = contours.front();
  auto& p = c.points_px;
  const auto near = static_cast<std::size_t>(1.5 * c.width_px + 5.0);
  if (c.closed) {
    if (start) std::rotate(p.begin(), p.begin() + nearest(c, *start), p.end());
    if (!start || !end) return;
    const std::size_t last = nearest(c, *end);
    if (last <= near || last + near >= p.size()) return;  // all the way round
    // Of the two ways round, the longer one leaves less undone.
    if (2 * last < p.size()) {
      std::reverse(p.begin() + 1, p.end());
      p.resize(p.size() - last + 1);
    } else {
      p.resize(last + 1);
    }
    c.closed = false;
    return;
  }
  std::size_t first = start ? nearest(c, *start) : 0;
  std::size_t last = end ? nearest(c, *end) : p.size() - 1;
  if (start && !end && 2 * first > p.size()) last = 0;
  if (end && !start && 2 * last < p.size()) first = p.size() - 1;
  if (first > last) {
    std::reverse(p.begin(), p.end());
    first = p.size() - 1 - first;
    last = p.size() - 1 - last;
  }
  if (last + near < p.size()) p.resize(last + 1);
  if (first > near) p.erase(p.begin(), p.begin() + first);
}

}  // namespace telekerf::vision
