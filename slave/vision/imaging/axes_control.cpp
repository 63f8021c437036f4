// SPDX-License-Identifier: Apache-2.0
#include "slave/vision/imaging/axes_control.h"

#include <algorithm>
#include <cmath>

namespace telekerf::imaging {
namespace {

/// Beyond the play by this much an axis goes below a goal that it approaches from above.
constexpr double kOverTravel_m = 0.15e-3;
/// How far an axis goes off its switch, how fast, and how slowly it comes back.
constexpr double kBackOff_m = 0.2e-3;
constexpr double kBackOff_m_per_s = 4e-3;
constexpr double kCreep_m_per_s = 0.5e-3;
/// Periods between the readings on both sides of the edge: with them it is known to a micrometre.
constexpr int kEdgeApart = 2;

control::DisturbanceObserver::Gains gains_of(const AxesControlSettings& settings) {
  return {.period_s = settings.period_s,
          .bandwidth_rad_per_s = settings.observer_rad_per_s,
          .velocity_bandwidth_rad_per_s = settings.velocity_observer_rad_per_s,
          .loop_delay = settings.loop_delay};
}

}  // namespace

AxesControl::AxesControl(const AxesModel& model, const AxesControlSettings& settings) noexcept
    : model_(model), settings_(settings), observer_(gains_of(settings)) {}

double AxesControl::homing_m_per_s(const AxisModel& axis) noexcept {
  return std::min({kHoming_m_per_s, axis.speed_m_per_s, std::sqrt(axis.acceleration_m_per_s2 * kMargin_m)});
}

double AxesControl::longest_way_s(const AxesModel& model) noexcept {
  double longest_s = 0.0;
  for (const AxisModel& axis : model) longest_s = std::max(longest_s, axis.travel_m / homing_m_per_s(axis));
  return longest_s;
}

AxisPositions AxesControl::positions_m() const noexcept {
  return {position_m(kMagnification), position_m(kFocus)};
}

double AxesControl::velocity_m_per_s(std::size_t axis) const noexcept {
  return observer_.joint_velocity_m_per_s()[static_cast<Eigen::Index>(axis)];
}

void AxesControl::move_to(std::size_t axis, double position_m) noexcept {
  if (!std::isfinite(position_m)) return;
  goals_[axis].position_m = std::clamp(position_m, lowest_m(), highest_m(axis));
  goals_[axis].first_m.reset();
  goals_[axis].velocity_m_per_s.reset();
}

void AxesControl::approach(std::size_t axis, double position_m) noexcept {
  move_to(axis, position_m);
  Goal& goal = goals_[axis];
  if (goal.position_m < this->position_m(axis) - settings_.settled_m) {
    goal.first_m = std::max(lowest_m(), goal.position_m - model_[axis].backlash_m - kOverTravel_m);
  }
}

void AxesControl::drive(std::size_t axis, double velocity_m_per_s) noexcept {
  const double most = model_[axis].speed_m_per_s;
  goals_[axis].velocity_m_per_s =
      std::isfinite(velocity_m_per_s) ? std::clamp(velocity_m_per_s, -most, most) : 0.0;
}

bool AxesControl::near(std::size_t axis, double position_m) const noexcept {
  return std::abs(position_m - this->position_m(axis)) <= settings_.settled_m &&
         std::abs(velocity_m_per_s(axis)) <= settings_.settled_m_per_s;
}

bool AxesControl::settled(std::size_t axis) const noexcept {
  const Goal& goal = goals_[axis];
  return state_ == State::kReady && !goal.velocity_m_per_s && !goal.first_m && near(axis, goal.position_m);
}

double AxesControl::velocity_to(std::size_t axis, double position_m) const noexcept {
  const double way_m = position_m - this->position_m(axis);
  // Along a parabola of constant braking from afar, exponentially at the end, critically damped by C = 4 l.
  const double braking = std::sqrt(model_[axis].acceleration_m_per_s2 * std::abs(way_m));
  const double ending = 0.25 * settings_.convergence_rad_per_s * std::abs(way_m);
  return std::copysign(std::min({braking, ending, model_[axis].speed_m_per_s}), way_m);
}

double AxesControl::homing_velocity(std::size_t axis, const AxesReading& reading) noexcept {
  if (!reading.valid) return goals_[axis].reference_m_per_s;  // as it is going
  const double fastest = homing_m_per_s(model_[axis]);
  const double up = std::min(kBackOff_m_per_s, fastest);
  const double creep = -std::min(kCreep_m_per_s, fastest);
  const double encoder_m = reading.encoders_m[axis];
  const bool pressed = reading.at_lower_end[axis];
  switch (homing_[axis]) {
    case Homing::kSeek:
      if (!pressed) return -fastest;
      break;
    case Homing::kBackOff:
      if (pressed) break;
      if (encoder_m < last_m_[axis] + kBackOff_m) return up;
      homing_[axis] = Homing::kCreep;
      last_m_[axis] = encoder_m;
      return creep;
    case Homing::kCreep:
      if (pressed && apart_ > kEdgeApart) break;  // it was not seen when it closed: once more
      if (pressed) {
        zero_m_[axis] = 0.5 * (last_m_[axis] + encoder_m);
        homing_[axis] = Homing::kDone;
      }
      last_m_[axis] = encoder_m;
      return creep;
    case Homing::kDone:
      return 0.0;
  }
  homing_[axis] = Homing::kBackOff;
  last_m_[axis] = encoder_m;
  return up;
}

double AxesControl::wanted_velocity(std::size_t axis, const AxesReading& reading) noexcept {
  Goal& goal = goals_[axis];
  if (homing_[axis] != Homing::kDone) {
    const double velocity = homing_velocity(axis, reading);
    if (homing_[axis] != Homing::kDone) return velocity;
  }
  if (goal.velocity_m_per_s) {
    // No further than from where it can still brake before the end.
    const double wanted = *goal.velocity_m_per_s;
    const double room = velocity_to(axis, wanted < 0.0 ? lowest_m() : highest_m(axis));
    return wanted < 0.0 ? std::max(wanted, std::min(room, 0.0)) : std::min(wanted, std::max(room, 0.0));
  }
  if (goal.first_m && near(axis, *goal.first_m)) goal.first_m.reset();
  return velocity_to(axis, goal.first_m.value_or(goal.position_m));
}

bool AxesControl::is_news(const AxesReading& reading) const noexcept {
  return reading.valid && reading.tick != newest_tick_ &&
         std::all_of(reading.encoders_m.begin(), reading.encoders_m.end(),
                     [](double encoder_m) { return std::isfinite(encoder_m); });
}

void AxesControl::lose() noexcept {
  if (state_ == State::kLost) return;
  state_ = State::kLost;
  for (const std::size_t axis : kBothAxes) {
    if (goals_[axis].velocity_m_per_s) move_to(axis, position_m(axis));
    homing_[axis] = Homing::kSeek;
  }
}

void AxesControl::begin(const Vec3& encoders_m) noexcept {
  observer_.reset(encoders_m);
  for (Goal& goal : goals_) goal.reference_m_per_s = 0.0;
  started_ = true;
  if (state_ == State::kLost) state_ = State::kHoming;
}

PerAxis AxesControl::step(const AxesReading& given) noexcept {
  AxesReading reading = given;
  reading.valid = is_news(given);
  if (reading.valid) {
    newest_tick_ = reading.tick;
    apart_ = missing_ + 1;
    missing_ = 0;
  } else {
    missing_ = std::min(missing_ + 1, kMaxMissing + 1);
    if (missing_ > kMaxMissing) lose();
    if (missing_ > kMaxBridged) started_ = false;
    if (!started_) return {};
  }
  const Vec3 encoders_m(reading.encoders_m[0], reading.encoders_m[1], 0.0);
  if (!started_) begin(encoders_m);
  observer_.update(encoders_m, reading.valid);

  Vec3 force_n = Vec3::Zero();
  Vec3 mass_kg = Vec3::Ones();
  PerAxis currents_a{};
  for (const std::size_t i : kBothAxes) {
    Goal& goal = goals_[i];
    const AxisModel& axis = model_[i];
    // The reference's own acceleration is bounded, so that its derivative in eq. 161 is, too.
    const double most = axis.acceleration_m_per_s2 * settings_.period_s;
    const double change = std::clamp(wanted_velocity(i, reading) - goal.reference_m_per_s, -most, most);
    goal.reference_m_per_s += change;
    // Eq. 161: q''_des = q''_ref + C q'_ref - C q'.
    const double wanted = change / settings_.period_s +
                          settings_.convergence_rad_per_s * (goal.reference_m_per_s - velocity_m_per_s(i));
    const auto k = static_cast<Eigen::Index>(i);
    mass_kg[k] = axis.moving_mass_kg;
    force_n[k] = std::clamp(axis.moving_mass_kg * wanted + observer_.disturbance_n()[k], -axis.peak_force_n,
                            axis.peak_force_n);
    currents_a[i] = force_n[k] / axis.force_constant_n_per_a;
  }
  observer_.applied(force_n, mass_kg.asDiagonal());
  if (homing_[kMagnification] == Homing::kDone && homing_[kFocus] == Homing::kDone) state_ = State::kReady;
  return currents_a;
}

}  // namespace telekerf::imaging
