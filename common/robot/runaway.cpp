// SPDX-License-Identifier: Apache-2.0
#include "common/robot/runaway.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>

namespace telekerf::robot {
namespace {

constexpr double kBeyondStroke_m = 0.1e-3;
constexpr double kSpeeds = 3.0;  ///< times what a joint is ever asked for
/// The sign: over the last milliseconds, with currents that change by this share of the peak.
constexpr double kSignFade_s = 0.012;
constexpr double kMinChange = 0.05;
constexpr double kAgainst = -0.9;  ///< correlation of acceleration and current
constexpr int kAgainstSteps = 5;
/// The swing: more than `most` changes of side, fading, between currents beyond `large` of the peak. Corners
/// and knocks make a few at a time; a loop that is unstable goes on.
struct Swing {
  double large;
  double fade_s;
  double most;
};
constexpr Swing kSwing[] = {{0.9, 0.05, 5.0}, {0.5, 0.3, 50.0}};

/// Farther outside than any overshoot.
double margin_m(double size_m) { return std::max(5e-3, 0.3 * size_m); }

/// Fastest that each joint has to be where the tool keeps its limit, anywhere in the workspace.
Vec3 joint_speeds(const RobotModel& model) {
  const DeltaKinematics kinematics(model.geometry);
  Vec3 most = Vec3::Zero();
  for (const double height : {-0.5, 0.0, 0.5}) {
    for (const double share : {0.0, 1.0}) {
      for (int k = 0; k < 12; ++k) {
        const double angle = k * std::numbers::pi / 6.0;
        const double radius_m = share * model.workspace.radius_m;
        const Vec3 tool_m = model.in_base(
            {radius_m * std::cos(angle), radius_m * std::sin(angle), height * model.workspace.height_m});
        const auto joints_m = kinematics.inverse(tool_m);
        if (!joints_m) continue;
        const auto maps = kinematics.inverse_jacobian(*joints_m, tool_m);
        if (!maps) continue;
        for (int i = 0; i < 3; ++i)
          most[i] = std::max(most[i], maps->row(i).norm() * model.limits.velocity_m_per_s);
      }
    }
  }
  return most;
}

}  // namespace

RunawayWatch::RunawayWatch(const RobotModel& model, double period_s, Pushed pushed)
    : stroke_min_m_(model.geometry.stroke_min_m - kBeyondStroke_m),
      stroke_max_m_(model.geometry.stroke_max_m + kBeyondStroke_m),
      radius_m_(model.workspace.radius_m),
      half_height_m_(0.5 * model.workspace.height_m),
      peak_a_(model.motor.peak_force_n / model.motor.force_constant_n_per_a),
      step_m_per_s2_(model.motor.peak_force_n / (model.motor.mass_kg + model.tool_mass_kg)),
      max_speed_m_per_s_(kSpeeds * joint_speeds(model)),
      period_s_(period_s),
      pushed_(pushed == Pushed::kYes) {
  joints_m_.fill(Vec3::Zero());
  currents_a_.fill(Vec3::Zero());
}

void RunawayWatch::trip(Cause cause, int joint, double value) noexcept {
  if (tripped()) return;
  cause_ = cause;
  joint_ = joint;
  value_ = value;
}

void RunawayWatch::written(const Vec3& currents_a) noexcept {
  currents_a_[written_++ % kSpan] = currents_a.cwiseMin(peak_a_).cwiseMax(-peak_a_);
  judge_swing();
}

void RunawayWatch::read(const JointReading& reading, std::uint64_t steps) noexcept {
  for (int i = 0; i < 3; ++i) {
    if (!std::isfinite(reading.joints_m[i])) return trip(Cause::kNotFinite, i, reading.joints_m[i]);
  }
  if (steps != 1) readings_ = 0;
  for (std::size_t n = kSpan; n > 0; --n) joints_m_[n] = joints_m_[n - 1];
  joints_m_[0] = reading.joints_m;
  ++readings_;
  if (!pushed_) judge_place(reading);
  if (readings_ <= kSpan) return;
  // Between the first two and the last two of six readings: the mean over the four steps between their
  // middles.
  const Vec3 change = joints_m_[0] - joints_m_[1] - joints_m_[kSpan - 1] + joints_m_[kSpan];
  judge_sign(change / (static_cast<double>(kSpan - 1) * period_s_ * period_s_));
}

void RunawayWatch::judge_place(const JointReading& reading) noexcept {
  for (int i = 0; i < 3; ++i) {
    const double joint_m = reading.joints_m[i];
    const bool within = joint_m >= stroke_min_m_ && joint_m <= stroke_max_m_;
    bool& was_within = within_stroke_[static_cast<std::size_t>(i)];
    if (!within && was_within) trip(Cause::kStroke, i, joint_m);
    was_within = was_within || within;
    if (readings_ <= kSpan) continue;
    const double speed =
        std::abs(joints_m_[0][i] - joints_m_[kSpan][i]) / (static_cast<double>(kSpan) * period_s_);
    if (speed > max_speed_m_per_s_[i]) trip(Cause::kSpeed, i, speed);
  }
}

void RunawayWatch::judge_sign(const Vec3& acceleration_m_per_s2) noexcept {
  const double keep = std::exp(-period_s_ / kSignFade_s);
  const bool judged = within_now_ || !pushed_;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto axis = static_cast<int>(i);
    double sum_a = 0.0;
    for (const Vec3& currents : currents_a_) sum_a += currents[axis];
    const double x = sum_a / (static_cast<double>(kSpan) * peak_a_);
    const double y = acceleration_m_per_s2[axis] / step_m_per_s2_;
    Moments& m = moments_[i];
    m.x = keep * m.x + (1.0 - keep) * x;
    m.y = keep * m.y + (1.0 - keep) * y;
    m.xx = keep * m.xx + (1.0 - keep) * x * x;
    m.yy = keep * m.yy + (1.0 - keep) * y * y;
    m.xy = keep * m.xy + (1.0 - keep) * x * y;
    const double var_x = m.xx - m.x * m.x;
    const double var_y = m.yy - m.y * m.y;
    const double cov = m.xy - m.x * m.y;
    const bool against =
        var_x > kMinChange * kMinChange && var_y > 0.04 * var_x && cov < kAgainst * std::sqrt(var_x * var_y);
    against_[i] = against && judged ? against_[i] + 1 : 0;
    if (against_[i] >= kAgainstSteps) trip(Cause::kSign, axis, cov / var_x);
  }
}

