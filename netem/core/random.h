// SPDX-License-Identifier: Apache-2.0
// Counter-based random numbers: draw i of a stream is a pure function of (seed, flow, direction, impairment,
// i).
#pragma once

#include <cstdint>

#include "common/runtime/enum_table.h"

namespace telekerf::netem {

/// forward: operator -> slave; backward: slave -> operator.
enum class Direction : std::uint8_t { kForward = 0, kBackward = 1 };

inline constexpr EnumRow<Direction> kDirectionRows[] = {
    {"forward", Direction::kForward, "operator to slave"},
    {"backward", Direction::kBackward, "slave to operator"}};
inline constexpr EnumTable<Direction> kDirections{kDirectionRows};

/// Names one flow of packets in one direction. Flows never influence one another.
struct StreamKey {
  std::uint64_t seed = 1;
  std::uint64_t flow = 0;
  Direction direction = Direction::kForward;
};

/// Every impairment draws from its own stream: switching one on leaves the outcome that the others decide
/// unchanged.
enum class Impairment : std::uint64_t {
  kDelay = 1,
  kLoss,
  kLossState,
  kRetransmission,
  kDuplicate,
  kCorrupt,
  kCorruptedBit,
  kReorder,
  kEventDelay,
  kEventLoss,
  kSlot,
  kCoupledDelay,
};

/// A 64-bit permutation with full avalanche (the finaliser known as "moremur"); neighbouring counters give
/// unrelated outputs.
constexpr std::uint64_t mixed(std::uint64_t x) noexcept {
  x ^= x >> 27;
  x *= 0x3C79AC492BA7B653ULL;
  x ^= x >> 33;
  x *= 0x1C69B3F74AC4AE35ULL;
  x ^= x >> 27;
  return x;
}

class Stream {
 public:
  constexpr Stream(const StreamKey& key, Impairment impairment) noexcept {
    std::uint64_t k = mixed(key.seed + kWeyl);
    k = mixed(k ^ (key.flow + 2 * kWeyl));
    k = mixed(k ^ (static_cast<std::uint64_t>(key.direction) + 3 * kWeyl));
    offset_ = mixed(k ^ (static_cast<std::uint64_t>(impairment) + 4 * kWeyl));
    whitening_ = mixed(offset_ + 5 * kWeyl);
  }

  /// Uniform over all 64-bit words. Two keys: shifted counters of one stream never meet another stream.
  constexpr std::uint64_t draw(std::uint64_t counter) const noexcept {
    return mixed(mixed_once(counter * kWeyl + offset_) ^ whitening_);
  }

 private:
  static constexpr std::uint64_t kWeyl = 0x9E3779B97F4A7C15ULL;  // 2^64 / golden ratio, odd
  static constexpr std::uint64_t mixed_once(std::uint64_t x) noexcept {
    return (x ^ (x >> 32)) * 0xD6E8FEB86659FD93ULL;
  }

  std::uint64_t offset_ = 0;
  std::uint64_t whitening_ = 0;
};

/// A probability as an integer threshold, so that no rounding mode and no library can change a decision.
class Probability {
 public:
  constexpr Probability() noexcept = default;
  /// `probability` in [0, 1]; 0 never happens, 1 always.
  explicit constexpr Probability(double probability) noexcept
      : threshold_(static_cast<std::uint64_t>(probability * 9223372036854775808.0)) {}
  constexpr bool happens(std::uint64_t word) const noexcept { return (word >> 1) < threshold_; }
  constexpr bool possible() const noexcept { return threshold_ != 0; }

 private:
  std::uint64_t threshold_ = 0;  // out of 2^63
};

}  // namespace telekerf::netem
