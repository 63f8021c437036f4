// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <opencv2/imgproc.hpp>

#include "slave/vision/imaging/focus_tracker.h"
#include "slave/vision/imaging/targets.h"

namespace telekerf::imaging {
namespace {

constexpr double kDof_m = 0.5e-3;

/// A texture whose focus wanders; the tracker's next picture is taken exactly where it asks for it.
class Tracking : public ::testing::Test {
 protected:
  cv::Mat at(double position_m) {
    const double z = (position_m - focus_m_) / kDof_m;
    cv::Mat out;
    cv::GaussianBlur(texture_, out, {}, std::hypot(0.6, 0.9 * z));
    cv::Mat noise(out.size(), CV_32F);
    random_.fill(noise, cv::RNG::NORMAL, 0.0, 2.0);
    out += noise;
    out.convertTo(out, CV_8U);
    return out;
  }
  FocusTracker locked(const FocusTrackerSettings& settings = {}, double off_dof = 0.0) {
    Background background;
    background.noise_variance = 4.0;
    const Sharpness sharpness = sharpness_of(at(focus_m_), background);
    FocusResult lock;
    lock.verdict = FocusVerdict::kFound;
    lock.position_m = focus_m_ + off_dof * kDof_m;
    lock.width_dof = 1.2;
    lock.tenengrad = sharpness.tenengrad;
    return {settings,
            {.start_m = 0.015, .lowest_m = 0.01, .highest_m = 0.02, .depth_of_field_m = kDof_m},
            lock,
            background};
  }
  void look(FocusTracker& tracker) {
    const double next_m = tracker.next_m();
    tracker.seen(at(next_m), next_m);
  }
  double off_dof(const FocusTracker& tracker) const { return (tracker.centre_m() - focus_m_) / kDof_m; }

  double focus_m_ = 0.015;

