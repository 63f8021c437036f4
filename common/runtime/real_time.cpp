// SPDX-License-Identifier: Apache-2.0
#include "common/runtime/real_time.h"

#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>

namespace telekerf {

RealTimePriority::RealTimePriority(int priority) noexcept {
  sched_param wanted{};
  wanted.sched_priority = priority;
  granted_ = pthread_setschedparam(pthread_self(), SCHED_FIFO, &wanted) == 0;
}

RealTimePriority::~RealTimePriority() {
  if (!granted_) return;
  const sched_param usual{};
  pthread_setschedparam(pthread_self(), SCHED_OTHER, &usual);
}

std::string real_time_refusal() {
  const bool priority = RealTimePriority(kLoopPriority).granted();
  const bool memory = mlockall(MCL_CURRENT | MCL_FUTURE) == 0;
  if (priority && memory) return {};
  const char* const what = priority ? "locked memory is"
                           : memory ? "real-time priority is"
                                    : "real-time priority and locked memory are";
  return std::string(what) +
         " refused by the system, so that control steps may come late; rtprio and memlock in "
         "/etc/security/limits.conf "
         "grant it";
}

}  // namespace telekerf
