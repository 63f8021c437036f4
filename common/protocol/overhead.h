// SPDX-License-Identifier: Apache-2.0
// What a block costs on the wire, every head counted.
#pragma once

#include "common/protocol/blocks.h"

namespace telekerf {

/// Around each sample: Ethernet 18 bytes, IP 20, UDP 8, RTPS 43.
inline constexpr std::uint32_t kDatagramBytes = 89;
/// Of a block's anchor: position and velocity, float32, three axes.
inline constexpr std::uint32_t kAnchorBytes = 24;
/// Of a block's fields but its payload, the anchor included (plain CDR).
inline constexpr std::uint32_t kCommandFieldBytes = 96;
inline constexpr std::uint32_t kStateFieldBytes = 168;

inline std::uint32_t wire_bytes(const CommandBlock& block) noexcept {
  return kDatagramBytes + kCommandFieldBytes + block.payload.size;
}
inline std::uint32_t wire_bytes(const StateBlock& block) noexcept {
  return kDatagramBytes + kStateFieldBytes + block.payload.size + block.force.size;
}

}  // namespace telekerf
