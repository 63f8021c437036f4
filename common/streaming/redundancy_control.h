// SPDX-License-Identifier: Apache-2.0
// How many earlier blocks each packet repeats. A burst of losses that the copies cover leaves nothing behind,
// so the longest burst decides, not the mean loss: of the commands it shows as a gap in what the slave
// acknowledges, of the states by their numbers. A link that loses nothing keeps the fewest copies.
#pragma once

#include <cstdint>
#include <span>

#include "common/codec/settings.h"
#include "common/streaming/slave_sample.h"

namespace telekerf::streaming {

/// Commands in a row that the slave never applied.
struct Gap {
  std::int64_t before = -1;  ///< index of the last one that it did apply
  std::int64_t after = -1;   ///< and of the next one
  int samples = 0;           ///< steps between; 0: there was none
};

/// Finds gaps in what the state stream acknowledges. No allocation, lock or throw.
class GapFinder {
 public:
  /// In the order of the slave's clock. `engaged_from`: index of the first command that is to be followed;
  /// what was not applied before one of these was is no gap.
  void received(std::span<const SlaveSample> samples, std::int64_t engaged_from) noexcept;
  /// The longest one that has ended since the last call.
  Gap take() noexcept;

 private:
  std::int64_t time_ = -1;   ///< of the newest sample, in the slave's count
  std::int64_t index_ = -1;  ///< newest command applied
  int unapplied_ = 0;        ///< samples since
  Gap longest_;
};

/// Finds bursts of losses in a stream's numbers. No allocation, lock or throw.
class BurstFinder {
 public:
  /// Every block, whatever its order. `begins`: of another sender.
  void received(std::uint32_t number, bool begins) noexcept;
  /// Blocks in the longest burst that has ended since the last call.
  int take() noexcept;

 private:
  bool heard_ = false;
  std::uint32_t newest_ = 0;
  std::uint64_t came_ = ~std::uint64_t{0};  ///< bit n: so did the block of number newest - n
  int missing_ = 0;
  int longest_ = 0;
};

struct RedundancySettings {
  int min = 1;  ///< copies on a link that leaves no gaps
  int max = codec::kMaxRedundancy;
  double hold_s = 30.0;  ///< without a burst that asks for as many, until one less will do
};

/// What happened since the last block.
struct Losses {
  Gap commands;
  int states = 0;  ///< blocks in a row
};

/// Which block is made.
struct BlockPlace {
  std::int64_t index = 0;  ///< of its first sample
  int samples = 16;
  double duration_s = 16e-3;
};

/// A value: the copies in force and what they were chosen by.
class RedundancyControl {
 public:
  explicit RedundancyControl(const RedundancySettings& settings) noexcept
      : settings_(settings), copies_(settings.min), carried_(settings.min) {}

  /// Every block, once. Returns the copies that its packet is to carry.
  int step(const Losses& losses, const BlockPlace& block) noexcept;

 private:
  RedundancySettings settings_;
  int copies_;
  int carried_;                  ///< by the packets before `raised_at_`
  std::int64_t raised_at_ = -1;  ///< index from which there are more of them
  double quiet_s_ = 0.0;
};

}  // namespace telekerf::streaming
