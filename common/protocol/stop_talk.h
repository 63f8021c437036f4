// SPDX-License-Identifier: Apache-2.0
// Who says an emergency stop when: who stopped says it until it is obeyed, and a station answers.
#pragma once

#include <chrono>
#include <cstdint>
#include <vector>

#include "common/protocol/stop_latch.h"

namespace telekerf {

/// Until every station has answered it is said again after this. Where a fifth of all messages is lost,
/// either way, the answer is there within 60 ms of a round trip but for one time in a million.
inline constexpr std::chrono::milliseconds kStopAgain{5};

/// Of a new stop: drawn by who says it.
std::uint32_t any_stop_number();

/// What a station has to say: that its control loop obeys a stop, and that one is over for it. Once, and
/// again for each who still asks. Without thread, clock and bus.
class StopReplies {
 public:
  /// `epoch`: of the process that answers.
  explicit StopReplies(std::uint32_t epoch) : epoch_(epoch) {}

  /// Somebody says a stop, or its end, and waits for the answer.
  void asked(const StopMessage& message);
  /// What is to be said now, and counts as said. `obeyed`: the stop that the control loop obeys; 0: none.
  std::vector<StopMessage> take(const StopLatch& latch, std::uint32_t obeyed);

 private:
  StopMessage answer(const StopLatch::Entry& entry, bool set) const;

  std::uint32_t epoch_;
  std::vector<std::uint32_t> told_set_, told_cleared_;
};

}  // namespace telekerf
