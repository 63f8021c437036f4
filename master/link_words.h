// SPDX-License-Identifier: Apache-2.0
// What the link does to the work, in words at the operator's side: before the work, and while it lasts.
#pragma once

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <string>

#include "common/protocol/blocks.h"

namespace telekerf::master {

/// Why the link keeps the laser off, and what may be done; empty: it does not. `age_s`: of the commands,
/// there and back, as the slave judges it; negative: it cannot.
std::string link_sentence(double age_s);

/// Hands the state of the link from the control loop to the thread that says it.
class LinkWords {
 public:
  /// Every step, wait-free. `silent_s`: since the newest state; null: no slave is heard. After either process or
  /// the link has stood still, commands are old for a while, and no other setting would help.
  void step(std::int64_t now_ns, double silent_s, const StateHeader* slave) noexcept {
    const double stood_s =
        std::max(silent_s, stepped_ns_ == 0 ? 0.0 : static_cast<double>(now_ns - stepped_ns_) * 1e-9);
    stepped_ns_ = now_ns;
    if (stood_s > kStandstill_s)
      recovered_ns_ = std::max(recovered_ns_, now_ns + static_cast<std::int64_t>(kRecovery * stood_s * 1e9));
    const bool late = slave != nullptr && now_ns >= recovered_ns_ && slave->command_age_s >= 0.0 &&
                      (slave->guards & kAgeGuard) != 0;
    late_s_.store(late ? slave->command_age_s : -1.0, std::memory_order_relaxed);
  }
  /// Now and then: the sentence that is due, at once and then every few seconds while it lasts; empty: none
  /// is.
  std::string due(std::chrono::steady_clock::time_point now);

 private:
  static constexpr double kStandstill_s = 0.2;
  static constexpr double kRecovery = 3.0;  ///< of the time that it stood: the play-out takes twice as long

  std::int64_t stepped_ns_ = 0, recovered_ns_ = 0;  ///< the control loop's
  std::atomic<double> late_s_{-1.0};  ///< negative: the link is good enough
  bool said_ = false;
  std::chrono::steady_clock::time_point since_, next_;
};

}  // namespace telekerf::master
