// SPDX-License-Identifier: Apache-2.0
// Who has left, kept for a while: a process that was stopped for long is told in any order that another one
// is gone and there again (Fast DDS does so in two threads). Who is still heard seconds later is there.
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>

#include "common/bus/presence.h"

namespace telekerf::bus {

/// Not thread-safe.
class Departures {
 public:
  using Key = std::array<std::uint8_t, 12>;
  using Clock = std::chrono::steady_clock;
  /// What was under way when somebody left has come by then.
  static constexpr std::chrono::seconds kAfterwards{4};
  static constexpr std::size_t kMost = 64;

  void note(const Key& key, const Neighbour& who, Clock::time_point now = Clock::now()) {
    if (left_.size() >= kMost) left_.clear();
    left_[key] = {who, now};
  }
  /// Is heard: who it is, if it has left long enough ago not to be an echo. Then it has not left any more.
  std::optional<Neighbour> heard(const Key& key, Clock::time_point now = Clock::now()) {
    const auto found = left_.find(key);
    if (found == left_.end() || now - found->second.when < kAfterwards) return std::nullopt;
    const Neighbour who = found->second.who;
    left_.erase(found);
    return who;
  }

 private:
  struct Left {
    Neighbour who;
    Clock::time_point when;
  };
  std::map<Key, Left> left_;
};

}  // namespace telekerf::bus
