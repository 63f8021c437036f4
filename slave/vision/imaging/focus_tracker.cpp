// SPDX-License-Identifier: Apache-2.0
#include "slave/vision/imaging/focus_tracker.h"

#include <algorithm>
#include <cmath>

#include "slave/vision/imaging/focus_law.h"

namespace telekerf::imaging {
namespace {

double log_of(const Sharpness& sharpness) {
  return std::log(std::max(sharpness.tenengrad, sharpness.tenengrad_deviation + 1e-12));
}

}  // namespace

FocusTracker::FocusTracker(const FocusTrackerSettings& settings, const FocusRange& range,
                           const FocusResult& lock, const Background& background)
    : settings_(settings),
      range_(range),
      background_(background),
      // The gradient of the logarithm at z depths of field off a peak of width w is -z / w^2, and the law's
      // slope mu_0 alpha / 2.
      alpha_(2.0 * settings.convergence * lock.width_dof * lock.width_dof / settings.mu_0_dof),
      lock_tenengrad_(lock.tenengrad),
      centre_m_(lock.position_m),
      rest_pictures_(settings.rest_pictures),
      rest_tenengrad_(lock.tenengrad) {}

double FocusTracker::next_m() const noexcept {
  const double half_m = 0.5 * settings_.window_dof * range_.depth_of_field_m;
  switch (stage_) {
    case Stage::kBelow:
      return std::max(range_.lowest_m, centre_m_ - half_m);
    case Stage::kAbove:
      return std::min(range_.highest_m, centre_m_ + half_m);
    case Stage::kRest:
      break;
  }
  return centre_m_;
}

void FocusTracker::step(double above_log, double apart_m) {
  const double apart_dof = apart_m / range_.depth_of_field_m;
  const double gradient = apart_dof > 0.0 ? (above_log - below_log_) / apart_dof : 0.0;
  const double step_dof = optimizing_velocity(gradient, settings_.mu_0_dof, alpha_);
  centre_m_ = std::clamp(centre_m_ + step_dof * range_.depth_of_field_m, range_.lowest_m, range_.highest_m);
  const bool arrived = std::abs(step_dof) < settings_.small_dof;
  stage_ = arrived ? Stage::kRest : Stage::kBelow;
  rest_pictures_ = arrived ? std::min(2 * rest_pictures_, settings_.longest_rest_pictures)
                           : settings_.rest_pictures;
  rested_ = 0;
}

void FocusTracker::rest() {
  lost_ = newest_.tenengrad < settings_.lost * lock_tenengrad_;
  const bool fell = newest_.tenengrad < (1.0 - settings_.fall) * rest_tenengrad_;
  // Where that is no focus that has gone, but light or texture, it is how sharp it is from now on.
  if (fell || rested_ == 0) rest_tenengrad_ = newest_.tenengrad;
  if (fell || ++rested_ >= rest_pictures_) stage_ = Stage::kBelow;
}

void FocusTracker::seen(const cv::Mat& region, double position_m) {
  ++pictures_;
  newest_ = sharpness_of(region, background_);
  resting_ = stage_ == Stage::kRest;
  switch (stage_) {
    case Stage::kRest:
      rest();
      break;
    case Stage::kBelow:
      below_log_ = log_of(newest_);
      below_m_ = position_m;
      stage_ = Stage::kAbove;
      break;
    case Stage::kAbove:
      step(log_of(newest_), position_m - below_m_);
      break;
  }
}

}  // namespace telekerf::imaging
