// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "slave/vision/imaging/ridge.h"

namespace telekerf::imaging {
namespace {

double truth_m(double magnification_m) {
  const double s = magnification_m / 0.08;
  return 0.0145 + 0.004 * s - 0.0025 * s * s;
}

TEST(Ridge, BeginsAtTheModelAndKnowsNothing) {
  const ImagingModel model;
  const RidgeEstimate ridge(model);
  EXPECT_DOUBLE_EQ(ridge.at(0.04).focus_m, model.best_focus_m(0.04));
  EXPECT_GT(ridge.at(0.04).deviation_m, 5e-3);
  EXPECT_EQ(ridge.locks(), 0);
}

TEST(Ridge, IsKnownWhereLocksAreAndLessAway) {
  RidgeEstimate ridge{ImagingModel()};
  ridge.learn({0.01, truth_m(0.01)});
  EXPECT_EQ(ridge.locks(), 1);
  EXPECT_NEAR(ridge.at(0.01).focus_m, truth_m(0.01), 1e-5);
  EXPECT_LT(ridge.at(0.01).deviation_m, 0.25e-3);
  EXPECT_GT(ridge.at(0.07).deviation_m, 1e-3);
}

TEST(Ridge, IsLearntFromAFewLocks) {
  RidgeEstimate ridge{ImagingModel()};
  for (const double m : {0.005, 0.02, 0.04, 0.06, 0.075}) ridge.learn({m, truth_m(m)});
  for (double m = 0.0; m <= 0.08; m += 0.01) {
    EXPECT_NEAR(ridge.at(m).focus_m, truth_m(m), 0.1e-3) << m;
    EXPECT_LT(ridge.at(m).deviation_m, 0.3e-3) << m;
  }
  ImagingModel model;
  ridge.write_to(model);
  EXPECT_DOUBLE_EQ(model.best_focus_m(0.033), ridge.at(0.033).focus_m);
}

TEST(Ridge, FollowsALastingChange) {
  RidgeEstimate ridge{ImagingModel()};
  for (int i = 0; i < 4; ++i) ridge.learn({0.02 * i, truth_m(0.02 * i)});
  const double before = ridge.at(0.03).focus_m;
  for (int i = 0; i < 4; ++i) ridge.learn({0.02 * i, truth_m(0.02 * i) + 1e-3});
  EXPECT_NEAR(ridge.at(0.03).focus_m - before, 0.5e-3, 0.1e-3);  // as many locks there as here
}

}  // namespace
}  // namespace telekerf::imaging
