// SPDX-License-Identifier: Apache-2.0
// The virtual-time driver of the network emulator: messages in, messages out when they are due.
#pragma once

#include <cstdint>
#include <unordered_map>
#include <vector>

#include "common/protocol/overhead.h"
#include "common/protocol/received.h"
#include "netem/core/emulator.h"

namespace telekerf::simulation {

/// The virtual-time driver of the emulator for one kind of message.
template <class T>
class VirtualLink {
 public:
  VirtualLink(const netem::DirectionProfile& profile, std::uint64_t seed, netem::Direction direction)
      : emulator_(profile, netem::StreamKey{seed, 0, direction}) {}

  /// A block; returns what it costs on the wire.
  std::uint32_t push(std::int64_t now_ns, const T& block) {
    const std::uint32_t bytes = cost_(block);
    push(now_ns, block, bytes);
    return bytes;
  }
  void push(std::int64_t now_ns, const T& message, std::uint32_t bytes) {
    const std::uint64_t tag = next_++;
    waiting_.emplace(tag, message);
    if (emulator_.push(now_ns, bytes, tag).lost()) waiting_.erase(tag);
  }
  void deliver(std::int64_t now_ns, std::vector<Received<T>>& out) {
    while (const auto delivery = emulator_.pop(now_ns)) {
      const auto found = waiting_.find(delivery->tag);
      // Damaged datagrams fail their checksum at the receiver.
      if (found != waiting_.end() && !delivery->corrupted) out.push_back({found->second, delivery->due_ns});
    }
    // Copies of a message share its tag, so it is kept until nothing older than it can still arrive.
    if (!emulator_.next_deadline()) waiting_.clear();
  }
  const netem::Counters& counters() const noexcept { return emulator_.counters(); }

 private:
  netem::Emulator emulator_;
  WireCost<T> cost_;
  std::unordered_map<std::uint64_t, T> waiting_;
  std::uint64_t next_ = 0;
};

}  // namespace telekerf::simulation
