// SPDX-License-Identifier: Apache-2.0
// The bottleneck of a network: how fast its queue empties, at any time. Times are nanoseconds since the
// profile began.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <vector>

#include "netem/core/profile.h"

namespace telekerf::netem {

/// What it serves over time is known beforehand, so a packet's departure is known when it enters, whatever
/// the rate does until then.
class Bottleneck {
 public:
  static constexpr std::int64_t kNever = std::numeric_limits<std::int64_t>::max();

  explicit Bottleneck(const DirectionProfile& profile);

  /// A packet may have to wait.
  bool limits_at(std::int64_t ns) const noexcept {
    return opportunities_ != nullptr || (!rates_.empty() && rates_[rate_at(ns)].ns_per_byte > 0);
  }
  /// What leaves a queue that never runs empty over [from, to); infinite where there is no bottleneck.
  double served_bytes(std::int64_t from_ns, std::int64_t to_ns) const noexcept;
  /// When the last of `bytes` that wait at `from_ns` has left; kNever: the recorded rate ends before.
  std::int64_t served_at(std::int64_t from_ns, double bytes) const noexcept;

 private:
  struct Rate {
    std::int64_t from_ns;
    double ns_per_byte;  ///< 0: no bottleneck
  };
  std::size_t rate_at(std::int64_t ns) const noexcept;
  /// How many opportunities lie before `ns`.
  std::int64_t opportunities_before(std::int64_t ns) const noexcept;

  std::vector<Rate> rates_;  ///< ascending; empty: never one
  std::shared_ptr<const RateTrace> opportunities_;
  bool repeats_ = false;
};

}  // namespace telekerf::netem
