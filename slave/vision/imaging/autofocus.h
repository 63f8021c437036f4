// SPDX-License-Identifier: Apache-2.0
// The one who decides about the focus: searches, tracks, follows the magnification along the ridge, and says
// why where there is no focus. Pure: pictures and positions in, the place of the next picture out.
#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <optional>

#include "common/runtime/enum_table.h"
#include "slave/vision/imaging/focus_search.h"
#include "slave/vision/imaging/focus_tracker.h"
#include "slave/vision/imaging/imaging_model.h"
#include "slave/vision/imaging/ridge.h"

namespace telekerf::imaging {

struct AutofocusSettings {
  FocusSearchSettings search;
  FocusTrackerSettings tracker;
  double ridge_known_dof = 1.0;  ///< standard deviation of the ridge up to which a small search is enough
  double same_zoom_m = 0.1e-3;   ///< a magnification axis that has moved less has not been moved
};

class Autofocus {
 public:
  enum class State : std::uint8_t { kSearching, kTracking, kUnfocused };

  /// `lowest_m`, `highest_m`: of the focus axis.
  Autofocus(const AutofocusSettings& settings, const ImagingModel& model, double lowest_m, double highest_m);

  /// What the light varies within the region's tiles (flat_within); without it nothing is known of it.
  void set_flat(const std::array<double, kTiles>& flat) noexcept { background_.flat = flat; }
  /// Where the focus axis is to stand for the next picture, approached from below. While the magnification
  /// moves, and a picture would not count, that is where the ridge expects the focus.
  double goal_m(const AxisPositions& now, bool zooming);
  /// The region of a picture that was taken with both axes at rest at the goal.
  void seen(const cv::Mat& region, const AxisPositions& axes);
  /// Searches anew, whatever there is.
  void refocus() noexcept;

  State state() const noexcept { return state_; }
  /// Of the newest search.
  const FocusResult& result() const noexcept { return result_; }
  /// That it took, with those of a search nearby that found nothing.
  int pictures() const noexcept { return pictures_; }
  /// The picture may be used: it is in focus, and nothing is being tried.
  bool sharp() const noexcept { return state_ == State::kTracking && tracker_->resting(); }
  const Sharpness& sharpness() const noexcept { return sharpness_; }
  const RidgeEstimate& ridge() const noexcept { return ridge_; }
  /// Size of a pixel on the object, with the axes there: the calibrated scale, and what the distance from the
  /// focus makes of it.
  double metres_per_pixel(const AxisPositions& axes) const noexcept;
  int searches() const noexcept { return searches_; }
  int locks() const noexcept { return ridge_.locks(); }

 private:
  FocusRange range_at(const AxisPositions& axes, double start_m) const;
  void begin(const AxisPositions& axes);
  void search_everywhere(const AxisPositions& axes);
  void finish(const AxisPositions& axes);

  AutofocusSettings settings_;
  ImagingModel model_;
  double lowest_m_;
  double highest_m_;
  RidgeEstimate ridge_;
  Background background_;
  State state_ = State::kSearching;
  std::optional<FocusSearch> search_;
  std::optional<FocusTracker> tracker_;
  bool nearby_ = false;
  double zoom_m_ = 0.0;  ///< magnification axis that the search or lock is of
  FocusResult result_;
  std::optional<double> focus_m_;  ///< in focus at zoom_m_
  Sharpness sharpness_;
  int searches_ = 0;
  int pictures_ = 0;
};

inline constexpr EnumRow<Autofocus::State> kAutofocusStateRows[] = {
    {"searching", Autofocus::State::kSearching, "the focus is being searched for"},
    {"tracking", Autofocus::State::kTracking, "in focus, and kept there"},
    {"no focus", Autofocus::State::kUnfocused, "no focus found"},
};
inline constexpr EnumTable<Autofocus::State> kAutofocusStates(kAutofocusStateRows);

}  // namespace telekerf::imaging
