// SPDX-License-Identifier: Apache-2.0
#include "common/runtime/real_time.h"

#include <pthread.h>
#include <sched.h>

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

}  // namespace telekerf
