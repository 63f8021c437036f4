// SPDX-License-Identifier: Apache-2.0
// Which circle of the guide is in force at the tool (thesis 3.3 and 5.1, Algorithm 1). Master's workpiece
// frame.
#pragma once

#include <optional>

#include "master/constraint/guide_path.h"

namespace telekerf::master {

/// The circle (or line) that is in force for one tick; frozen within it (c' = 0).
struct ActiveConstraint {
  GuidePiece piece;
  double phi_m = 0.0;          ///< signed distance of the tool, positive to the left of travel
  double drift_m_per_s = 0.0;  ///< partial time derivative of phi: the circle is not the last tick's
  double beyond_end_m = 0.0;   ///< how far the tool is past an end of an open curve (signed)
  SpeedLimit limit{1.0, 0.0};
};

/// Algorithm 1 with a local search from the last foot point, so that a tool at a crossing stays on its
/// branch.
class ConstraintGenerator {
 public:
  void reset() noexcept { last_.reset(); }
  ActiveConstraint at(const GuidePath& guide, const Vec2& tool_m, double dt_s) noexcept;

 private:
  std::optional<GuidePiece> last_;
};

}  // namespace telekerf::master
