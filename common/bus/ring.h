// SPDX-License-Identifier: Apache-2.0
// Bounded lock-free ring: one producer, one consumer. A full ring drops the newest and counts it.
#pragma once

#include <atomic>
#include <bit>
#include <cstdint>
#include <memory>
#include <optional>
#include <utility>

namespace telekerf {

/// `T` is default-constructible and nothrow-movable. Slots are made once; neither side allocates afterwards
/// (beyond what moving a T does).
template <class T>
class Ring {
 public:
  /// Holds at least `capacity` elements (rounded up to a power of two).
  explicit Ring(std::size_t capacity)
      : mask_(std::bit_ceil(capacity < 2 ? std::size_t{2} : capacity) - 1), slots_(new T[mask_ + 1]) {}

  /// Producer only. False: full, counted.
  bool push(T&& value) noexcept {
    const std::uint64_t head = head_.load(std::memory_order_relaxed);
    if (head - tail_.load(std::memory_order_acquire) > mask_) {
      dropped_.fetch_add(1, std::memory_order_relaxed);
      return false;
    }
    slots_[head & mask_] = std::move(value);
    head_.store(head + 1, std::memory_order_release);
    return true;
  }

  /// Consumer only, oldest first.
  std::optional<T> take() noexcept {
    const std::uint64_t tail = tail_.load(std::memory_order_relaxed);
    if (tail == head_.load(std::memory_order_acquire)) return std::nullopt;
    std::optional<T> value(std::move(slots_[tail & mask_]));
    tail_.store(tail + 1, std::memory_order_release);
    return value;
  }

  std::uint64_t dropped() const noexcept { return dropped_.load(std::memory_order_relaxed); }
  std::size_t capacity() const noexcept { return mask_ + 1; }

 private:
  static constexpr std::size_t kCacheLine = 64;

  std::size_t mask_;
  std::unique_ptr<T[]> slots_;
  alignas(kCacheLine) std::atomic<std::uint64_t> head_{0};  // written by the producer
  alignas(kCacheLine) std::atomic<std::uint64_t> tail_{0};  // written by the consumer
  alignas(kCacheLine) std::atomic<std::uint64_t> dropped_{0};
};

}  // namespace telekerf
