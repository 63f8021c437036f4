// SPDX-License-Identifier: Apache-2.0
#include "common/reporting/tracking_error.h"

#include "common/reporting/run_lookup.h"

namespace telekerf::reporting {

bool settled_at(const RunRecord& record, const SlaveRow& row) {
  return row.settled && row.applied >= 0.0 && joined_at(record, row.applied);
}

TrackingError tracking_error(const RunRecord& record) {
  TrackingError error;
  for (const SlaveRow& row : record.slave) {
    if (row.applied < 0.0) continue;
    const bool settled = settled_at(record, row);
    if (!settled && error.tracking.count == 0) continue;  // still in the first approach
    const auto master_m = master_at(record, row.applied, &MasterRow::tool_m);
    if (!master_m) continue;  // the master's record does not reach so far
    const double tracking_m = (row.tool_m - beta_at(record, row.applied) * *master_m).norm();
    const double prediction_m =
        (row.tool_m - *master_at(record, row.applied, &MasterRow::predicted_m)).norm();
    error.tracking.add(tracking_m);
    error.prediction.add(prediction_m);
    if (row.laser_w > 0.0) error.laser_on.add(tracking_m);
    if (!settled) continue;
    error.settled_tracking.add(tracking_m);
    error.settled_prediction.add(prediction_m);
  }
  return error;
}

}  // namespace telekerf::reporting
