// SPDX-License-Identifier: Apache-2.0
// What can go wrong with one block or packet: values, never exceptions, because a control step gets them.
#pragma once

#include <array>
#include <cstdint>

namespace telekerf::codec {

enum class CodecError : std::uint8_t {
  kNotFinite,     ///< NaN or Inf in the signal or the trend
  kOutOfRange,    ///< beyond what a block can carry (|x| above 1e30)
  kWrongSize,     ///< not exactly one block of samples
  kNoRoom,        ///< the newest block does not fit the output
  kWrongVersion,  ///< written by another version of the codec
  kTruncated,     ///< ends before its last block does
  kMalformed,     ///< a length, index, exponent, mode or padding that no encoder writes
  kReplayed,      ///< its sequence number was seen among the last 64
};
inline constexpr int kCodecErrors = 8;

/// One sentence fragment for reports, e.g. "truncated packet".
const char* to_string(CodecError error) noexcept;

/// How often each error was met, plus the good ones.
struct CodecCounters {
  std::uint64_t good = 0;
  std::array<std::uint64_t, kCodecErrors> refused{};

  void count(CodecError error) noexcept { ++refused[static_cast<std::size_t>(error)]; }
  std::uint64_t of(CodecError error) const noexcept { return refused[static_cast<std::size_t>(error)]; }
};

}  // namespace telekerf::codec
