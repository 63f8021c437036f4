// SPDX-License-Identifier: Apache-2.0
#include "common/vision/extraction/dashes.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace telekerf::vision {

int dashes_in(const Contours& contours) {
  constexpr std::size_t kFewest = 5;
  constexpr std::size_t kMost = 400;
  constexpr double kStraight = 0.85;  // from end to end, over the length
  constexpr double kAlike = 0.4;      // of the median length
  constexpr double kGap = 1.5;        // likewise, to the next dash
  constexpr double kOnward = 0.8;     // cosine: the next one goes on the same way, nearly
  struct Dash {
    Vec2 from;
    Vec2 to;
    double length = 0.0;
  };
  std::vector<Dash> dashes;
  for (const PixelContour& c : contours) {
    if (c.closed || c.width_px <= 0.0) continue;
    const double length = length_px(c);
    const Vec2& from = c.points_px.front();
    const Vec2& to = c.points_px.back();
    if ((to - from).norm() > kStraight * length) dashes.push_back({from, to, length});
  }
  if (dashes.size() < kFewest || dashes.size() > kMost) return 0;
  std::vector<double> lengths;
  for (const Dash& d : dashes) lengths.push_back(d.length);
  const auto middle = lengths.begin() + static_cast<std::ptrdiff_t>(lengths.size() / 2);
  std::nth_element(lengths.begin(), middle, lengths.end());
  const double median = *middle;
  std::erase_if(dashes, [&](const Dash& d) { return std::abs(d.length - median) > kAlike * median; });
  // Each goes on in another one, at one end at least.
  const auto goes_on = [&](const Dash& a) {
    return std::any_of(dashes.begin(), dashes.end(), [&](const Dash& b) {
      if (&a == &b) return false;
      const double turn = (a.to - a.from).normalized().dot((b.to - b.from).normalized());
      const double gap = std::min(
          {(a.to - b.from).norm(), (a.to - b.to).norm(), (a.from - b.from).norm(), (a.from - b.to).norm()});
      const Vec2 across = 0.5 * (b.from + b.to) - 0.5 * (a.from + a.to);
      return gap < kGap * median && std::abs(turn) > kOnward &&
             std::abs(across.normalized().dot((a.to - a.from).normalized())) > kOnward;
    });
  };
  const auto count = static_cast<std::size_t>(std::count_if(dashes.begin(), dashes.end(), goes_on));
  return count < kFewest ? 0 : static_cast<int>(count);
}

}  // namespace telekerf::vision