void RunawayWatch::judge_swing() noexcept {
  const Vec3& newest_a = currents_a_[(written_ - 1) % kSpan];
  for (std::size_t kind = 0; kind < std::size(kSwing); ++kind) {
    const auto& [large, fade_s, most] = kSwing[kind];
    const double keep = std::exp(-period_s_ / fade_s);
    for (std::size_t i = 0; i < 3; ++i) {
      auto& [side, count] = swings_[kind][i];
      const double share = newest_a[static_cast<int>(i)] / peak_a_;
      count *= keep;
      if (std::abs(share) < large) continue;
      const int now = share > 0.0 ? 1 : -1;
      if (now == -side) count += 1.0;
      side = now;
      if (count > most && (within_now_ || !pushed_)) trip(Cause::kSwing, static_cast<int>(i), count);
    }
  }
}

void RunawayWatch::at(const Vec3& tool_m) noexcept {
  const double radius_m = tool_m.head<2>().norm();
  const double height_m = std::abs(tool_m.z());
  const bool near =
      radius_m <= radius_m_ + margin_m(radius_m_) && height_m <= half_height_m_ + margin_m(half_height_m_);
  within_now_ = radius_m <= radius_m_ && height_m <= half_height_m_;
  if (!near && within_workspace_ && !pushed_) trip(Cause::kWorkspace, 0, std::max(radius_m, height_m));
  within_workspace_ = within_workspace_ || within_now_;
}

void RunawayWatch::doubted(const Doubt& doubt) noexcept {
  if (doubt)
    trip(doubt.kind == Doubt::Kind::kReading ? Cause::kReading : Cause::kForce, doubt.joint, doubt.value);
}

std::string RunawayWatch::sentence() const {
  constexpr const char* kModel = "is the robot file this robot's, and its force's sign right?";
  switch (cause_) {
    case Cause::kNone:
      return "nothing happened";
    case Cause::kSign:
      return fmt::format(
          "joint {} moves against its force; is the sign of its current right, and its sensor's?",
          joint_ + 1);
    case Cause::kSwing:
      return fmt::format(
          "the current of joint {} swings from side to side; is the drive later than the robot file's "
          "drive_delay_s says, or a bandwidth too high?",
          joint_ + 1);
    case Cause::kStroke:
      return fmt::format("joint {} is at {:.1f} mm, beyond its stroke; {}", joint_ + 1, value_ * 1e3, kModel);
    case Cause::kSpeed:
      return fmt::format("joint {} moves at {:.2f} m/s, faster than it is ever asked to; {}", joint_ + 1,
                         value_, kModel);
    case Cause::kWorkspace:
      return fmt::format("the tool is {:.1f} mm from the workspace's centre, far outside; {}", value_ * 1e3,
                         kModel);
    case Cause::kReading:
      return fmt::format(
          "the reading of joint {} is {:.3f} mm off where its currents have moved it; does its sensor slip, "
          "is "
          "the drive later than the robot file's drive_delay_s says, or the file not this robot's?",
          joint_ + 1, value_ * 1e3);
    case Cause::kForce:
      return fmt::format(
          "joint {} seems to be held or pushed with {:.1f} m/s^2 that neither its motor nor the robot file "
          "explains; does its sensor stick, does the tool touch something, is the drive later than the robot "
          "file's drive_delay_s says?",
          joint_ + 1, std::abs(value_));
    case Cause::kNotFinite:
      return fmt::format(
          "joint {} is read at {} m, which is no place; is its sensor connected, its drive sound?",
          joint_ + 1, value_);
  }
  return "unknown";
}

}  // namespace telekerf::robot
