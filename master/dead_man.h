// SPDX-License-Identifier: Apache-2.0
// A button counts only while a hand is felt: who faints, lets go or leaves a weight on the button has no
// beam.
#pragma once

namespace telekerf::master {

class DeadMan {
 public:
  static constexpr double kFelt_n = 0.2;
  static constexpr double kPatience_s = 0.3;

  explicit DeadMan(double dt_s) noexcept : dt_s_(dt_s) {}

  /// Every control step. `force_n`: magnitude of the hand's estimated force in the plane of the work. False
  /// for good, until the button is released, once nothing was felt for longer than kPatience_s.
  bool step(bool button, double force_n) noexcept {
    gone_s_ = force_n > kFelt_n ? 0.0 : gone_s_ + dt_s_;  // a NaN is no hand
    lost_ = button && (lost_ || gone_s_ > kPatience_s);
    return button && !lost_;
  }

 private:
  double dt_s_;
  double gone_s_ = 0.0;  ///< since a hand was felt
  bool lost_ = false;
};

}  // namespace telekerf::master
