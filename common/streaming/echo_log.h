// SPDX-License-Identifier: Apache-2.0
// How old a command is, judged by the receiver's clock alone: the master echoes the newest state block that
// it had when it made the command, and who sent that block knows when.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

namespace telekerf::streaming {

/// The stamps of the newest state blocks sent. No allocation, lock or throw.
class EchoLog {
 public:
  void sent(std::uint32_t sequence, std::int64_t sent_ns) noexcept {
    entries_[sequence % kSize] = {sequence, sent_ns};
  }
  /// No command that echoes this is older: an upper bound, s, the way of the state included. None: no such
  /// block was sent by this process lately, so nothing is known.
  std::optional<double> age_s(std::uint32_t sequence, std::int64_t echo_ns,
                              std::int64_t now_ns) const noexcept {
    const Entry& entry = entries_[sequence % kSize];
    // A copy of an earlier block counts from before the block that its packet echoes.
    if (sequence == 0 || entry.sequence != sequence || echo_ns > entry.sent_ns || now_ns < entry.sent_ns)
      return std::nullopt;
    if (echo_ns < entry.sent_ns - kLongestCopy_ns) return std::nullopt;  // any 64 bits may come
    return static_cast<double>(now_ns - echo_ns) * 1e-9;
  }

 private:
  static constexpr std::size_t kSize = 1024;
  static constexpr std::int64_t kLongestCopy_ns = 50'000'000'000;
  struct Entry {
    std::uint32_t sequence = 0;
    std::int64_t sent_ns = 0;
  };
  std::array<Entry, kSize> entries_{};
};

}  // namespace telekerf::streaming
