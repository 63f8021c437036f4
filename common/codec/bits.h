// SPDX-License-Identifier: Apache-2.0
// Bit stream, most significant bit first, with Exp-Golomb codes; neither end ever touches memory out of
// range.
#pragma once

#include <bit>
#include <cstdint>
#include <span>

namespace telekerf::codec {

/// Signed integers as 0, -1, 1, -2, 2 ... -> 0, 1, 2, 3, 4 ...
constexpr std::uint64_t zigzag(std::int64_t value) noexcept {
  return (static_cast<std::uint64_t>(value) << 1) ^ static_cast<std::uint64_t>(value >> 63);
}
constexpr std::int64_t unzigzag(std::uint64_t code) noexcept {
  return static_cast<std::int64_t>(code >> 1) ^ -static_cast<std::int64_t>(code & 1);
}

/// Longest Exp-Golomb prefix that is written or accepted: values below 2^48.
inline constexpr int kMaxGolombBits = 48;
inline constexpr std::uint64_t kMaxGolomb = (std::uint64_t{1} << kMaxGolombBits) - 1;

/// Bits of the Exp-Golomb code of order `order` (ITU-T H.264, 9.1; order k is k bits wider at the base).
constexpr int golomb_bits(std::uint64_t value, int order) noexcept {
  const auto width = static_cast<int>(std::bit_width((value >> order) + 1));
  return 2 * width - 1 + order;
}

/// Writes into a fixed buffer; what does not fit sets `overflowed()` and is dropped.
class BitWriter {
 public:
  explicit BitWriter(std::span<std::uint8_t> out) noexcept : out_(out) {}

  /// The lowest `count` (0..64) bits of `value`.
  void bits(std::uint64_t value, int count) noexcept {
    if (count > static_cast<int>(out_.size() * 8 - position_)) {
      overflowed_ = true;
      return;
    }
    while (count > 0) {
      const int free = 8 - static_cast<int>(position_ % 8);
      const int take = count < free ? count : free;
      // 1 to 8 bits at a time.
      // NOLINTNEXTLINE(clang-analyzer-core.UndefinedBinaryOperatorResult)
      const auto chunk = static_cast<std::uint8_t>((value >> (count - take)) & ((1U << take) - 1U));
      auto& byte = out_[position_ / 8];
      if (free == 8) byte = 0;
      byte = static_cast<std::uint8_t>(byte | (chunk << (free - take)));
      position_ += static_cast<std::size_t>(take);
      count -= take;
    }
  }
  void golomb(std::uint64_t value, int order) noexcept {
    if (value > kMaxGolomb) {
      overflowed_ = true;
      return;
    }
    const std::uint64_t base = (value >> order) + 1;
    const auto width = static_cast<int>(std::bit_width(base));
    bits(0, width - 1);
    bits(base, width);
    bits(value, order);
  }
  void signed_golomb(std::int64_t value, int order) noexcept { golomb(zigzag(value), order); }

  std::size_t position() const noexcept { return position_; }
  std::size_t bytes() const noexcept { return (position_ + 7) / 8; }
  bool overflowed() const noexcept { return overflowed_; }
  /// Forgets everything after `position` (an earlier value of position()), the overflow included.
  void rewind(std::size_t position) noexcept {
    position_ = position;
    overflowed_ = false;
    if (position_ % 8 != 0) {
      auto& byte = out_[position_ / 8];
      byte = static_cast<std::uint8_t>(byte & (0xFF00U >> (position_ % 8)));
    }
  }

 private:
  std::span<std::uint8_t> out_;
  std::size_t position_ = 0;
  bool overflowed_ = false;
};

/// Reads any bytes; past the end everything is zero and `truncated()` is set.
class BitReader {
 public:
  explicit BitReader(std::span<const std::uint8_t> in) noexcept : in_(in) {}

  std::uint64_t bits(int count) noexcept {
    if (count > static_cast<int>(in_.size() * 8 - position_)) {
      truncated_ = true;
      position_ = in_.size() * 8;
      return 0;
    }
    std::uint64_t value = 0;
    while (count > 0) {
      const int left = 8 - static_cast<int>(position_ % 8);
      const int take = count < left ? count : left;
      const unsigned chunk =
          // NOLINTNEXTLINE(clang-analyzer-core.UndefinedBinaryOperatorResult)
          (static_cast<unsigned>(in_[position_ / 8]) >> (left - take)) & ((1U << take) - 1U);
      value = (value << take) | chunk;
      position_ += static_cast<std::size_t>(take);
      count -= take;
    }
    return value;
  }
  bool bit() noexcept { return bits(1) != 0; }
  std::uint64_t golomb(int order) noexcept {
    int zeros = 0;
    while (!bit()) {
      if (truncated_) return 0;
      if (++zeros + order > kMaxGolombBits) {
        malformed_ = true;
        return 0;
      }
    }
    const std::uint64_t base = (std::uint64_t{1} << zeros) | bits(zeros);
    return ((base - 1) << order) | bits(order);
  }
  std::int64_t signed_golomb(int order) noexcept { return unzigzag(golomb(order)); }

  bool truncated() const noexcept { return truncated_; }
  bool malformed() const noexcept { return malformed_; }
  bool failed() const noexcept { return truncated_ || malformed_; }
  /// True when only the zero padding of the last byte is left.
  bool at_clean_end() noexcept {
    const auto left = in_.size() * 8 - position_;
    return left < 8 && bits(static_cast<int>(left)) == 0;
  }

 private:
  std::span<const std::uint8_t> in_;
  std::size_t position_ = 0;
  bool truncated_ = false;
  bool malformed_ = false;
};

}  // namespace telekerf::codec
