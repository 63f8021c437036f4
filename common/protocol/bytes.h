// SPDX-License-Identifier: Apache-2.0
// Integers in bytes, the least significant first; neither end ever touches memory out of range.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>

namespace telekerf {

/// What does not fit is dropped and makes `good()` false.
class ByteWriter {
 public:
  explicit ByteWriter(std::span<std::uint8_t> out) noexcept : out_(out) {}

  /// The lowest `bytes` (1..8) of `value`; of a negative number in two's complement.
  void put(std::uint64_t value, int bytes) noexcept {
    for (int i = 0; i < bytes && room(1); ++i) out_[at_++] = static_cast<std::uint8_t>(value >> 8 * i);
  }
  void put(std::span<const std::uint8_t> bytes) noexcept {
    if (!room(bytes.size())) return;
    std::copy(bytes.begin(), bytes.end(), out_.begin() + static_cast<std::ptrdiff_t>(at_));
    at_ += bytes.size();
  }
  bool good() const noexcept { return good_; }
  std::span<const std::uint8_t> written() const noexcept { return out_.first(at_); }

 private:
  bool room(std::size_t bytes) noexcept {
    good_ = good_ && out_.size() - at_ >= bytes;
    return good_;
  }

  std::span<std::uint8_t> out_;
  std::size_t at_ = 0;
  bool good_ = true;
};

/// Past the end everything is zero and `good()` is false.
class ByteReader {
 public:
  explicit ByteReader(std::span<const std::uint8_t> in) noexcept : in_(in) {}

  std::uint64_t get(int bytes) noexcept {
    std::uint64_t value = 0;
    for (int i = 0; const std::uint8_t byte : take(static_cast<std::size_t>(bytes)))
      value |= std::uint64_t{byte} << 8 * i++;
    return value;
  }
  std::int64_t get_signed(int bytes) noexcept {
    const int shift = 64 - 8 * bytes;
    return static_cast<std::int64_t>(get(bytes) << shift) >> shift;
  }
  std::span<const std::uint8_t> take(std::size_t bytes) noexcept {
    good_ = good_ && in_.size() >= bytes;
    if (!good_) return {};
    const auto taken = in_.first(bytes);
    in_ = in_.subspan(bytes);
    return taken;
  }
  std::span<const std::uint8_t> rest() const noexcept {
    return good_ ? in_ : std::span<const std::uint8_t>{};
  }
  bool good() const noexcept { return good_; }

 private:
  std::span<const std::uint8_t> in_;
  bool good_ = true;
};

}  // namespace telekerf
