// SPDX-License-Identifier: Apache-2.0
// Plain truncation is one of SDCT's choices: on no kind of trace is SDCT dearer by more than a hair.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "experiments/codec/codec_rates.h"

namespace telekerf::experiments {
namespace {

TEST(Sdct, IsNeverDearerThanTruncation) {
  constexpr double kHair_bits = 0.05;  // a block and axis
  double dearest = -1e9;
  for (const SeededTrace& seeded : seeded_traces(5.0, 1000.0, 3)) {
    for (const int block : {16, 32}) {
      const Curve sdct = sweep(seeded, kContenders[0], block);
      const Curve truncated = sweep(seeded, kContenders[3], block);
      for (int i = 2 * kSweepFrom; i <= 2 * kSweepTo; ++i) {
        const double rmse = seeded.fine * std::exp2(0.25 * i);
        const double dearer = block * (bits_at(sdct, rmse) - bits_at(truncated, rmse));
        if (!std::isfinite(dearer)) continue;
        dearest = std::max(dearest, dearer);
        EXPECT_LE(dearer, kHair_bits) << seeded.trace.name << ", N = " << block << ", RMS " << rmse;
      }
    }
  }
  std::printf("at most %.3f bits a block dearer\n", dearest);
}

}  // namespace
}  // namespace telekerf::experiments
