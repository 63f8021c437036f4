// SPDX-License-Identifier: Apache-2.0
#include "common/reporting/run_lookup.h"

#include <algorithm>

namespace telekerf::reporting {
namespace {

/// The master's row at or before a tick that the record holds.
const MasterRow& row_at(const RunRecord& record, double tick) {
  return record.master[static_cast<std::size_t>(tick - static_cast<double>(record.master.front().tick))];
}

}  // namespace

double metric(const Metrics& metrics, const std::string& name, double fallback) {
  const auto found = metrics.find(name);
  return found == metrics.end() ? fallback : found->second;
}

double control_period_s(const RunRecord& record) {
  const auto& rows = record.slave;
  const double between_rows_s =
      rows.size() < 2 ? 0.0 : (rows.back().t_s - rows.front().t_s) / static_cast<double>(rows.size() - 1);
  return metric(record.slave_figures, "control_period_s", between_rows_s);
}

std::optional<Vec3> master_at(const RunRecord& record, double tick, Vec3 MasterRow::*position) {
  if (record.master.empty()) return std::nullopt;
  const double place = tick - static_cast<double>(record.master.front().tick);
  if (!(place >= 0.0) || place > static_cast<double>(record.master.size() - 1)) return std::nullopt;
  const auto index = static_cast<std::size_t>(place);
  const double part = place - static_cast<double>(index);
  const auto& a = record.master[index].*position;
  const auto& b = record.master[std::min(index + 1, record.master.size() - 1)].*position;
  return Vec3(a[0] + part * (b[0] - a[0]), a[1] + part * (b[1] - a[1]), a[2] + part * (b[2] - a[2]));
}

bool joined_at(const RunRecord& record, double tick) {
  return master_at(record, tick, &MasterRow::tool_m) && row_at(record, tick).joined;
}

double beta_at(const RunRecord& record, double tick) { return row_at(record, tick).beta; }

Contours::Contours(const RunRecord& record) {
  for (const EarlierContour& earlier : record.earlier) {
    until_.push_back(static_cast<double>(earlier.until_tick));
    indices_.emplace_back(geometry::Polyline{earlier.points_m, earlier.closed});
  }
  indices_.emplace_back(geometry::Polyline{record.contour_m, record.contour_closed});
}

const geometry::NearestIndex& Contours::at(double master_tick) const {
  const auto later = std::upper_bound(until_.begin(), until_.end(), master_tick);
  return indices_[static_cast<std::size_t>(later - until_.begin())];
}

}  // namespace telekerf::reporting
