// SPDX-License-Identifier: Apache-2.0
#include "slave/vision/imaging/autofocus.h"

#include <algorithm>
#include <cmath>

namespace telekerf::imaging {

Autofocus::Autofocus(const AutofocusSettings& settings, const ImagingModel& model, double lowest_m,
                     double highest_m)
    : settings_(settings), model_(model), lowest_m_(lowest_m), highest_m_(highest_m), ridge_(model) {}

FocusRange Autofocus::range_at(const AxisPositions& axes, double start_m) const {
  const double magnification = model_.magnification(axes.magnification_m);
  return {.start_m = std::clamp(start_m, lowest_m_, highest_m_),
          .lowest_m = lowest_m_,
          .highest_m = highest_m_,
          .depth_of_field_m = model_.optics.depth_of_field_m(magnification),
          .peak_width_dof = peak_width_dof(model_.optics, magnification)};
}

double Autofocus::goal_m(const AxisPositions& now, bool zooming) {
  if (zooming) {
    const bool known = ridge_.locks() > 0;
    return known ? std::clamp(ridge_.at(now.magnification_m).focus_m, lowest_m_, highest_m_) : now.focus_m;
  }
  const bool zoomed = std::abs(now.magnification_m - zoom_m_) > settings_.same_zoom_m;
  if (zoomed || (state_ == State::kSearching && !search_)) begin(now);
  if (search_) return search_->next_m().value_or(now.focus_m);
  return tracker_ ? tracker_->next_m() : now.focus_m;
}

void Autofocus::search_everywhere(const AxisPositions& axes) {
  nearby_ = false;
  ++searches_;
  search_ = FocusSearch::everywhere(settings_.search, range_at(axes, ridge_.at(axes.magnification_m).focus_m),
                                    background_);
}

void Autofocus::begin(const AxisPositions& axes) {
  zoom_m_ = axes.magnification_m;
  state_ = State::kSearching;
  tracker_.reset();
  focus_m_.reset();
  pictures_ = 0;
  const auto expected = ridge_.at(axes.magnification_m);
  const double dof_m = model_.depth_of_field_m(axes.magnification_m);
  if (background_.noise_variance > 0.0 && expected.deviation_m < settings_.ridge_known_dof * dof_m) {
    nearby_ = true;
    ++searches_;
    search_ = FocusSearch::nearby(settings_.search, range_at(axes, expected.focus_m), background_);
  } else {
    search_everywhere(axes);
  }
}

void Autofocus::finish(const AxisPositions& axes) {
  result_ = search_->result();
  if (nearby_ && !result_.found() && result_.verdict != FocusVerdict::kMoving) {
    search_everywhere(axes);  // the ridge was wrong
    return;
  }
  background_.noise_variance = result_.noise_variance;
  search_.reset();
  if (!result_.found()) {
    state_ = State::kUnfocused;
    return;
  }
  state_ = State::kTracking;
  focus_m_ = result_.position_m;
  ridge_.learn({axes.magnification_m, result_.position_m});
  tracker_.emplace(settings_.tracker, range_at(axes, result_.position_m), result_, background_);
}

void Autofocus::seen(const cv::Mat& region, const AxisPositions& axes) {
  if (search_) {
    sharpness_ = sharpness_of(region, background_);
    ++pictures_;
    search_->seen(region, axes.focus_m);
    if (!search_->next_m()) finish(axes);
  } else if (tracker_) {
    tracker_->seen(region, axes.focus_m);
    sharpness_ = tracker_->sharpness();
    focus_m_ = tracker_->centre_m();
    if (tracker_->lost()) refocus();
  } else {
    sharpness_ = sharpness_of(region, background_);
  }
}

void Autofocus::refocus() noexcept {
  state_ = State::kSearching;
  search_.reset();
  tracker_.reset();
}

double Autofocus::metres_per_pixel(const AxisPositions& axes) const noexcept {
  // In focus the scale is the magnification's; what counts is how far from there the focus stands.
  const double in_focus_m = focus_m_.value_or(ridge_.at(axes.magnification_m).focus_m);
  const double off_m = axes.focus_m - in_focus_m;
  return model_.metres_per_pixel({axes.magnification_m, model_.best_focus_m(axes.magnification_m) + off_m});
}

}  // namespace telekerf::imaging
