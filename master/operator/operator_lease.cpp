// SPDX-License-Identifier: Apache-2.0
#include "master/operator/operator_lease.h"

#include <algorithm>

namespace telekerf::master {
namespace {

/// The fastest frame is forgotten this slowly, as clocks drift: 1 ms a second.
constexpr std::int64_t kForgetting = 1000;

}  // namespace

void OperatorLease::begin() noexcept {
  newest_ = 0;
  held_ = false;
  let_go_ = false;
  offset_ns_.reset();
}

bool OperatorLease::too_old(std::int64_t sent_ns, std::int64_t now_ns) noexcept {
  // Any sender's number may be in a frame: unsigned arithmetic has no overflow to speak of.
  const auto offset =
      static_cast<std::int64_t>(static_cast<std::uint64_t>(now_ns) - static_cast<std::uint64_t>(sent_ns));
  if (!offset_ns_) {
    offset_ns_ = offset;
  } else {
    offset_ns_ = std::min(*offset_ns_ + (now_ns - offset_at_ns_) / kForgetting, offset);
  }
  offset_at_ns_ = now_ns;
  return static_cast<std::uint64_t>(offset) - static_cast<std::uint64_t>(*offset_ns_) >
         static_cast<std::uint64_t>(kOldest_ns);
}

bool OperatorLease::hear(const LeasedFrame& frame, std::int64_t now_ns) noexcept {
  if (frame.sequence <= newest_) {
    ++counters_.overtaken;
    return false;
  }
  if (frame.sent_ns && too_old(*frame.sent_ns, now_ns)) {
    ++counters_.late;
    return false;
  }
  if (silent(now_ns)) let_go_ = false;
  newest_ = frame.sequence;
  heard_ns_ = now_ns;
  held_ = frame.held;
  let_go_ = let_go_ || !held_;
  ++counters_.taken;
  return true;
}

}  // namespace telekerf::master
