// SPDX-License-Identifier: Apache-2.0
// Tracking and prediction of a run (docs/reference/contract.md, "Measures"): the slave's tool at the tick
// that it applied, against the master's of that same tick and against what the master predicted for it.
#pragma once

#include <cstddef>

#include "common/recording/run_record.h"
#include "common/runtime/error_statistics.h"

namespace telekerf::reporting {

/// Errors in m, norms in space. Of every tick that the slave applied from the end of the first approach on:
/// after gaps, on concealed samples, on the way back to the master's motion.
struct TrackingError {
  ErrorStatistics tracking;
  ErrorStatistics prediction;
  ErrorStatistics laser_on;  ///< tracking while the beam was on
  /// Of those among them at which nothing was left of an approach or a gap.
  ErrorStatistics settled_tracking;
  ErrorStatistics settled_prediction;
  std::size_t left_out() const { return tracking.count - settled_tracking.count; }
};

/// Whether nothing is left of an approach where the slave applied this row, on either side.
bool settled_at(const RunRecord& record, const SlaveRow& row);

TrackingError tracking_error(const RunRecord& record);

}  // namespace telekerf::reporting
