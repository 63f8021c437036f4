// SPDX-License-Identifier: Apache-2.0
// What is done now and then beside a control loop, by a thread that may write, allocate and wait.
#pragma once

#include <chrono>
#include <functional>
#include <thread>
#include <utility>

namespace telekerf {

class Periodic {
 public:
  /// Until it is destroyed; `chore` must not throw.
  Periodic(std::chrono::milliseconds period, std::function<void()> chore)
      : thread_([period, chore = std::move(chore)](const std::stop_token& stop) {
          for (; !stop.stop_requested(); std::this_thread::sleep_for(period)) chore();
        }) {}

 private:
  std::jthread thread_;
};

}  // namespace telekerf
