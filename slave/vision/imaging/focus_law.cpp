// SPDX-License-Identifier: Apache-2.0
#include "slave/vision/imaging/focus_law.h"

#include <algorithm>

namespace telekerf::imaging {
namespace {

constexpr std::size_t kRemembered = 64;  ///< pictures

}  // namespace

double PrintedFocusLaw::step(double position_m, double sharpness) {
  const auto behind = std::find_if(samples_.rbegin(), samples_.rend(), [&](const Sample& sample) {
    return std::abs(position_m - sample.position_m) >= settings_.window_m;
  });
  double velocity = 0.0;
  if (behind != samples_.rend()) {
    const double gradient = (sharpness - behind->sharpness) / (position_m - behind->position_m);
    velocity = optimizing_velocity(gradient, settings_.mu_0_m_per_s, settings_.alpha);
  }
  if (samples_.size() == kRemembered) samples_.erase(samples_.begin());
  samples_.push_back({position_m, sharpness});
  return velocity;
}

}  // namespace telekerf::imaging
