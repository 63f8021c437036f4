// SPDX-License-Identifier: Apache-2.0
#include "master/engagement.h"

namespace telekerf::master {
namespace {

constexpr double kAligned_m = 2e-6;
/// A slave that has acknowledged no command for this long is released for that long; the time of one that waits
/// for late commands may stand for nearly as long.
constexpr double kUnacknowledged_s = 0.6;
constexpr double kReleaseHold_s = 0.2;
/// One that has acknowledged none since it was taken hold of: the first answer takes a round trip, and until
/// then what the slave says was due is no more than a count of its own steps.
constexpr double kUnanswered_s = 5.0;
/// Further from the goal than this, the slave is approached anew instead of pulled with all force.
constexpr double kLost_m = 2e-3;

}  // namespace

void Engagement::received(std::span<const streaming::SlaveSample> samples, bool ours) noexcept {
  if (samples.empty()) return;
  slave_m_ = samples.back().position_m;
  if (!ours) return;
  for (const streaming::SlaveSample& sample : samples) {
    if (sample.applied) {
      unacknowledged_ = 0;
      answered_ = answered_ || sample.index >= engaged_index_;
    } else if (sample.index > engaged_index_) {
      ++unacknowledged_;
    }
  }
}

Engagement::Phase Engagement::begin_block(std::int64_t index, bool wanted) noexcept {
  if (engaged_ && unacknowledged_ * period_s_ > (answered_ ? kUnacknowledged_s : kUnanswered_s)) {
    // It holds, for it was led astray or cut off: let go, and take hold of it again where it rests.
    released_until_ = index + static_cast<std::int64_t>(kReleaseHold_s / period_s_);
    unacknowledged_ = 0;
  }
  const bool was_engaged = engaged_;
  engaged_ = wanted && slave_m_.has_value() && index >= released_until_;
  if (!engaged_) return Phase::kApart;
  if (was_engaged) return Phase::kHolds;
  engaged_index_ = index;
  unacknowledged_ = 0;
  answered_ = false;
  return Phase::kBegins;
}

Engagement::Phase Engagement::begin_block_unaided(bool wanted) noexcept {
  const bool was_engaged = engaged_;
  engaged_ = wanted;
  if (!engaged_) return Phase::kApart;
  return was_engaged ? Phase::kHolds : Phase::kBegins;
}

void Engagement::approach(const KinematicState& from, const KinematicState& source) noexcept {
  approach_.start(from, source);
  starts_ = true;
}

KinematicState Engagement::goal(const KinematicState& source, const KinematicState& predicted) noexcept {
  KinematicState goal = approach_.apply(source, starts_ ? 0.0 : period_s_);
  starts_ = false;
  if (!((goal.position_m - predicted.position_m).norm() < kLost_m)) {
    approach_.start(predicted, source);
    goal = approach_.apply(source, 0.0);
  }
  return goal;
}

bool Engagement::aligned() const noexcept { return approach_.offset_m() < kAligned_m; }

}  // namespace telekerf::master
