// SPDX-License-Identifier: Apache-2.0
// The coded samples of a block.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>

namespace telekerf {

/// What a codec writes begins with this many bytes that stay the same as long as its settings do, and
inline constexpr std::size_t kPayloadFormatBytes = 8;
/// then with a number of 16 bits, most significant byte first: one more each payload.
inline constexpr std::size_t kPayloadPrefixBytes = kPayloadFormatBytes + 2;

/// As the codec wrote them. Only the first `size` octets count, and a copy moves no others: blocks go from
/// hand to hand several times a tick, and most of a payload's room stays empty.
struct Payload {
  static constexpr std::size_t kCapacity = 2048;
  std::array<std::uint8_t, kCapacity> bytes;
  std::uint16_t size = 0;  ///< at most kCapacity; a writer refuses more

  Payload() noexcept {}  // NOLINT(modernize-use-equals-default): `bytes` stay as they are
  ~Payload() = default;
  Payload(const Payload& other) noexcept : size(other.size) {
    copy(other);
  }  // NOLINT: `bytes` as far as they count
  Payload& operator=(const Payload& other) noexcept {
    if (this == &other) return *this;
    size = other.size;
    copy(other);
    return *this;
  }

  std::span<const std::uint8_t> view() const { return std::span(bytes).first(filled()); }
  std::span<std::uint8_t> room() { return bytes; }

 private:
  std::size_t filled() const noexcept { return std::min<std::size_t>(size, kCapacity); }
  void copy(const Payload& other) noexcept {
    std::copy_n(other.bytes.begin(), other.filled(), bytes.begin());
  }
};

}  // namespace telekerf
