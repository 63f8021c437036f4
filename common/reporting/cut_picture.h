// SPDX-License-Identifier: Apache-2.0
// What the laser burnt, drawn from a run's record.
#pragma once

#include <opencv2/core.hpp>

#include "common/recording/run_record.h"

namespace telekerf::reporting {

/// Wood, burned where energy went; the contour as a thin blue line, the slave's path without laser as a grey
/// one. CV_8UC3.
cv::Mat draw_cut(const RunRecord& record);

}  // namespace telekerf::reporting
