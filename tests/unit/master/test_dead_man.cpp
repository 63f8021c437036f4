// SPDX-License-Identifier: Apache-2.0
// The button of a hand that is not felt any more.
#include <gtest/gtest.h>

#include <limits>

#include "master/dead_man.h"

namespace telekerf::master {
namespace {

constexpr double kDt_s = 1e-3;

/// Steps in which a pressed button counts while the hand pushes so hard.
int counted(DeadMan& dead_man, int steps, double force_n) {
  int n = 0;
  for (int i = 0; i < steps; ++i) n += dead_man.step(true, force_n) ? 1 : 0;
  return n;
}

TEST(DeadMan, ABoundHandHoldsTheButtonAndOneThatIsGoneDoesNot) {
  DeadMan dead_man(kDt_s);
  EXPECT_EQ(counted(dead_man, 1000, 0.21), 1000);
  EXPECT_EQ(counted(dead_man, 1000, 0.2), 300) << "0.3 s more";
  EXPECT_EQ(counted(dead_man, 1000, 3.0), 0) << "the button was held all the time";
  EXPECT_FALSE(dead_man.step(false, 3.0));
  EXPECT_TRUE(dead_man.step(true, 3.0)) << "pressed anew by a hand that is there";
}

TEST(DeadMan, AHandThatTurnsRoundIsNoHandThatIsGone) {
  DeadMan dead_man(kDt_s);
  for (int n = 0; n < 10; ++n) {
    EXPECT_EQ(counted(dead_man, 100, 1.0), 100);
    EXPECT_EQ(counted(dead_man, 299, 0.0), 299);
  }
}

TEST(DeadMan, WhatIsNoNumberIsNoHand) {
  DeadMan dead_man(kDt_s);
  EXPECT_EQ(counted(dead_man, 1000, 1.0), 1000);
  EXPECT_EQ(counted(dead_man, 1000, std::numeric_limits<double>::quiet_NaN()), 300);
}

}  // namespace
}  // namespace telekerf::master
