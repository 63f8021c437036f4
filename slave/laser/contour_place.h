// SPDX-License-Identifier: Apache-2.0
// Where on the contour the tool is expected, and how far from it: another part of the line that happens to be
// near is none.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "common/geometry/nearest.h"

namespace telekerf::laser {

class ContourPlace {
 public:
  struct Place {
    double distance_m = 0.0;  ///< tool to the expected stretch of the contour, in plane
    double arc_gap_m = 0.0;   ///< along the contour, from where the tool is expected
  };

  /// Every control step. `expected_m`: where the tool is to be. `anew`: it may be expected anywhere on the
  /// contour, as nothing burns at this step; else it is expected where its way along the contour has led it.
  Place step(const geometry::NearestIndex& contour, const Vec2& expected_m, const Vec2& tool_m,
             bool anew) noexcept {
    if (anew || contour_ != &contour || !segment_) segment_ = contour.find(expected_m).segment;
    contour_ = &contour;
    const geometry::Nearest expected = contour.find_near(expected_m, *segment_);
    segment_ = expected.segment;
    const geometry::Nearest tool = contour.find_near(tool_m, *segment_);
    double gap_m = std::abs(tool.arc_length_m - expected.arc_length_m);
    if (contour.line().closed) gap_m = std::min(gap_m, contour.length_m() - gap_m);
    return {tool.distance_m, gap_m};
  }
  /// Farthest from the contour that the tool can be `reaction_s` from now, wherever the measured and the
  /// commanded velocity and `max_m_per_s2` lead it. An upper bound if that is good enough for `enough_m`.
  double predicted_distance_m(const geometry::NearestIndex& contour, const Place& now, const Vec2& tool_m,
                              const Vec2& measured_m_per_s, const Vec2& commanded_m_per_s,
                              double max_m_per_s2, double reaction_s, double enough_m) const noexcept {
    const double unknown_m = 0.5 * max_m_per_s2 * reaction_s * reaction_s;
    const double measured = measured_m_per_s.norm();
    const double commanded = commanded_m_per_s.norm();
    const double sum = measured + commanded;  // a NaN in either is one of both
    const double speed = std::isfinite(sum) ? std::max(measured, commanded) : sum;
    const double bound_m = now.distance_m + speed * reaction_s + unknown_m;
    if (bound_m <= enough_m || contour_ != &contour || !segment_) return bound_m;
    const auto at = [&](const Vec2& velocity) noexcept {
      return contour.find_near(tool_m + reaction_s * velocity, *segment_).distance_m;
    };
    const double measured_m = at(measured_m_per_s);
    const double commanded_m = at(commanded_m_per_s);
    if (!std::isfinite(measured_m + commanded_m)) return std::numeric_limits<double>::quiet_NaN();
    return std::max({now.distance_m, measured_m, commanded_m}) + unknown_m;
  }

 private:
  const geometry::NearestIndex* contour_ = nullptr;  ///< to be compared only: it may be gone
  std::optional<std::size_t> segment_;               ///< where the tool was expected last
};

}  // namespace telekerf::laser
