// SPDX-License-Identifier: Apache-2.0
// Prepares each newly published contour outside the control loop and hands it over by pointer.
#pragma once

#include <fmt/format.h>

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <utility>

#include "common/bus/endpoints.h"
#include "common/bus/handover.h"
#include "common/runtime/say.h"
#include "common/runtime/startup_error.h"

namespace telekerf {

/// `Prepared` is what a node needs of a contour (a guide, a corridor). A first contour that does not fit ends
/// the subscription with the StartupError's sentence; a later one is refused with it, and what is in force
/// stays. So is one whose id is not its digest. The contour in force, published again, changes nothing.
template <class Prepared>
class ContourSubscriber {
 public:
  using Prepare = std::function<std::unique_ptr<Prepared>(const ContourMessage&)>;

  ContourSubscriber(Bus& bus, Prepare prepare)
      : reader_(bus),
        prepare_(std::move(prepare)),
        thread_([this](const std::stop_token& stop) { run(stop); }) {}

  /// The newest prepared contour, null before the first. For one thread, the control loop's, once a step:
  /// wait-free. What an earlier step got may be freed after the step that got another one (Handover).
  Prepared* current() noexcept { return prepared_.current(); }
  /// True once a contour was refused; `refusal()` says why.
  bool refused() const noexcept { return refused_.load(std::memory_order_acquire); }
  std::string refusal() const {
    const std::lock_guard lock(mutex_);
    return refusal_;
  }
  /// Contours that were refused while the run went on.
  std::uint64_t unfit() const noexcept { return unfit_.load(std::memory_order_relaxed); }
  /// Prepares the newest contour once more, for what has changed in its preparation. Wait-free. If it is
  /// refused now, what was in force stays, and the refusal's sentence goes to stderr.
  void request_rebuild() noexcept { rebuild_.store(true, std::memory_order_release); }
  /// The message that was prepared last: the one behind current(), or behind what current() will give next.
  ContourMessage message() const {
    const std::lock_guard lock(mutex_);
    return message_;
  }

 private:
  void run(const std::stop_token& stop) {
    bool any = false;
    while (!stop.stop_requested()) {
      while (auto received = reader_.take()) {
        if (received->value.id != digest_of(received->value)) {
          refuse(received->value, "its id is not the digest of its points");
          continue;
        }
        if (any && received->value.id == message_.id) continue;
        try {
          auto prepared = prepare_(received->value);
          {
            const std::lock_guard lock(mutex_);
            message_ = std::move(received->value);
          }
          prepared_.offer(std::move(prepared));
          any = true;
        } catch (const StartupError& refusal) {
          if (any) {
            refuse(received->value, refusal.what());
            continue;
          }
          const std::lock_guard lock(mutex_);
          refusal_ = refusal.what();
          refused_.store(true, std::memory_order_release);
        }
      }
      if (rebuild_.exchange(false, std::memory_order_acq_rel) && any) rebuild();
      prepared_.collect();
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
  }
  void refuse(const ContourMessage& message, const char* why) {
    unfit_.fetch_add(1, std::memory_order_relaxed);
    write_line(stderr, fmt::format("contour {} refused: {}", message.source, why));
  }
  void rebuild() {
    try {
      prepared_.offer(prepare_(message_));  // only this thread writes it
    } catch (const StartupError& refusal) {
      write_line(stderr, fmt::format("{}: stays as it is: {}", message_.source, refusal.what()));
    }
  }

  Reader<ContourMessage> reader_;
  Prepare prepare_;
  Handover<Prepared> prepared_;
  mutable std::mutex mutex_;
  ContourMessage message_;
  std::string refusal_;
  std::atomic<bool> refused_{false};
  std::atomic<std::uint64_t> unfit_{0};
  std::atomic<bool> rebuild_{false};
  std::jthread thread_;  ///< last: starts when everything else is there, ends first
};

}  // namespace telekerf
