// SPDX-License-Identifier: Apache-2.0
#include "slave/reference_selector.h"

#include <algorithm>
#include <cmath>

namespace telekerf::slave {
namespace {

/// Where samples are missing the reference goes on at constant velocity this long, then it slows down to a
/// stop; where the stream's time stands it goes back to where it was led last, for that is where it will go
/// on.
constexpr double kCoast_s = 0.1;

/// A stop brakes with a share of the robot's largest acceleration: the rest is the control loop's, where the tool is
/// ahead, or lighter than its file says. The last of the speed goes exponentially.
constexpr double kBraking = 0.75, kRest_s = 2e-3, kStill_m_per_s = 1e-7;

}  // namespace

ReferenceSelector::ReferenceSelector(const robot::RobotModel& model,
                                     const control::BumplessTransferSettings& transfer, double dt_s,
                                     BareAccelerations bare, const FreshnessSettings& freshness)
    : radius_m_(model.workspace.radius_m),
      half_height_m_(0.5 * model.workspace.height_m),
      max_m_per_s_(model.limits.velocity_m_per_s),
      max_m_per_s2_(model.limits.acceleration_m_per_s2),
      dt_s_(dt_s),
      bare_(bare),
      follow_age_s_(freshness.follow_age_s),
      arming_(freshness, dt_s),
      transfer_(transfer) {}

void ReferenceSelector::rest_at(const Vec3& position_m) noexcept {
  reference_ = hold_ = KinematicState{.position_m = position_m};
}

Selected ReferenceSelector::step(const streaming::Played& played, const Circumstances& now) noexcept {
  arming_.step(played, now);
  const streaming::StreamSample* sample = played.sample;
  if (played.cursor && (sample == nullptr || sample->concealed) && mode_ == SlaveMode::kFollowing)
    ++missed_ticks_;

  Selected out;
  out.button = sample != nullptr && sample->button;
  const bool led = follows(played, now);
  auto applied = streaming::Applied::kNothing;
  if (led) applied = sample->concealed ? streaming::Applied::kConcealed : streaming::Applied::kSample;
  out.acknowledgement = log_.step(applied, played.index, played.begins);
  if (sample != nullptr) out.due_age_s = played.age_s.value_or(-1.0);
  if (led) {
    out.applied_tick = played.tick;
    out.age_s = played.age_s.value_or(-1.0);
  }

  transferred_ = false;
  const KinematicState source = led ? follow(played) : hold(out.acknowledgement.age, played.waits);
  reference_ = transfer_.apply(source, transferred_ ? 0.0 : dt_s_);
  clamp_to_workspace(reference_);
  if (led) led_m_ = reference_.position_m;
  out.reference = reference_;
  out.source_m = source.position_m;
  out.acceleration_m_per_s2 = source.acceleration_m_per_s2;
  const bool streamed = source_generation_ != 0;
  out.following = mode_ == SlaveMode::kFollowing && streamed;
  out.bare = streamed && source_law_ == Law::kRemoteAcceleration && bare_ == BareAccelerations::kObeyed;
  return out;
}

bool ReferenceSelector::follows(const streaming::Played& played, const Circumstances& now) noexcept {
  const streaming::StreamSample* sample = played.sample;
  if (sample != nullptr && !sample->engaged) tripped_ = false;
  if (now.stopped) {  // whatever the stream says
    mode_ = SlaveMode::kStopped;
    reason_ = HoldReason::kStopped;
    return false;
  }
  if (mode_ == SlaveMode::kStopped) mode_ = SlaveMode::kWaiting;
  if (sample != nullptr && sample->engaged) {
    reason_ = refusal(played);
    if (reason_ != HoldReason::kNone) {
      mode_ = SlaveMode::kHolding;
      return false;
    }
    const bool bare = sample->law == Law::kRemoteAcceleration;
    if (bare) tripped_ = tripped_ || !within_limits(played.state);
    const bool possible = !tripped_ && (bare || is_motion(played.state));
    if (!possible) reason_ = HoldReason::kLimits;
    mode_ = possible ? SlaveMode::kFollowing : SlaveMode::kHolding;
    return possible;
  }
  if (sample != nullptr) {
    mode_ = SlaveMode::kWaiting;
    reason_ = HoldReason::kNotEngaged;
  } else if (!played.fresh) {
    if (mode_ == SlaveMode::kFollowing) mode_ = SlaveMode::kHolding;
    reason_ = now.heard ? HoldReason::kSilent : HoldReason::kNoCommands;
  }
  return false;
}

HoldReason ReferenceSelector::refusal(const streaming::Played& played) noexcept {
  if (!played.age_s) return HoldReason::kClockWrong;
  if (*played.age_s > follow_age_s_) return HoldReason::kTooOld;
  return arming_.may_lead(played.sample->engage) ? HoldReason::kNone : HoldReason::kNeedsEngage;
}

KinematicState ReferenceSelector::brake() noexcept {
  hold_ = advanced(hold_, dt_s_);
  const double speed = hold_.velocity_m_per_s.norm();
  if (speed <= kStill_m_per_s) return hold_ = KinematicState{.position_m = hold_.position_m};
  // Straight on to rest; it acts in the step that comes, as a stream's does.
  const double rate = std::min(kBraking * max_m_per_s2_ / speed, 1.0 / std::max(kRest_s, dt_s_));
  hold_.acceleration_m_per_s2 = -rate * hold_.velocity_m_per_s;
  return hold_;
}

KinematicState ReferenceSelector::follow(const streaming::Played& played) noexcept {
  const streaming::StreamSample& sample = *played.sample;
  if (played.discontinuity) source_block_ = 0;
  const bool new_source = source_generation_ != sample.generation || source_law_ != sample.law;
  source_generation_ = sample.generation;
  source_law_ = sample.law;
  if (sample.law == Law::kRemoteAcceleration && bare_ == BareAccelerations::kIntegrated) {
    // Without a jump from where the reference stood; no anchor ever tells where the master thinks it is.
    integral_ = advanced(new_source ? reference_ : integral_, dt_s_);
    integral_.acceleration_m_per_s2 = sample.acceleration_m_per_s2;
    if (new_source) transfer_to(integral_);
    return integral_;
  }
  if (sample.law == Law::kRemoteAcceleration) {
    // The tool itself is the reference; nothing pulls it anywhere, the acceleration is all there is.
    if (new_source) transfer_to(played.state);
    return played.state;
  }
  // From one anchor to the next, over a corrected clock, after a gap: go on from where the reference is.
  const bool new_anchor = sample.law == Law::kAnchored && source_block_ != sample.block;
  const bool jumps = (played.state.position_m - source_m_).norm() > 2.0 * max_m_per_s_ * dt_s_;
  if (new_source || source_block_ == 0 || new_anchor || jumps) transfer_to(played.state);
  source_block_ = sample.block;
  source_m_ = played.state.position_m;
  return played.state;
}

KinematicState ReferenceSelector::hold(std::int64_t unled_steps, bool waits) noexcept {
  if (mode_ == SlaveMode::kStopped) {
    if (!stopping_) {
      hold_ = reference_;
      transfer_.start(reference_, reference_);
    }
    stopping_ = true;
    source_generation_ = 0;
    return brake();
  }
  stopping_ = false;
  if (mode_ == SlaveMode::kFollowing && !waits && static_cast<double>(unled_steps) * dt_s_ < kCoast_s) {
    const bool begins = source_generation_ != 0;
    if (begins) {
      hold_ = reference_;
      hold_.acceleration_m_per_s2.setZero();
      source_generation_ = 0;
    }
    hold_ = advanced(hold_, dt_s_);
    if (begins) transfer_to(hold_);
    return hold_;
  }
  if (source_generation_ != 0 || !hold_.velocity_m_per_s.isZero()) {
    hold_ = KinematicState{.position_m = waits ? led_m_ : reference_.position_m};
    source_generation_ = 0;
    transfer_to(hold_);
  }
  return hold_;
}

void ReferenceSelector::transfer_to(const KinematicState& source) noexcept {
  // What the reference would be now, had its source gone on.
  transfer_.start(advanced(reference_, dt_s_), source);
  transferred_ = true;
}

bool ReferenceSelector::within_limits(const KinematicState& state) const noexcept {
  const double speed = state.velocity_m_per_s.norm();
  Vec3 rest_m = state.position_m;
  if (speed > 0.0) {
    rest_m += (kCoast_s + transfer_.way_to_rest_m(speed) / speed) * state.velocity_m_per_s;
  }
  return rest_m.head<2>().norm() < radius_m_ && std::abs(rest_m.z()) < half_height_m_ && speed < max_m_per_s_;
}

bool ReferenceSelector::is_motion(const KinematicState& state) const noexcept {
  return state.velocity_m_per_s.norm() <= max_m_per_s_ && state.acceleration_m_per_s2.norm() <= max_m_per_s2_;
}

void ReferenceSelector::clamp_to_workspace(KinematicState& state) const noexcept {
  const double distance_m = state.position_m.head<2>().norm();
  if (distance_m > radius_m_) {
    const Vec2 outward = state.position_m.head<2>() / distance_m;
    state.position_m.head<2>() = radius_m_ * outward;
    const double speed = outward.dot(state.velocity_m_per_s.head<2>());
    if (speed > 0.0) state.velocity_m_per_s.head<2>() -= speed * outward;
    state.acceleration_m_per_s2.setZero();
  }
  if (std::abs(state.position_m.z()) > half_height_m_) {
    state.position_m.z() = std::clamp(state.position_m.z(), -half_height_m_, half_height_m_);
    state.velocity_m_per_s.z() = 0.0;
    state.acceleration_m_per_s2.z() = 0.0;
  }
}

}  // namespace telekerf::slave
