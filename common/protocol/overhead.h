// SPDX-License-Identifier: Apache-2.0
// What a block costs on the wire, every head counted: as a capture of the frames shows it, and 4 bytes more
// for Ethernet's check sequence, which captures leave out (tests/system/test_wire_frames.cpp holds it to
// that).
#pragma once

#include "common/protocol/blocks.h"

namespace telekerf {

/// Around each sample: Ethernet 14 + 4 bytes, IPv4 20, UDP 8, RTPS head 20, DATA submessage 24,
/// encapsulation 4.
inline constexpr std::uint32_t kDatagramBytes = 94;
/// Of a block's anchor: position and velocity, float32, three axes.
inline constexpr std::uint32_t kAnchorBytes = 24;
/// Of a block's fields but its payload, the anchor included (plain CDR).
inline constexpr std::uint32_t kCommandFieldBytes = 96;
inline constexpr std::uint32_t kStateFieldBytes = 168;

/// RTPS fills up a sample to whole words.
inline constexpr std::uint32_t whole_words(std::uint32_t bytes) noexcept { return (bytes + 3U) & ~3U; }

inline std::uint32_t wire_bytes(const CommandBlock& block) noexcept {
  return kDatagramBytes + whole_words(kCommandFieldBytes + block.payload.size);
}
inline std::uint32_t wire_bytes(const StateBlock& block) noexcept {
  return kDatagramBytes + whole_words(kStateFieldBytes + block.payload.size) + whole_words(block.force.size);
}

}  // namespace telekerf
