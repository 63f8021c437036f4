// SPDX-License-Identifier: Apache-2.0
// The laser button's bits of one block.
#pragma once

#include <cstdint>

#include "common/codec/bits.h"

namespace telekerf::codec {

/// The laser button, a bit a sample: constant, one change, or as it is.
void write_button(BitWriter& out, std::uint64_t button, int block) noexcept;
std::uint64_t read_button(BitReader& in, int block) noexcept;

}  // namespace telekerf::codec
