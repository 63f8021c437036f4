// SPDX-License-Identifier: Apache-2.0
// Real-time priority: asked for, never required.
#pragma once

#include <string>
#include <vector>

namespace telekerf {

/// Of the control loop, and of the threads that hand it what arrives: they wait for it and for nobody else.
inline constexpr int kLoopPriority = 60;
inline constexpr int kNetworkPriority = 40;

/// This thread runs under SCHED_FIFO as long as the object lives, if the system grants it; threads that it
/// starts meanwhile inherit that and keep it.
class RealTimePriority {
 public:
  explicit RealTimePriority(int priority) noexcept;
  ~RealTimePriority();
  RealTimePriority(const RealTimePriority&) = delete;
  RealTimePriority& operator=(const RealTimePriority&) = delete;

  bool granted() const noexcept { return granted_; }

 private:
  bool granted_;
};

/// What the system refuses a control loop of this process, and the remedy, in one sentence; empty: nothing.
/// It asks for both: not from a control loop.
std::string real_time_refusal();

/// What the kernel does to a thread of real-time priority that hardly sleeps, and the remedy, in one
/// sentence; empty: nothing. Of `period_us` it may run `runtime_us` (negative: all); the kernel's
/// sched_rt_runtime_us.
std::string throttling_sentence(long runtime_us, long period_us);

/// All of this that is so for a control loop of this process, a sentence each. Not from a control loop.
std::vector<std::string> real_time_remarks();

}  // namespace telekerf
