// SPDX-License-Identifier: Apache-2.0
// Independent runs on all processors.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <thread>
#include <vector>

namespace telekerf::experiments {

/// `task(i)` for every i below `count`, on `jobs` threads, 0: one a processor. Tasks may not throw.
template <typename Task>
void for_each_parallel(std::size_t count, const Task& task, unsigned jobs = 0) {
  if (count == 0) return;
  std::atomic<std::size_t> next{0};
  const auto work = [&] {
    for (std::size_t i = next++; i < count; i = next++) task(i);
  };
  const std::size_t wanted = jobs > 0 ? jobs : std::thread::hardware_concurrency();
  std::vector<std::jthread> workers;
  for (std::size_t t = 0; t < std::clamp<std::size_t>(wanted, 1, count); ++t) workers.emplace_back(work);
}

}  // namespace telekerf::experiments
