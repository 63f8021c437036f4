// SPDX-License-Identifier: Apache-2.0
#include "master/modes.h"

#include <algorithm>

#include "common/geometry/minimum_jerk.h"

namespace telekerf::master {
namespace {

/// To come to rest after the planned motion.
constexpr double kRest_s = 0.5;
constexpr double kShortest_s = 0.5;

}  // namespace

bool Modes::step(const Situation& now) noexcept {
  engage_spent_ = now.stopped;
  if (now.stopped != (mode_ == MasterMode::kStopped)) {
    mode_ = now.stopped ? MasterMode::kStopped : MasterMode::kIdle;
    hold_m_ = now.tool_m;
  }
  if (mode_ == MasterMode::kStopped) {
    guide_ = now.guide;  // the one before may be gone by the next step
    return false;
  }
  if (now.guide != guide_ && guide_ != nullptr) engage_spent_ = true;
  if (now.guide != guide_ || (mode_ == MasterMode::kIdle && now.guide != nullptr)) {
    guide_ = now.guide;
    if (guide_ != nullptr) {
      begin_approach(now.tool_m);
    } else {
      if (mode_ != MasterMode::kIdle) hold_m_ = now.tool_m;
      mode_ = MasterMode::kIdle;
    }
    return true;
  }
  switch (mode_) {
    case MasterMode::kApproach:
      if (approach_s_ > approach_duration_s_ + kRest_s) mode_ = MasterMode::kGuiding;
      break;
    case MasterMode::kGuiding:
      if (now.engage && now.slave_ready) mode_ = MasterMode::kEngaged;
      break;
    case MasterMode::kEngaged:
      if (!now.engage || !now.slave_ready) {
        mode_ = MasterMode::kGuiding;
        engage_spent_ = true;
      }
      break;
    case MasterMode::kIdle:
    case MasterMode::kStopped:
      break;
  }
  return false;
}

void Modes::begin_approach(const Vec3& tool_m) noexcept {
  // To the nearest point of the curve and the working plane, along a straight line.
  const Vec2 goal = guide_->curve.find(tool_m.head<2>()).point_m;
  approach_from_m_ = tool_m;
  approach_to_m_ = Vec3(goal.x(), goal.y(), 0.0);
  approach_s_ = 0.0;
  approach_duration_s_ =
      std::max(kShortest_s, (approach_to_m_ - approach_from_m_).norm() / approach_m_per_s_);
  mode_ = MasterMode::kApproach;
}

KinematicState Modes::goal() noexcept {
  if (mode_ == MasterMode::kApproach) return approach();
  return {.position_m = hold_m_};
}

KinematicState Modes::approach() noexcept {
  approach_s_ += dt_s_;
  const double duration = approach_duration_s_;
  const double u = std::min(approach_s_ / duration, 1.0);
  const Vec3 way = approach_to_m_ - approach_from_m_;
  const geometry::MinimumJerk motion = geometry::minimum_jerk(u);
  const double speed = motion.rate / duration;
  const double acceleration = motion.rate2 / (duration * duration);
  return {approach_from_m_ + motion.place * way, speed * way, acceleration * way};
}

}  // namespace telekerf::master
