// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "slave/vision/imaging/focus_law.h"

namespace telekerf::imaging {
namespace {

TEST(FocusLaw, IsEquation158ForTheNegativeSharpness) {
  for (const double gradient : {-3.0, -0.4, 0.0, 0.2, 5.0}) {
    const double g_f = -gradient;
    EXPECT_NEAR(optimizing_velocity(gradient, 0.7, 2.0), 0.7 * (1.0 - 2.0 / (1.0 + std::exp(-2.0 * g_f))),
                1e-12)
        << gradient;
  }
  EXPECT_GT(optimizing_velocity(1.0, 1.0, 1.0), 0.0);  // towards larger sharpness
}

TEST(PrintedLaw, HasNoVelocityWhereNothingMoves) {
  PrintedFocusLaw law({.mu_0_m_per_s = 1.0, .alpha = 1.0, .window_m = 0.1});
  for (int i = 0; i < 10; ++i) EXPECT_EQ(law.step(0.3, 1.0 + 0.1 * i), 0.0);
  EXPECT_EQ(law.step(0.39, 5.0), 0.0);  // less than a window
  EXPECT_GT(law.step(0.41, 5.0), 0.0);
  PrintedFocusLaw exact({.mu_0_m_per_s = 1.0, .alpha = 1.0, .window_m = 0.25});
  exact.step(0.0, 1.0);
  EXPECT_GT(exact.step(0.25, 2.0), 0.0) << "a window is enough";
}

TEST(PrintedLaw, TakesTheNewestPictureAWindowBehind) {
  PrintedFocusLaw law({.mu_0_m_per_s = 1.0, .alpha = 2.0, .window_m = 0.1});
  law.step(0.0, 1.0);
  law.step(0.2, 2.0);
  EXPECT_NEAR(law.step(0.4, 2.5), std::tanh((2.5 - 2.0) / 0.2), 1e-12);
  EXPECT_NEAR(law.step(0.45, 2.0), std::tanh((2.0 - 2.0) / 0.25), 1e-12);
  EXPECT_NEAR(law.step(0.3, 1.0), std::tanh((1.0 - 2.0) / (0.3 - 0.45)), 1e-12);
}

TEST(PrintedLaw, ClimbsToAPeakAndStaysNear) {
  const auto sharpness = [](double q) { return 5.0 * std::exp(-0.5 * (q - 3.0) * (q - 3.0)); };
  PrintedFocusLaw law({.mu_0_m_per_s = 0.2, .alpha = 1.0, .window_m = 0.1});
  double q = 1.0;
  law.step(q - 0.2, sharpness(q - 0.2));
  for (int i = 0; i < 400; ++i) q += 0.5 * law.step(q, sharpness(q));
  EXPECT_NEAR(q, 3.0, 0.15);
}

TEST(PrintedLaw, ForgetsWhatLiesFarBehind) {
  PrintedFocusLaw law({.mu_0_m_per_s = 1.0, .alpha = 1.0, .window_m = 1.0});
  law.step(0.0, 1.0);
  for (int i = 0; i < 64; ++i) law.step(1.5, 2.0);
  EXPECT_EQ(law.step(1.5, 2.0), 0.0);
}

}  // namespace
}  // namespace telekerf::imaging
