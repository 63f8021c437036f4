// SPDX-License-Identifier: Apache-2.0
// What no codec can beat if the signal were Gaussian with its measured second moments.
#pragma once

#include <vector>

#include "common/codec/baselines/trace.h"

namespace telekerf::experiments {

struct RatePoint {
  double rmse = 0;
  double bits_per_sample = 0;
};

/// Gaussian rate-distortion function by reverse water-filling over all columns at once: D = mean min(theta,
/// v), R = mean max(0, log2(v / theta) / 2), v the variances of independent components. Signals that are not
/// Gaussian (steps, say) can be sent in fewer bits than this.
std::vector<RatePoint> gaussian_limit(const std::vector<double>& variances, const std::vector<double>& rmse);

/// Variances for unlimited delay: the measured power spectrum (Welch, cos^4 window), one value a frequency
/// and column.
std::vector<double> spectrum_of(const codec::Trace& trace);
/// Variances for blocks of N samples that are coded alone: eigenvalues of the blocks' measured covariance.
std::vector<double> block_variances_of(const codec::Trace& trace, int block);

}  // namespace telekerf::experiments
