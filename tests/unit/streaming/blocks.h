// SPDX-License-Identifier: Apache-2.0
// Blocks of either stream whose samples tell their own index.
#pragma once

#include <cstdint>
#include <vector>

#include "common/codec/encoder.h"
#include "common/protocol/messages.h"

namespace telekerf::streaming {

constexpr int kBlock = 16;
constexpr std::int64_t kMs = 1'000'000;

inline Vec3 place(std::int64_t index) { return {1e-5 * static_cast<double>(index), -2e-3, 0.0}; }

/// Samples at 1 kHz in blocks of 16, with a copy of the block before.
template <class Block>
class Sender {
 public:
  explicit Sender(std::uint32_t epoch, std::uint32_t first_sequence = 1)
      : epoch_(epoch), next_(first_sequence) {}

  Block next() {
    Block block;
    block.epoch = epoch_;
    block.sequence = next_++;
    block.first_tick = static_cast<Tick>(index_);
    block.sample_period_ns = 1'000'000;
    block.contour_id = 4;
    std::vector<Vec3> samples(kBlock);
    for (Vec3& sample : samples) sample = place(index_++);
    block.payload.size =
        static_cast<std::uint16_t>(encoder_.encode(samples, button, {}, block.payload.room()).value_or(0));
    return block;
  }

  /// Of the next block's first sample.
  std::int64_t next_tick() const { return index_; }

  std::uint64_t button = 0;  ///< bit n: pressed at sample n of the blocks to come

 private:
  std::uint32_t epoch_;
  std::uint32_t next_;
  std::int64_t index_ = 0;
  codec::BlockEncoder encoder_{{.max_rms = 1e-7, .redundancy = 1}};
};

}  // namespace telekerf::streaming
