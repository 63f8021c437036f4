// SPDX-License-Identifier: Apache-2.0
// Prepares each newly published contour outside the control loop and hands it over by pointer.
#pragma once

#include <fmt/format.h>

#include <atomic>
#include <chrono>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "common/bus/endpoints.h"
#include "common/runtime/startup_error.h"

namespace telekerf {

/// `Prepared` is what a node needs of a contour (a guide, a corridor). Everything prepared lives as long as
/// the watch, so the loop may keep using an old one. A contour that does not fit ends the watch with the
/// StartupError's sentence.
template <class Prepared>
class ContourSubscriber {
 public:
  using Prepare = std::function<std::unique_ptr<Prepared>(const ContourMessage&)>;

  ContourSubscriber(Bus& bus, Prepare prepare)
      : reader_(bus),
        prepare_(std::move(prepare)),
        thread_([this](const std::stop_token& stop) { run(stop); }) {}

  /// The newest prepared contour, null before the first. For the control loop: wait-free.
  Prepared* current() const noexcept { return current_.load(std::memory_order_acquire); }
  /// True once a contour was refused; `refusal()` says why.
  bool refused() const noexcept { return refused_.load(std::memory_order_acquire); }
  std::string refusal() const {
    const std::lock_guard lock(mutex_);
    return refusal_;
  }
  /// Prepares the newest contour once more, for what has changed in its preparation. Wait-free. If it is
  /// refused now, what was in force stays, and the refusal's sentence goes to stderr.
  void request_rebuild() noexcept { rebuild_.store(true, std::memory_order_release); }
  /// The message behind current().
  ContourMessage message() const {
    const std::lock_guard lock(mutex_);
    return message_;
  }

 private:
  void run(const std::stop_token& stop) {
    while (!stop.stop_requested()) {
      while (const auto received = reader_.take()) {
        try {
          take_over(received->value);
        } catch (const StartupError& refusal) {
          const std::lock_guard lock(mutex_);
          refusal_ = refusal.what();
          refused_.store(true, std::memory_order_release);
        }
      }
      if (rebuild_.exchange(false, std::memory_order_acq_rel) && current() != nullptr) {
        try {
          take_over(message_);
        } catch (const StartupError& refusal) {
          fmt::print(stderr, "{}: stays as it is: {}\n", message_.source, refusal.what());
        }
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
  }
  void take_over(const ContourMessage& message) {
    auto prepared = prepare_(message);
    const std::lock_guard lock(mutex_);
    if (&message != &message_) message_ = message;
    all_.push_back(std::move(prepared));
    current_.store(all_.back().get(), std::memory_order_release);
  }

  Reader<ContourMessage> reader_;
  Prepare prepare_;
  mutable std::mutex mutex_;
  std::vector<std::unique_ptr<Prepared>> all_;
  ContourMessage message_;
  std::string refusal_;
  std::atomic<Prepared*> current_{nullptr};
  std::atomic<bool> refused_{false};
  std::atomic<bool> rebuild_{false};
  std::jthread thread_;  ///< last: starts when everything else is there, ends first
};

}  // namespace telekerf
