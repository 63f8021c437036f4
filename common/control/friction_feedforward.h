// SPDX-License-Identifier: Apache-2.0
// Where a joint turns round, its friction changes sign within milliseconds, and the disturbance observer is
// late by its own filter: the tool is thrown off the curve by a tenth of a millimetre. The modelled friction
// is therefore given ahead, less what the observer has already seen of it.
#pragma once

#include <array>
#include <cstddef>

#include "common/control/disturbance_observer.h"
#include "common/robot/robot_model.h"

namespace telekerf::control {

class FrictionFeedforward {
 public:
  /// `gains` of the observer beside which it works: H(s) is rebuilt from them.
  FrictionFeedforward(const robot::Friction& nominal, const DisturbanceObserver::Gains& gains) noexcept;

  /// One control step at this estimated joint velocity.
  void update(const Vec3& joint_velocity_m_per_s) noexcept;
  /// Friction that the observer has not seen yet, N; to be put back beside its estimate.
  const Vec3& missing_n() const noexcept { return missing_n_; }
  /// The modelled friction as the observer sees it, N; to be taken out of its estimate.
  const Vec3& seen_n() const noexcept { return stages_[2]; }

 private:
  robot::Friction ahead_;
  robot::Friction nominal_;
  double rate_[3];
  std::size_t late_;  ///< samples, of what the observer sees beside its own filter
  std::array<Vec3, kMaxLoopDelay + 1> friction_n_;  ///< newest first
  std::array<Vec3, kMaxLoopDelay + 1> given_n_;
  Vec3 stages_[3];
  Vec3 given_stages_[3];
  Vec3 missing_n_ = Vec3::Zero();
};

}  // namespace telekerf::control
