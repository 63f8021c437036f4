// SPDX-License-Identifier: Apache-2.0
// What a block costs on the wire, every head counted: as a capture of the frames shows it, and 4 bytes more
// for Ethernet's check sequence, which captures leave out (tests/system/test_wire_frames.cpp holds it to
// that).
#pragma once

#include <array>

#include "common/protocol/contract_version.h"
#include "common/protocol/header_compression.h"

namespace telekerf {

/// Around each sample: Ethernet 14 + 4 bytes, IPv4 20, UDP 8, RTPS head 20, DATA submessage 24,
/// encapsulation 4.
inline constexpr std::uint32_t kDatagramBytes = 94;
/// RTPS fills up a sample to whole words.
inline constexpr std::uint32_t sample_bytes(std::size_t octets) noexcept {
  constexpr std::uint32_t kLength = 4;
  return kLength + ((static_cast<std::uint32_t>(octets) + 3U) & ~3U);
}

/// Of one stream's blocks in their order: a block's cost depends on those before it. No allocation, lock or
/// throw.
template <class Block>
class WireCost {};

template <class Block, std::size_t kMost>
class BlockCost {
 public:
  /// Bytes of the frame.
  std::uint32_t operator()(const Block& block) noexcept {
    return kDatagramBytes + sample_bytes(compressor_.compress(block, kContractVersion, room_).size());
  }

 private:
  HeaderCompressor<Block> compressor_;
  std::array<std::uint8_t, kMost> room_{};
};
template <>
class WireCost<CommandBlock> : public BlockCost<CommandBlock, kMaxCommandBytes> {};
template <>
class WireCost<StateBlock> : public BlockCost<StateBlock, kMaxStateBytes> {};

}  // namespace telekerf
