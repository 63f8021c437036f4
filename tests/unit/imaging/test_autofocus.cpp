// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>

#include "experiments/autofocus/virtual_unit.h"
#include "slave/vision/imaging/autofocus.h"
#include "slave/vision/imaging/targets.h"

namespace telekerf::imaging {
namespace {

using experiments::VirtualUnit;
using experiments::VirtualUnitSettings;

Object relief(Target target = Target::kRelief) {
  Object object;
  object.metres_per_texel = 1e-5;
  object.texture = draw_target(target, 768, 1.5, 4);
  return object;
}

class AutofocusTest : public ::testing::Test {
 protected:
  explicit AutofocusTest(Target target = Target::kRelief)
      : unit_({}, relief(target)),
        model_(unit_.microscope().settings().model),
        autofocus_({}, model_, unit_.control().lowest_m(), unit_.control().highest_m(kFocus)) {}

  void zoom(double magnification_m) {
    unit_.control().move_to(kMagnification, magnification_m);
    unit_.settle();
    experiments::focus_now(unit_, autofocus_);
  }
  void look() {
    const double goal_m = autofocus_.goal_m(unit_.measured_m(), false);
    const cv::Mat picture = unit_.look(goal_m);
    autofocus_.seen(picture, unit_.measured_m());
  }
  double scale_error() {
    return autofocus_.metres_per_pixel(unit_.measured_m()) / unit_.metres_per_pixel() - 1.0;
  }

