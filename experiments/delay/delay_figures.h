// SPDX-License-Identifier: Apache-2.0
// The pictures of telekerf-experiment delay.
#pragma once

#include <filesystem>
#include <vector>

#include "experiments/delay/delay_runs.h"

namespace telekerf::experiments {

/// Tracking and prediction against the round trip, a line a rival.
void draw_rtt(const std::vector<Run>& runs, const std::filesystem::path& png);
/// How far the largest stable w D is from theory, measured on a grid.
void draw_stability(const std::filesystem::path& png);
/// What becomes of a wrong start, estimator by estimator, on an exact double integrator.
void draw_start(const std::filesystem::path& png);

}  // namespace telekerf::experiments
