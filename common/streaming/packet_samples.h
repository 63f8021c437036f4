// SPDX-License-Identifier: Apache-2.0
// A decoded packet's samples in one row: the newest block, and before it the copies of older ones.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "common/codec/decoder.h"

namespace telekerf::streaming {

/// By stream index. Valid as long as the packet is.
class PacketSamples {
 public:
  /// `first`: index of the newest block's first sample.
  PacketSamples(const codec::DecodedPacket& packet, std::int64_t first) noexcept
      : packet_(&packet), first_(first) {}

  std::int64_t oldest() const noexcept { return first_ - std::int64_t{packet_->blocks - 1} * size(); }
  std::int64_t first() const noexcept { return first_; }
  std::int64_t last() const noexcept { return first_ + size() - 1; }
  std::int64_t size() const noexcept { return packet_->block_size; }

  /// By how many blocks the one with sample `index` is older than the newest.
  int age(std::int64_t index) const noexcept { return static_cast<int>((last() - index) / size()); }
  /// Of that block; `offset` is the sample's place in it.
  std::span<const Vec3> block(std::int64_t index) const noexcept { return part(index).samples; }
  std::size_t offset(std::int64_t index) const noexcept {
    return static_cast<std::size_t>(index - first_ + age(index) * size());
  }
  const Vec3& at(std::int64_t index) const noexcept { return block(index)[offset(index)]; }
  bool button(std::int64_t index) const noexcept { return ((part(index).button >> offset(index)) & 1U) != 0; }

 private:
  const codec::DecodedBlock& part(std::int64_t index) const noexcept {
    return packet_->blocks_newest_first[static_cast<std::size_t>(age(index))];
  }

  const codec::DecodedPacket* packet_;
  std::int64_t first_;
};

}  // namespace telekerf::streaming