  VirtualUnit unit_;
  ImagingModel model_;
  Autofocus autofocus_;
};

TEST_F(AutofocusTest, FindsTracksAndLearnsTheRidge) {
  EXPECT_EQ(autofocus_.state(), Autofocus::State::kSearching);
  int first = 0;
  for (const double magnification_m : {0.01, 0.03, 0.055, 0.075}) {
    zoom(magnification_m);
    ASSERT_EQ(autofocus_.state(), Autofocus::State::kTracking) << magnification_m;
    EXPECT_TRUE(autofocus_.sharp());
    EXPECT_NEAR(unit_.defocus_dof(), 0.0, 0.1);
    if (first == 0) first = autofocus_.pictures();
  }
  EXPECT_EQ(first, 24);
  EXPECT_EQ(autofocus_.locks(), 4);
  for (const double magnification_m : {0.02, 0.065, 0.004, 0.045}) {
    zoom(magnification_m);
    ASSERT_EQ(autofocus_.state(), Autofocus::State::kTracking) << magnification_m;
    EXPECT_NEAR(unit_.defocus_dof(), 0.0, 0.1);
    EXPECT_LE(autofocus_.pictures(), 8) << magnification_m;
    EXPECT_NEAR(scale_error(), 0.0, 0.001);
  }
  EXPECT_EQ(autofocus_.searches(), 8);
}

TEST_F(AutofocusTest, WhileTheMagnificationMovesTheFocusGoesAlongTheRidge) {
  EXPECT_EQ(autofocus_.goal_m({0.02, 0.013}, true), 0.013);  // nothing is known: it stays
  zoom(0.01);
  zoom(0.06);
  EXPECT_EQ(autofocus_.goal_m({0.035, 0.013}, true), autofocus_.ridge().at(0.035).focus_m);
  EXPECT_NEAR(autofocus_.goal_m({0.035, 0.013}, true), unit_.microscope().best_focus_m(0.035), 1e-3);
}

TEST_F(AutofocusTest, TheScaleFollowsTheFocusToo) {
  zoom(0.03);
  const double in_focus = autofocus_.metres_per_pixel(unit_.measured_m());
  unit_.look(unit_.measured_m().focus_m + 2e-3);
  EXPECT_NEAR(autofocus_.metres_per_pixel(unit_.measured_m()) / in_focus,
              1.0 + 2e-3 * model_.focus_scale_per_m, 5e-5);
  EXPECT_NEAR(scale_error(), 0.0, 2e-4);
}

TEST_F(AutofocusTest, AnObjectThatWasRaisedIsFoundAnew) {
  zoom(0.03);
  ASSERT_EQ(autofocus_.state(), Autofocus::State::kTracking);
  unit_.microscope().object().height_m += 3e-3;
  for (int i = 0; i < 60; ++i) look();
  EXPECT_EQ(autofocus_.state(), Autofocus::State::kTracking);
  EXPECT_NEAR(unit_.defocus_dof(), 0.0, 0.6);
  EXPECT_GE(autofocus_.searches(), 3);  // nearby in vain, then everywhere
}

TEST_F(AutofocusTest, WhatWasInFocusAtAnotherZoomIsForgotten) {
  zoom(0.03);
  unit_.control().move_to(kMagnification, 0.06);
  unit_.settle();
  (void)autofocus_.goal_m(unit_.measured_m(), false);
  ASSERT_EQ(autofocus_.state(), Autofocus::State::kSearching);
  // In focus is now where the ridge expects it.
  EXPECT_NEAR(autofocus_.metres_per_pixel({0.06, autofocus_.ridge().at(0.06).focus_m}),
              model_.metres_per_pixel({0.06, model_.best_focus_m(0.06)}), 1e-12);
}

TEST_F(AutofocusTest, WithoutAFocusNothingIsTracked) {
  zoom(0.03);
  ASSERT_EQ(autofocus_.state(), Autofocus::State::kTracking);
  unit_.microscope().object().height_m += 0.02;  // out of reach
  zoom(0.06);
  ASSERT_EQ(autofocus_.state(), Autofocus::State::kUnfocused);
  const double here_m = unit_.measured_m().focus_m;
  for (int i = 0; i < 30; ++i) {
    look();
    EXPECT_NEAR(unit_.measured_m().focus_m, here_m, 50e-6);  // a dither would be 250
  }
  EXPECT_EQ(autofocus_.locks(), 1);
  // A small motion of the magnification is none, a larger one begins a search, down as well as up.
  const int searches = autofocus_.searches();
  (void)autofocus_.goal_m({0.06 - 0.09e-3, here_m}, false);
  EXPECT_EQ(autofocus_.state(), Autofocus::State::kUnfocused);
  (void)autofocus_.goal_m({0.06 - 0.12e-3, here_m}, false);
  EXPECT_EQ(autofocus_.state(), Autofocus::State::kSearching);
  EXPECT_EQ(autofocus_.searches(), searches + 1);
}

TEST_F(AutofocusTest, TracksADrift) {
  zoom(0.03);
  for (int i = 0; i < 150; ++i) {
    unit_.microscope().object().height_m += 3e-6;
    look();
    EXPECT_TRUE(!autofocus_.sharp() || std::abs(unit_.defocus_dof()) < 0.7) << i;
  }
  EXPECT_EQ(autofocus_.searches(), 1);
}

TEST_F(AutofocusTest, RefocusSearchesAnew) {
  zoom(0.03);
  EXPECT_EQ(autofocus_.searches(), 1);
  autofocus_.refocus();
  EXPECT_EQ(autofocus_.state(), Autofocus::State::kSearching);
  EXPECT_FALSE(autofocus_.sharp());
  experiments::focus_now(unit_, autofocus_);
  EXPECT_EQ(autofocus_.state(), Autofocus::State::kTracking);
  EXPECT_EQ(autofocus_.searches(), 2);
  EXPECT_EQ(autofocus_.pictures(), 7);  // the ridge is known there
}

class BlankAutofocusTest : public AutofocusTest {
 protected:
  BlankAutofocusTest() : AutofocusTest(Target::kBlank) {}
};

TEST_F(BlankAutofocusTest, SaysWhyThereIsNoFocusAndLeavesTheAxis) {
  zoom(0.03);
  EXPECT_EQ(autofocus_.state(), Autofocus::State::kUnfocused);
  EXPECT_EQ(autofocus_.result().verdict, FocusVerdict::kBlank);
  EXPECT_FALSE(autofocus_.sharp());
  EXPECT_EQ(autofocus_.locks(), 0);
  const double here_m = unit_.measured_m().focus_m;
  for (int i = 0; i < 3; ++i) look();
  EXPECT_EQ(autofocus_.goal_m({0.03, here_m}, false), here_m);
  EXPECT_EQ(autofocus_.searches(), 1);
  EXPECT_NEAR(autofocus_.sharpness().mean, 150.0, 20.0);
}

}  // namespace
}  // namespace telekerf::imaging
