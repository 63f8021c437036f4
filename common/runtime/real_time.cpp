// SPDX-License-Identifier: Apache-2.0
#include "common/runtime/real_time.h"

#include <fmt/format.h>
#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>

#include <cstdlib>

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
  // systemd numbers whatever it starts.
  const bool service = std::getenv("INVOCATION_ID") != nullptr;  // NOLINT: nobody changes it
  return fmt::format("{} refused by the system, so that control steps may come late; {} grant it", what,
                     service ? "LimitRTPRIO=60 and LimitMEMLOCK=infinity of the unit"
                             : "rtprio and memlock in /etc/security/limits.conf");
}

}  // namespace telekerf
