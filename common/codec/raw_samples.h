// SPDX-License-Identifier: Apache-2.0
// Samples as they are, float32: when that is smaller, or nothing else keeps the promised error.
#pragma once

#include <bit>
#include <span>

#include "common/codec/axis_code.h"
#include "common/codec/bits.h"

namespace telekerf::codec {

inline constexpr int kRawSampleBits = 32;

AxisCode raw_code(std::span<const double> samples) noexcept;

template <typename Sink>
void write_raw_samples(Sink& out, const AxisCode& code, int block) noexcept {
  for (std::size_t n = 0; n < static_cast<std::size_t>(block); ++n)
    out.bits(std::bit_cast<std::uint32_t>(code.raw[n]), kRawSampleBits);
}

/// False: a number that no encoder writes, or the end.
bool read_raw_samples(BitReader& in, std::span<double> samples) noexcept;

}  // namespace telekerf::codec
