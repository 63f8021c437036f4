// SPDX-License-Identifier: Apache-2.0
// Do the control steps come when they should? After one that came later than a laser waits the beam is off
// for a while, as nobody knows what else the machine is late with.
#pragma once

#include <algorithm>
#include <cstdint>

namespace telekerf::laser {

class Punctuality {
 public:
  explicit Punctuality(std::int64_t period_ns) noexcept
      : late_ns_(std::max(kPatience_ns, kLatePeriods * period_ns)) {}

  /// Every control step. False: it came late, or one did a short while ago.
  bool step(std::int64_t now_ns) noexcept {
    if (steps_++ > 0 && now_ns - last_ns_ > late_ns_) {
      on_time_from_ns_ = now_ns + kDarkAfterLate_ns;
      ++late_steps_;
    }
    last_ns_ = now_ns;
    return now_ns >= on_time_from_ns_;
  }
  std::uint64_t late_steps() const noexcept { return late_steps_; }

 private:
  static constexpr std::int64_t kPatience_ns = 3'000'000;  ///< of a laser, see udp_silence_ns()
  static constexpr std::int64_t kLatePeriods = 3;
  static constexpr std::int64_t kDarkAfterLate_ns = 20'000'000;
  std::int64_t late_ns_;
  std::uint64_t steps_ = 0;
  std::int64_t last_ns_ = 0;
  std::int64_t on_time_from_ns_ = 0;
  std::uint64_t late_steps_ = 0;
};

}  // namespace telekerf::laser
