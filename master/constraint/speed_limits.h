// SPDX-License-Identifier: Apache-2.0
// How fast the bends of a curve may be passed, and how early the tool is slowed down for them.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "common/geometry/polyline.h"
#include "master/constraint/constraint_settings.h"

namespace telekerf::master {

/// How fast the tool may run if it is to be slow enough in every bend ahead, either way, and the derivative
/// of that along the arc.
struct SpeedLimit {
  double m_per_s;
  double slope_per_s;
};

class SpeedLimits {
 public:
  /// `line`: evenly spaced by `spacing_m`; `curvature_at`: of what stands for it, 1/m, signed, at a fraction
  /// of its length. Allocates.
  SpeedLimits(const geometry::Polyline& line, double spacing_m, const ConstraintSettings& settings,
              const std::function<double(double)>& curvature_at);

  /// At a fraction of the length, [0, 1].
  SpeedLimit at(double fraction) const noexcept;

 private:
  double spacing_m_;
  std::size_t segments_;
  std::vector<double> limit_m_per_s_;  ///< at the points
};

}  // namespace telekerf::master
