// SPDX-License-Identifier: Apache-2.0
// The head of every packet: all that a receiver must know of the stream, so that it needs no configuration.
#pragma once

#include <cstdint>
#include <span>

#include "common/codec/axis_bits.h"
#include "common/codec/errors.h"
#include "common/codec/settings.h"
#include "common/runtime/vectors.h"

#include <tl/expected.hpp>

namespace telekerf::codec {

inline constexpr int kAxes = 3;
inline constexpr std::uint8_t kPacketVersion = 3;
inline constexpr int kMaxBlocks = kMaxRedundancy + 1;

/// Straight line through the newest block: value at its first sample and change per sample, from the
/// message's anchor exactly as it stands on the wire. Streams that have none leave it zero and set `anchored
/// = false`.
struct Trend {
  Vec3 value = Vec3::Zero();
  Vec3 slope_per_sample = Vec3::Zero();
};

struct PacketHead {
  CodecKind kind = kSdct;
  int blocks = 1;      ///< in this packet
  int redundancy = 0;  ///< previous blocks that the sender repeats once it has them
  bool anchored = false;
  bool adaptive = false;
  bool integrated = false;  ///< the step grows with a coefficient's index (Grid::step_of)
  int block = 16;
  int axes = 3;
  int quantum_exponent = 0;  ///< finest step = 2^(this / 4)
  std::uint16_t sequence = 0;
  ContextModel model;
  std::uint32_t sample_period_ns = 0;
};

void write_head(BitWriter& out, const PacketHead& head) noexcept;
/// Overwrites the count of blocks in a packet that write_head() began.
void patch_blocks(std::span<std::uint8_t> packet, int blocks) noexcept;
[[nodiscard]] tl::expected<PacketHead, CodecError> read_head(BitReader& in) noexcept;

bool is_finite(const Trend& trend) noexcept;

}  // namespace telekerf::codec
