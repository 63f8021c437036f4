// SPDX-License-Identifier: Apache-2.0
// Time that a sender's loop has lost: its stamps go on while the counter of its samples stands.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

namespace telekerf::streaming {

/// The stamps of the newest blocks of one sender. All times in ns, the sender's clock; a sample's time is its
/// index times the period, so another sample rate changes nothing. No allocation, lock or throw.
class LostTime {
 public:
  /// A block came: who counts (another epoch begins anew), its last sample's time, and when it was sent.
  void arrived(std::uint32_t epoch, std::int64_t made_ns, std::int64_t sent_ns) noexcept {
    if (epoch != epoch_) count_ = next_ = 0;
    epoch_ = epoch;
    lag_ns_ = possible(sent_ns) ? std::optional(sent_ns - made_ns) : std::nullopt;
    if (!lag_ns_) return;
    blocks_[next_] = {made_ns, *lag_ns_};
    next_ = (next_ + 1) % kSize;
    count_ = std::min(count_ + 1, kSize);
  }
  /// Lost between the making of the sample of that time and the sending of the block that arrived last: no
  /// more than this. None: no block is known that was sent before that sample.
  std::optional<std::int64_t> since_ns(std::int64_t made_ns) const noexcept {
    const Block* before = nullptr;
    for (std::size_t n = 0; n < count_; ++n) {
      const Block& block = blocks_[n];
      if (block.made_ns < made_ns && (before == nullptr || block.made_ns > before->made_ns)) before = &block;
    }
    if (before == nullptr || !lag_ns_) return std::nullopt;
    return std::max<std::int64_t>(0, *lag_ns_ - before->lag_ns);
  }
  /// Any 64 bits may come.
  static bool possible(std::int64_t stamp_ns) noexcept {
    return stamp_ns >= 0 && stamp_ns < std::int64_t{1} << 62;
  }

 private:
  static constexpr std::size_t kSize = 16;  ///< twice the blocks in a packet: late ones count too
  struct Block {
    std::int64_t made_ns = 0;
    std::int64_t lag_ns = 0;  ///< how far the clock is ahead of the samples' time
  };
  std::array<Block, kSize> blocks_{};
  std::size_t count_ = 0;
  std::size_t next_ = 0;
  std::uint32_t epoch_ = 0;
  std::optional<std::int64_t> lag_ns_;  ///< of the block that arrived last
};

}  // namespace telekerf::streaming
