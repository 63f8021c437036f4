// SPDX-License-Identifier: Apache-2.0
// No jump, ever: whatever source the reference comes from, a change of source becomes an offset that fades
// out.
#pragma once

#include "common/control/kinematic_state.h"

namespace telekerf::control {

struct BumplessTransferSettings {
  double rate_rad_per_s = 100.0;           ///< of the critically damped fade
  double max_acceleration_m_per_s2 = 1.0;  ///< what is far or fast fades more slowly
};

/// Adds to the source an offset o with o'' + 2 w o' + w^2 o = 0, seated at each change of source so that
/// position and velocity of the output go on unbroken.
class BumplessTransfer {
 public:
  explicit BumplessTransfer(const BumplessTransferSettings& settings) noexcept : settings_(settings) {}

  /// The output goes on from `from` (position and velocity) although the source now says `source`; both
  /// belong to the same instant.
  void start(const KinematicState& from, const KinematicState& source) noexcept;
  /// One step of `dt_s` (0: the instant of a start): the source's motion plus what is left of the offset.
  KinematicState apply(const KinematicState& source, double dt_s) noexcept;
  /// How far a motion of this speed still goes when it is transferred to a source at rest where it is.
  double way_to_rest_m(double speed_m_per_s) const noexcept;
  /// What is left of the offset.
  double offset_m() const noexcept { return offset_.norm(); }

 private:
  double rate_for(double size_m, double speed_m_per_s) const noexcept;

  BumplessTransferSettings settings_;
  double rate_ = 0.0;
  Eigen::Vector3d offset_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d offset_rate_ = Eigen::Vector3d::Zero();
};

}  // namespace telekerf::control