 private:
  cv::Mat texture_ = draw_target(Target::kRelief, 128, 1.0, 3);
  cv::RNG random_{9};
};

TEST_F(Tracking, RestsAndTriesNowAndThen) {
  FocusTracker tracker = locked();
  for (int i = 0; i < 20; ++i) {
    EXPECT_TRUE(tracker.resting());
    EXPECT_EQ(tracker.next_m(), focus_m_);
    look(tracker);
  }
  // Half a window below, then half a window above; neither picture is one in focus.
  EXPECT_TRUE(tracker.resting());
  EXPECT_NEAR(tracker.next_m(), focus_m_ - 0.5 * kDof_m, 1e-12);
  look(tracker);
  EXPECT_FALSE(tracker.resting());
  EXPECT_NEAR(tracker.next_m(), focus_m_ + 0.5 * kDof_m, 1e-12);
  look(tracker);
  EXPECT_FALSE(tracker.resting());
  EXPECT_EQ(tracker.next_m(), tracker.centre_m());
  EXPECT_NEAR(off_dof(tracker), 0.0, 0.1);
  EXPECT_EQ(tracker.pictures(), 22);
  EXPECT_GT(tracker.sharpness().tenengrad, 0.0);
}

/// How many pictures are taken at rest until the next pair begins.
int rest_of(FocusTracker& tracker, const std::function<void()>& look) {
  int pictures = 0;
  while (tracker.next_m() == tracker.centre_m()) {
    look();
    ++pictures;
  }
  return pictures;
}

TEST_F(Tracking, RestsLongerTheLongerNothingHasChanged) {
  FocusTracker tracker = locked();
  const auto next = [&] { look(tracker); };
  for (const int pictures : {20, 40, 80, 160, 160}) {
    EXPECT_EQ(rest_of(tracker, next), pictures);
    look(tracker);
    look(tracker);
  }
  focus_m_ += 0.8 * kDof_m;
  EXPECT_EQ(rest_of(tracker, next), 1) << "less sharp than at the rest before";
}

TEST_F(Tracking, GoesBackToThePeakFromBothSides) {
  for (const double off : {-1.5, -0.6, 0.4, 1.5}) {
    FocusTracker tracker = locked({}, off);
    for (int i = 0; i < 40; ++i) look(tracker);
    EXPECT_NEAR(off_dof(tracker), 0.0, 0.12) << off;
    EXPECT_FALSE(tracker.lost());
  }
}

TEST_F(Tracking, FollowsAFocusThatCreeps) {
  FocusTracker tracker = locked();
  for (int i = 0; i < 400; ++i) {
    focus_m_ += 0.01 * kDof_m;
    look(tracker);
    EXPECT_LT(std::abs(off_dof(tracker)), 0.6) << i;
  }
  EXPECT_FALSE(tracker.lost());
}

TEST_F(Tracking, EndsItsRestWhereTheSharpnessFalls) {
  FocusTracker tracker = locked();
  look(tracker);
  look(tracker);
  focus_m_ += 0.8 * kDof_m;
  look(tracker);
  EXPECT_LT(tracker.next_m(), tracker.centre_m());
  look(tracker);
  look(tracker);  // a step that is not small
  ASSERT_LT(tracker.next_m(), tracker.centre_m());
  while (tracker.next_m() != tracker.centre_m()) look(tracker);
  EXPECT_EQ(rest_of(tracker, [&] { look(tracker); }), 40);
}

TEST_F(Tracking, SaysWhenTheFocusIsLost) {
  FocusTracker tracker = locked();
  look(tracker);
  EXPECT_FALSE(tracker.lost());
  focus_m_ += 5.0 * kDof_m;
  look(tracker);
  EXPECT_TRUE(tracker.lost());
}

TEST_F(Tracking, NeverLeavesTheAxis) {
  FocusTracker tracker = locked();
  for (int i = 0; i < 600; ++i) {
    focus_m_ += 0.03 * kDof_m;  // on and on
    EXPECT_LE(tracker.next_m(), 0.02);
    look(tracker);
  }
  EXPECT_LE(tracker.centre_m(), 0.02);
}

TEST_F(Tracking, AStepIsTheLawsOnTheGradientOfTheLogarithm) {
  for (const double off : {-0.7, 0.5}) {
    FocusTrackerSettings settings;
    settings.rest_pictures = 1;
    FocusTracker tracker = locked(settings, off);
    look(tracker);
    const double centre_m = tracker.centre_m();
    std::array<double, 2> logs{};
    for (double& log : logs) {
      look(tracker);
      log = std::log(tracker.sharpness().tenengrad);
    }
    // Eq. 157 over a window of one depth of field; eq. 158 with an alpha that goes 0.6 of the way where the
    // peak is a Gaussian of this width.
    const double gradient = logs[1] - logs[0];
    const double alpha = 2.0 * 0.6 * 1.2 * 1.2 / 0.5;
    EXPECT_NEAR((tracker.centre_m() - centre_m) / kDof_m, 0.5 * std::tanh(0.5 * alpha * gradient), 1e-9)
        << off;
    EXPECT_LT(std::abs(off_dof(tracker)), std::abs(off));
  }
}

TEST_F(Tracking, APictureWithoutSharpnessHasALogarithm) {
  FocusTrackerSettings settings;
  settings.rest_pictures = 1;
  FocusTracker tracker = locked(settings);
  const cv::Mat grey(128, 128, CV_8U, cv::Scalar(120));
  for (int i = 0; i < 3; ++i) tracker.seen(grey, tracker.next_m());
  EXPECT_EQ(tracker.centre_m(), focus_m_);  // twice the same: no gradient
}

TEST_F(Tracking, RestsAgainAfterASmallStepOnly) {
  FocusTrackerSettings settings;
  settings.rest_pictures = 1;
  FocusTracker far = locked(settings, 1.5);
  for (int i = 0; i < 3; ++i) look(far);
  EXPECT_LT(far.next_m(), far.centre_m());  // another pair at once
  FocusTracker near = locked(settings);
  for (int i = 0; i < 3; ++i) look(near);
  EXPECT_EQ(near.next_m(), near.centre_m());
}

TEST_F(Tracking, AStepIsBounded) {
  FocusTrackerSettings settings;
  settings.mu_0_dof = 0.2;
  FocusTracker tracker = locked(settings, 1.5);
  double before = tracker.centre_m();
  for (int i = 0; i < 30; ++i) {
    look(tracker);
    EXPECT_LE(std::abs(tracker.centre_m() - before), 0.2 * kDof_m + 1e-12);
    before = tracker.centre_m();
  }
}

}  // namespace
}  // namespace telekerf::imaging
