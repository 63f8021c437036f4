// SPDX-License-Identifier: Apache-2.0
// What a process tells the service manager (systemd) that has started it: that it is ready, and that its loop goes on.
// Started by hand it tells nobody.
#pragma once

#include <atomic>
#include <cstdint>
#include <string_view>

namespace telekerf {

/// Sends one datagram to $NOTIFY_SOCKET (sd_notify(3)); never waits. False: nobody listens.
bool notify_service_manager(std::string_view message) noexcept;

/// The loop counts, another thread tells: ready once the loop has begun, alive only while it advances. A loop
/// that hangs is therefore killed by the service manager (WatchdogSec), whatever the other threads do.
class Supervision {
 public:
  /// Wait-free, every step of the loop.
  void step() noexcept { steps_.fetch_add(1, std::memory_order_relaxed); }
  /// The loop has ended in order; what is left to do (a record) may take its time.
  void over() noexcept { over_.store(true, std::memory_order_relaxed); }
  /// Several times in WatchdogSec, from one thread that is not the loop's.
  void tell() noexcept;

 private:
  std::atomic<std::uint64_t> steps_{0};
  std::atomic<bool> over_{false};
  std::uint64_t told_ = 0;
};

}  // namespace telekerf
