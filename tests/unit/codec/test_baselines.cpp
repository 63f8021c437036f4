// SPDX-License-Identifier: Apache-2.0
// SDCT against the baselines at equal RMS error and delay, on the seeded traces.
#include <gtest/gtest.h>

#include <cmath>

#include "common/codec/baselines/deadband.h"
#include "common/codec/baselines/measure.h"
#include "experiments/codec/codec_traces.h"

namespace telekerf::codec {
namespace {

struct Point {
  double rmse = 0.0;
  double bits = 0.0;
};

Point at_step(const Trace& trace, const char* codec, int block, double step) {
  StreamSettings settings{.block = block, .keep = block, .redundancy = 0, .quantum = step, .anchored = false};
  settings = with_codec(settings, codec);
  if (settings.kind == kDeadband) {
    settings.threshold = step / std::sqrt(3.0);
    settings.quantum = step / std::sqrt(12.0);
  }
  const CodingResult figures = measure(trace, settings);
  return {figures.rmse, figures.bits_per_sample};
}

/// Bits a sample at that RMS error, between two steps a quarter octave apart.
double bits_at(const Trace& trace, const char* codec, int block, double rmse) {
  Point below = at_step(trace, codec, block, rmse);
  for (int i = 1; i < 24; ++i) {
    const Point above = at_step(trace, codec, block, rmse * std::exp2(0.25 * i));
    if (below.rmse <= rmse && rmse < above.rmse) {
      const double part = std::log(rmse / below.rmse) / std::log(above.rmse / below.rmse);
      return below.bits + part * (above.bits - below.bits);
    }
    below = above;
  }
  ADD_FAILURE() << trace.name << ": " << codec << " never has an RMS error of " << rmse;
  return std::nan("");
}

TEST(Baselines, TruncationIsNeverMuchCheaperAndADeadBandTwiceAsDearOnForces) {
  for (const auto& seeded : experiments::seeded_traces(5.0, 1000.0, 1)) {
    for (const int block : {16, 32}) {
      for (const double factor : {1.0, 4.0}) {
        const double rmse = factor * seeded.fine;
        const double sdct = bits_at(seeded.trace, "sdct", block, rmse);
        const double truncated = bits_at(seeded.trace, "truncated", block, rmse);
        EXPECT_LE(block * (sdct - truncated), 0.2) << seeded.trace.name << " N " << block << " at " << rmse;
        if (seeded.trace.name != "force") continue;
        const double deadband = bits_at(seeded.trace, "deadband", block, rmse);
        EXPECT_LE(sdct, 0.5 * deadband)
            << "N " << block << " at " << rmse << ": " << sdct << ", " << deadband;
      }
    }
  }
}

}  // namespace
}  // namespace telekerf::codec
