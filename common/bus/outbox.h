// SPDX-License-Identifier: Apache-2.0
// Samples on their way from a control loop to a thread that may allocate and wait. Inside the bus only.
#pragma once

#include <semaphore.h>

#include <array>
#include <atomic>
#include <cstddef>
#include <functional>
#include <thread>
#include <utility>

#include "common/runtime/real_time.h"

namespace telekerf::bus {

/// One producer. Slots are reused, so that one whose vectors have their size costs no heap. Full: the newest
/// is lost, as on the way.
template <class Sample>
class Outbox {
 public:
  /// `send` is called from the outbox's own thread, one at a time, in order.
  explicit Outbox(std::function<void(Sample&)> send) : send_(std::move(send)) {
    sem_init(&waiting_, 0, 0);
    const RealTimePriority inherited(kNetworkPriority);
    thread_ = std::thread([this] { run(); });
  }
  ~Outbox() {
    ended_.store(true, std::memory_order_release);
    sem_post(&waiting_);
    thread_.join();
    sem_destroy(&waiting_);
  }
  Outbox(const Outbox&) = delete;
  Outbox& operator=(const Outbox&) = delete;

  /// Where the next one may be written; null: full.
  Sample* room() noexcept {
    if (head_ - tail_.load(std::memory_order_acquire) == kSlots) return nullptr;
    return &slots_[head_ % kSlots];
  }
  /// What stands in room() is on its way. Wait-free.
  void post() noexcept {
    ++head_;
    sem_post(&waiting_);
  }

 private:
  static constexpr std::size_t kSlots = 32;

  void run() {
    for (std::size_t tail = 0;; ++tail) {
      while (sem_wait(&waiting_) != 0) {
      }
      if (ended_.load(std::memory_order_acquire)) return;
      send_(slots_[tail % kSlots]);
      tail_.store(tail + 1, std::memory_order_release);
    }
  }

  std::function<void(Sample&)> send_;
  std::array<Sample, kSlots> slots_;
  std::size_t head_ = 0;  ///< the producer's
  std::atomic<std::size_t> tail_{0};
  std::atomic<bool> ended_{false};
  sem_t waiting_{};
  std::thread thread_;
};

}  // namespace telekerf::bus
