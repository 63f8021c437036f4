// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>

#include "slave/laser/interlock.h"

namespace telekerf::laser {
namespace {

InterlockInputs good() {
  InterlockInputs inputs;
  inputs.contour_known = inputs.engaged = inputs.fresh = inputs.inside_workspace = true;
  return inputs;
}

TEST(Interlock, EveryDoubtForbidsTheBeamAndSaysWhy) {
  const InterlockSettings settings;
  EXPECT_EQ(evaluate_interlock(good(), settings), Interlock::kReady);
  auto inputs = good();
  inputs.contour_known = false;
  EXPECT_EQ(evaluate_interlock(inputs, settings), Interlock::kNoContour);
  inputs = good();
  inputs.engaged = false;
  EXPECT_EQ(evaluate_interlock(inputs, settings), Interlock::kNotEngaged);
  inputs = good();
  inputs.fresh = false;
  EXPECT_EQ(evaluate_interlock(inputs, settings), Interlock::kStale);
  inputs = good();
  inputs.inside_workspace = false;
  EXPECT_EQ(evaluate_interlock(inputs, settings), Interlock::kOutsideWorkspace);
  inputs = good();
  inputs.contour_distance_m = 0.49e-3;
  EXPECT_EQ(evaluate_interlock(inputs, settings), Interlock::kOutsideCorridor)
      << "the sensors' allowance counts";
  inputs = good();
  inputs.tracking_error_m = 1e-3;
  EXPECT_EQ(evaluate_interlock(inputs, settings), Interlock::kTracking);
  inputs.stopped = true;
  EXPECT_EQ(evaluate_interlock(inputs, settings), Interlock::kStopped);
}

TEST(Interlock, AFastToolIsStoppedEarlier) {
  auto inputs = good();
  inputs.contour_distance_m = 0.4e-3;
  EXPECT_EQ(evaluate_interlock(inputs, {}), Interlock::kReady);
  inputs.speed_m_per_s = 0.05;
  EXPECT_EQ(evaluate_interlock(inputs, {}), Interlock::kOutsideCorridor);
}

TEST(Interlock, NotANumberForbids) {
  auto inputs = good();
  inputs.contour_distance_m = std::nan("");
  EXPECT_EQ(evaluate_interlock(inputs, {}), Interlock::kOutsideCorridor);
  inputs = good();
  inputs.tracking_error_m = std::nan("");
  EXPECT_EQ(evaluate_interlock(inputs, {}), Interlock::kTracking);
}

}  // namespace
}  // namespace telekerf::laser
