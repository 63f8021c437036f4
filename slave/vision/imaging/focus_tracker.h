// SPDX-License-Identifier: Apache-2.0
// Keeps a focus that was found: the self-optimising law (eq. 157-158) on the gradient of the sharpness'
// logarithm, over a window about the place where the focus stands. Two pictures, half a window below and half
// a window above, are the excitation that the printed law lacks; in between it rests.
#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>

#include "slave/vision/imaging/focus_search.h"

namespace telekerf::imaging {

struct FocusTrackerSettings {
  double window_dof = 1.0;  ///< delta of eq. 157, centred; half of it to either side is the dither
  double mu_0_dof = 0.5;    ///< largest step after a pair of pictures
  /// Share of the way to the peak that a step goes: alpha of eq. 158 is chosen for it from the peak's width.
  double convergence = 0.6;
  int rest_pictures = 20;  ///< between two pairs where the last step was small; doubles
  int longest_rest_pictures = 160;  ///< up to this while all steps stay small
  double small_dof = 0.1;
  double fall = 0.1;   ///< of the sharpness at rest that ends the rest, as a share
  double lost = 0.25;  ///< share of the sharpness at the lock below which the focus is lost
};

class FocusTracker {
 public:
  /// From a lock. `lowest_m`, `highest_m` in `range` bound where it goes.
  FocusTracker(const FocusTrackerSettings& settings, const FocusRange& range, const FocusResult& lock,
               const Background& background);

  /// Where the next picture is to be taken, to be approached from below.
  double next_m() const noexcept;
  void seen(const cv::Mat& region, double position_m);

  double centre_m() const noexcept { return centre_m_; }
  /// The newest picture was taken at rest in the focus, none half a window off it.
  bool resting() const noexcept { return resting_; }
  /// The sharpness is gone: to be searched for anew.
  bool lost() const noexcept { return lost_; }
  /// Of the newest picture.
  const Sharpness& sharpness() const noexcept { return newest_; }
  int pictures() const noexcept { return pictures_; }

 private:
  enum class Stage : std::uint8_t { kRest, kBelow, kAbove };
  void rest();
  void step(double above_log, double apart_m);

  FocusTrackerSettings settings_;
  FocusRange range_;
  Background background_;
  double alpha_;
  double lock_tenengrad_;
  double centre_m_;
  Stage stage_ = Stage::kRest;
  bool resting_ = true;
  int rest_pictures_;  ///< of this rest
  int rested_ = 0;
  double rest_tenengrad_;  ///< at the beginning of this rest, or of the one before; after a fall, then
  double below_log_ = 0.0;
  double below_m_ = 0.0;
  Sharpness newest_;
  bool lost_ = false;
  int pictures_ = 0;
};

}  // namespace telekerf::imaging
