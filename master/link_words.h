// SPDX-License-Identifier: Apache-2.0
// What the link does to the work, in words at the operator's side: before the work, and while it lasts.
#pragma once

#include <atomic>
#include <chrono>
#include <string>

#include "common/protocol/blocks.h"

namespace telekerf::master {

/// Why the link keeps the laser off, and what may be done; empty: it does not. `age_s`: of the commands,
/// there and back, as the slave judges it; negative: it cannot.
std::string link_sentence(double age_s);

/// Hands the state of the link from the control loop to the thread that says it.
class LinkWords {
 public:
  /// Every step, wait-free. Null: no slave is heard.
  void step(const StateHeader* slave) noexcept {
    const bool late = slave != nullptr && slave->command_age_s >= 0.0 && (slave->guards & kAgeGuard) != 0;
    late_s_.store(late ? slave->command_age_s : -1.0, std::memory_order_relaxed);
  }
  /// Now and then: the sentence that is due, at once and then every few seconds while it lasts; empty: none
  /// is.
  std::string due(std::chrono::steady_clock::time_point now);

 private:
  std::atomic<double> late_s_{-1.0};  ///< negative: the link is good enough
  bool said_ = false;
  std::chrono::steady_clock::time_point since_, next_;
};

}  // namespace telekerf::master
