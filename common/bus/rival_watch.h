// SPDX-License-Identifier: Apache-2.0
// Of two masters that could not see each other when they joined (a process that was stopped for long, a
// network that was divided) one gives way as soon as they do.
#pragma once

#include <atomic>
#include <chrono>
#include <mutex>
#include <optional>
#include <string>

#include "common/bus/bus.h"
#include "common/runtime/status_reporter.h"

namespace telekerf {

class RivalWatch {
 public:
  RivalWatch(const Bus& bus, StatusReporter& status) : bus_(bus), status_(status) {}

  /// Whom the slave obeys, as far as its states tell. kUnheard: it was heard, and what it said last is old.
  enum class Obeyed : std::uint8_t { kNobody, kUs, kAnother, kUnheard };
  enum class Verdict : std::uint8_t { kWaits, kStays, kGivesWay };
  /// Of two masters: `seen`: since this one sees the other; `second`: by their names and starts it would be
  /// this one's turn to give way. Nobody goes by what a slave said before it fell silent, or before this
  /// process was suspended; a slave that stays silent is as good as none.
  static Verdict judge(Obeyed obeyed, bool second, std::chrono::nanoseconds seen) noexcept;
  /// For the loop, every step, wait-free. False: this process gives way, and ends.
  [[nodiscard]] bool goes_on(Obeyed obeyed) noexcept {
    obeyed_.store(obeyed, std::memory_order_relaxed);
    stepped_.store(std::chrono::steady_clock::now().time_since_epoch(), std::memory_order_relaxed);
    return !gives_way_.load(std::memory_order_acquire);
  }
  /// Now and then, from a thread that may write.
  void look();
  /// Why it gives way; empty: it does not.
  std::string sentence() const;

 private:
  const Bus& bus_;
  StatusReporter& status_;
  std::atomic<Obeyed> obeyed_{Obeyed::kNobody};
  std::atomic<std::chrono::steady_clock::duration> stepped_{};  ///< when the loop has said so
  std::atomic<bool> gives_way_{false};
  mutable std::mutex mutex_;
  std::string sentence_;
  std::optional<std::chrono::steady_clock::time_point> since_;  ///< the rival is seen
  bool said_ = false;
};

}  // namespace telekerf
