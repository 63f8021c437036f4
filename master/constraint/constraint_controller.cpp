// SPDX-License-Identifier: Apache-2.0
#include "master/constraint/constraint_controller.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/geometry/minimum_jerk.h"

namespace telekerf::master {

void ConstraintController::enter() noexcept {
  entering_ = true;
  generator_.reset();
}

void ConstraintController::set_mode(const ConstraintMode& mode) noexcept {
  const bool was_free = mode_.corridor_m > 0.0;
  const bool is_free = mode.corridor_m > 0.0;
  if (was_free && !is_free) entering_ = true;
  if (!was_free && is_free && !entering_) opened_s_ = 0.0;  // a tool that was held
  mode_ = mode;
}

void ConstraintController::begin_entry(const KinematicState& tool) noexcept {
  const geometry::CircleOrLine& shape = active_.piece.shape;
  const Vec2 x = tool.position_m.head<2>();
  const Vec2 v = tool.velocity_m_per_s.head<2>();
  entry_m_ = {active_.phi_m, tool.position_m.z()};
  entry_m_per_s_ = {shape.gradient(x).dot(v) + active_.drift_m_per_s, tool.velocity_m_per_s.z()};
  entered_s_ = 0.0;
  // What the law brings to rest within so little is left to it: it may be no more than noise of the measured
  // speed.
  constexpr double kLittle_m = 10e-6;
  const double run_m = entry_m_per_s_.cwiseAbs().maxCoeff() / (std::numbers::e * settings_.bandwidth_rad_s);
  if (entry_m_.cwiseAbs().maxCoeff() + run_m < kLittle_m) {
    entry_m_.setZero();
    entry_m_per_s_.setZero();
  }
  // A tool that is on its way outwards is brought to rest sooner, so that it does not go much farther; the
  // fade's fastest moment is 15/8 of its mean.
  constexpr double kFarther_m = 0.25e-3;
  constexpr double kLeast_s = 0.03;
  const double speed = std::max(entry_m_per_s_.cwiseAbs().maxCoeff(), 1e-6);
  const double farthest = entry_m_.cwiseAbs().maxCoeff();
  entry_duration_s_ = settings_.entry_s > 0.0
                          ? std::max({std::min(settings_.entry_s, kFarther_m / (0.184 * speed)),
                                      1.875 * farthest / settings_.return_m_per_s, kLeast_s})
                          : 0.0;
  // And one that is too fast for the bend is slowed down gently.
  faster_m_per_s_ = std::max(0.0, std::abs(shape.tangent(x).dot(v)) - active_.limit.m_per_s);
}

ConstraintReference ConstraintController::reference() const noexcept {
  ConstraintReference out;
  if (entered_s_ >= entry_duration_s_) return out;
  // Quintic from place and speed at entry to rest on the curve.
  const double t = entry_duration_s_;
  const double u = entered_s_ / t;
  const double u2 = u * u;
  const double u3 = u2 * u;
  const Vec2 run = t * entry_m_per_s_;
  out.place_m =
      (1.0 - u3 * (10.0 + u * (-15.0 + 6.0 * u))) * entry_m_ + (u + u3 * (-6.0 + u * (8.0 - 3.0 * u))) * run;
  out.velocity_m_per_s =
      (-30.0 * u2 * (1.0 - u) * (1.0 - u) * entry_m_ + (1.0 + u2 * (-18.0 + u * (32.0 - 15.0 * u))) * run) /
      t;
  out.acceleration_m_per_s2 =
      (-60.0 * u * (1.0 - u) * (1.0 - 2.0 * u) * entry_m_ + u * (-36.0 + u * (96.0 - 60.0 * u)) * run) /
      (t * t);
  return out;
}

// The observer leaves no friction, and between two counts of an encoder there is no speed to damp: a tool
// that nobody moves would creep. So it is held where it came to rest until a hand is felt.
Vec2 ConstraintController::hold_against_creep(const KinematicState& tool, const Vec3& hand_n) noexcept {
  constexpr double kRest_m_per_s = 1e-3;
  constexpr double kHold_rad_per_s = 40.0;
  const Vec2 x = tool.position_m.head<2>();
  const Vec2 along = active_.piece.shape.tangent(x);
  const double speed = along.dot(tool.velocity_m_per_s.head<2>());
  if (std::abs(along.dot(hand_n.head<2>())) > settings_.force_deadband_n || std::abs(speed) > kRest_m_per_s) {
    rest_m_.reset();
    return Vec2::Zero();
  }
  if (!rest_m_) rest_m_ = x;
  return (-kHold_rad_per_s * kHold_rad_per_s * along.dot(x - *rest_m_) - 2.0 * kHold_rad_per_s * speed) *
         along;
}

Vec3 ConstraintController::guided(const KinematicState& tool, const Vec3& hand_n,
                                  const ConstraintReference& reference, double dt_s,
                                  const CutInHand& cut) noexcept {
  const auto with = [&](double felt_n) {
    return guided_acceleration(active_, settings_, tool, hand_n, reference, felt_n);
  };
  if (!felt_.on()) return with(0.0);
  const Vec2 along = active_.piece.shape.tangent(tool.position_m.head<2>());
  const double speed = along.dot(tool.velocity_m_per_s.head<2>());
  const double wished_n = felt_.wished_n(speed, along.dot(hand_n.head<2>()), cut.beta, cut.wanted, dt_s);
  return with(
      felt_.step(wished_n, speed, settings_.damping_n_s_per_m, 0.5 * dt_s / settings_.mass_kg, dt_s,
                 [&](double felt_n) { return speed + 0.5 * dt_s * along.dot(with(felt_n).head<2>()); }));
}

Vec3 ConstraintController::step(const GuidePath& guide, const KinematicState& tool, const Vec3& hand_n,
                                double dt_s, bool cutting) noexcept {
  active_ = generator_.at(guide, tool.position_m.head<2>(), dt_s);
  if (entering_) {
    entering_ = false;
    begin_entry(tool);
  }
  const ConstraintReference reference = this->reference();
  entered_s_ += dt_s;
  correction_.setZero();
  if (mode_.corridor_m > 0.0) {
    rest_m_.reset();
    Vec3 free = region_acceleration(active_, settings_, mode_, tool, hand_n);
    if (opened_s_ >= settings_.entry_s) return free;
    // An opened corridor gives the hand its freedom gradually.
    opened_s_ += dt_s;
    const double u = std::min(opened_s_ / settings_.entry_s, 1.0);
    const double share = geometry::minimum_jerk(u).place;
    correction_ = (1.0 - share) * guiding_correction(active_, settings_, tool, reference);
    return (1.0 - share) * guided_acceleration(active_, settings_, tool, hand_n, reference) + share * free;
  }
  faster_m_per_s_ = std::max(0.0, faster_m_per_s_ - settings_.bend_m_per_s2 * dt_s);
  active_.limit.m_per_s += faster_m_per_s_;
  correction_ = guiding_correction(active_, settings_, tool, reference);
  Vec3 wanted = guided(tool, hand_n, reference, dt_s, {guide.beta, cutting});
  wanted.head<2>() += hold_against_creep(tool, hand_n);
  return wanted;
}

}  // namespace telekerf::master
