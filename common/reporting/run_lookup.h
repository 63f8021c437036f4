// SPDX-License-Identifier: Apache-2.0
// What both ends of a run knew of one tick, and what both of its reports need.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/geometry/nearest.h"
#include "common/recording/run_record.h"
#include "common/runtime/vectors.h"

namespace telekerf::reporting {

inline Vec2 in_plane(const Vec3& point) { return point.head<2>(); }

/// One of the metrics, or `fallback` if the run has none of that name.
double metric(const Metrics& metrics, const std::string& name, double fallback = 0.0);

/// Length of the slave's tick, s.
double control_period_s(const RunRecord& record);

/// One of the master's positions at a tick that may lie between two of its rows; none outside of the record.
std::optional<Vec3> master_at(const RunRecord& record, double tick, Vec3 MasterRow::*position);

/// Whether the slave had been brought to the master's motion by that tick.
bool joined_at(const RunRecord& record, double tick);

/// Slave motion = beta x master motion at that tick, which the record must hold.
double beta_at(const RunRecord& record, double tick);

/// Which contour was in force when; workpiece frame.
class Contours {
 public:
  explicit Contours(const RunRecord& record);
  /// That of the end of the run.
  const geometry::NearestIndex& last() const { return indices_.back(); }
  const geometry::NearestIndex& at(double master_tick) const;

 private:
  std::vector<double> until_;
  std::vector<geometry::NearestIndex> indices_;
};

}  // namespace telekerf::reporting
