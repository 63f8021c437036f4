// SPDX-License-Identifier: Apache-2.0
#include "common/runtime/real_time.h"

#include <fmt/format.h>
#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>

#include <cstdlib>
#include <fstream>
#include <optional>
#include <utility>

namespace telekerf {
namespace {

/// Of the kernel; none where there is no such setting.
std::optional<long> kernel_setting(const char* path) {
  std::ifstream file(path);
  long value = 0;
  if (!(file >> value)) return {};
  return value;
}

}  // namespace

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

std::string throttling_sentence(long runtime_us, long period_us) {
  if (runtime_us < 0 || runtime_us >= period_us) return {};
  return fmt::format(
      "control steps that take more than {:.0f} % of the time are held up by the kernel, {:g} ms of every "
      "{:g} s "
      "(sched_rt_runtime_us = {}), beam off; sysctl -w kernel.sched_rt_runtime_us=-1 ends that",
      100.0 * static_cast<double>(runtime_us) / static_cast<double>(period_us),
      1e-3 * static_cast<double>(period_us - runtime_us), 1e-6 * static_cast<double>(period_us), runtime_us);
}

std::vector<std::string> real_time_remarks() {
  std::vector<std::string> remarks;
  if (std::string refusal = real_time_refusal(); !refusal.empty()) remarks.push_back(std::move(refusal));
  if (!RealTimePriority(kLoopPriority).granted()) return remarks;  // nobody holds up what has no priority
  const auto runtime_us = kernel_setting("/proc/sys/kernel/sched_rt_runtime_us");
  const auto period_us = kernel_setting("/proc/sys/kernel/sched_rt_period_us");
  if (!runtime_us || !period_us) return remarks;
  if (std::string held_up = throttling_sentence(*runtime_us, *period_us); !held_up.empty())
    remarks.push_back(std::move(held_up));
  return remarks;
}

}  // namespace telekerf
