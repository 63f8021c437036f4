// SPDX-License-Identifier: Apache-2.0
// What a process has made of events, told to whoever said them.
#pragma once

#include <chrono>
#include <cstdint>
#include <mutex>
#include <string>
#include <vector>

#include "common/bus/endpoints.h"

namespace telekerf {

/// Thread-safe; none of it for a control loop.
class EventAnswers {
 public:
  explicit EventAnswers(Bus& bus) : role_(bus.settings().role), writer_(bus) {}

  /// To the process whose start is `asker`. `refusal`: why nothing comes of it; empty: it was done.
  void give(std::uint32_t asker, const std::string& refusal);
  /// Now and then: who asks may find this process later than this process finds who asks, so each answer is
  /// said once more.
  void again();

 private:
  struct Given {
    EventMessage answer;
    std::chrono::steady_clock::time_point when;
  };
  std::string role_;
  std::mutex mutex_;
  std::vector<Given> given_;
  Writer<EventMessage> writer_;
};

}  // namespace telekerf
