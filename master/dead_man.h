// SPDX-License-Identifier: Apache-2.0
// A button counts only while a hand is felt: who faints, lets go or leaves a weight on the button has no
// beam.
#pragma once

#include <cmath>

namespace telekerf::master {

class DeadMan {
 public:
  static constexpr double kFelt_n = 0.2;
  static constexpr double kPatience_s = 0.3;

  explicit DeadMan(double dt_s) noexcept : patience_(std::lround(kPatience_s / dt_s)) {}

  /// Every control step. `force_n`: magnitude of the hand's estimated force in the plane of the work. False
  /// for good, until the button is released, once nothing was felt for longer than kPatience_s.
  bool step(bool button, double force_n) noexcept {
    gone_ = force_n > kFelt_n ? 0 : gone_ + 1;  // a NaN is no hand
    lost_ = button && (lost_ || gone_ > patience_);
    return button && !lost_;
  }

 private:
  long patience_;  ///< steps
  long gone_ = 0;  ///< since a hand was felt
  bool lost_ = false;
};

}  // namespace telekerf::master
