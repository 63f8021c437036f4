// SPDX-License-Identifier: Apache-2.0
// Whoever waits says for what, whom it sees, and what may be tried.
#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <set>
#include <string>

#include "common/bus/bus.h"
#include "common/runtime/status_reporter.h"

namespace telekerf {

/// Who waits for `what`, as `bus` sees the cell: one sentence. `role`: who would bring it.
std::string waiting_sentence(const Bus& bus, const std::string& what, const std::string& role);

/// What a control loop misses, for the thread that may speak.
class Lookout {
 public:
  /// Something that may be missing; both literals.
  struct Wish {
    const char* what;  ///< "a contour"
    const char* role;  ///< who brings it: "vision"
  };

  Lookout(const Bus& bus, StatusReporter& status) : bus_(bus), status_(status) {}

  /// Wait-free, every step: what is missing now, a literal's address; null: nothing.
  void missing(const Wish* wish) noexcept { wish_.store(wish, std::memory_order_relaxed); }
  /// Devices whose datagrams come over UDP, where anybody may send some.
  enum class Device { kDrive, kLaser, kButton, kHand };
  /// Wait-free, every step: how many were refused so far that came in this device's place.
  void refused(Device device, std::uint64_t datagrams) noexcept {
    refused_[static_cast<std::size_t>(device)].store(datagrams, std::memory_order_relaxed);
  }
  /// Now and then, from a thread that may write: says every few seconds what is waited for, and once whoever
  /// is not heard; what devices refuse, the first time and each time it is ten times as much.
  void look();

 private:
  using Clock = std::chrono::steady_clock;
  static constexpr std::size_t kDevices = 4;
  void look_at_devices();

  const Bus& bus_;
  StatusReporter& status_;
  std::atomic<const Wish*> wish_{nullptr};
  const Wish* said_ = nullptr;
  Clock::time_point since_, next_;
  std::set<std::string> strangers_;  ///< told of
  std::array<std::atomic<std::uint64_t>, kDevices> refused_{};
  std::array<std::uint64_t, kDevices> told_{};  ///< of them, at the last word
};

}  // namespace telekerf
