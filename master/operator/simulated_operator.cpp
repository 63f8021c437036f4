// SPDX-License-Identifier: Apache-2.0
#include "master/operator/simulated_operator.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace telekerf::master {

SimulatedOperator::SimulatedOperator(const geometry::Polyline& curve_m,
                                     const SimulatedOperatorSettings& settings, std::uint64_t seed)
    : settings_(settings), curve_(curve_m), random_(seed * 0x9e3779b97f4a7c15ULL + 1) {}

double SimulatedOperator::uniform() noexcept {
  // splitmix64 (Steele, Lea, Flood 2014): the same numbers with every library.
  random_ += 0x9e3779b97f4a7c15ULL;
  std::uint64_t z = random_;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
  return static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1.0p-53;
}

double SimulatedOperator::normal() noexcept {
  const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform()));
  return radius * std::cos(2.0 * std::numbers::pi * uniform());
}

void SimulatedOperator::choose_button(double now_s) noexcept {
  if (now_s < button_until_s_) return;
  // Alternate presses of 1 to 3 s and pauses that make up the rest of the share.
  button_ = !button_;
  const double press_s = 1.0 + 2.0 * uniform();
  const double pause_share = (1.0 - settings_.press_share) / std::max(settings_.press_share, 0.05);
  button_until_s_ = now_s + (button_ ? press_s : press_s * pause_share);
}

HandSample SimulatedOperator::sample(double now_s, const Vec3& tool_m, const Vec3& velocity_m_per_s,
                                     bool guided) noexcept {
  const double dt_s = last_s_ ? now_s - *last_s_ : 0.0;
  last_s_ = now_s;
  if (!guided) {
    goal_arc_m_.reset();
    return {};
  }
  const Vec2 tool = tool_m.head<2>();
  if (!goal_arc_m_) {
    place_ = curve_.find(tool);
    goal_arc_m_ = place_.arc_length_m;
    guided_since_s_ = now_s;
    button_ = false;
    button_until_s_ = now_s + 0.3;
  }
  choose_button(now_s);

  // First-order Gauss-Markov processes: pace over seconds, sideways push over a third of a second.
  const double pace_memory = std::exp(-dt_s / 1.5);
  pace_ = 1.0 + pace_memory * (pace_ - 1.0) + 0.3 * std::sqrt(1.0 - pace_memory * pace_memory) * normal();
  const double push_memory = std::exp(-dt_s / 0.35);
  const double wander_n = settings_.wander_n.value_or(2.0 / 3.0 * settings_.max_sideways_n);
  sideways_n_ = push_memory * sideways_n_ + wander_n * std::sqrt(1.0 - push_memory * push_memory) * normal();
  tremor_phase_rad_ += 2.0 * std::numbers::pi * 9.0 * dt_s;

  *goal_arc_m_ += way_ * settings_.speed_m_per_s * std::clamp(pace_, 0.2, 1.8) * dt_s;
  // The eye stays with the pen: where the pen hangs back, the hand waits for it instead of pulling ever
  // harder.
  place_ = curve_.find_near(tool, place_.segment);
  if (!curve_.line().closed) {
    constexpr double kAtEnd_m = 20e-6;
    const double room_m = way_ > 0.0 ? curve_.length_m() - place_.arc_length_m : place_.arc_length_m;
    if (room_m < kAtEnd_m) {
      way_ = -way_;
      *goal_arc_m_ = place_.arc_length_m;
    }
  }
  double lead_m = *goal_arc_m_ - place_.arc_length_m;
  if (curve_.line().closed) lead_m -= curve_.length_m() * std::round(lead_m / curve_.length_m());
  lead_m = std::clamp(lead_m, -settings_.lead_m, settings_.lead_m);
  *goal_arc_m_ = place_.arc_length_m + lead_m;
  const geometry::Nearest goal = curve_.at(*goal_arc_m_);
  // The eye leads the arm round corners: it pulls along the curve at the pen, and sidewards as far as the
  // goal lies there. Its force stays what a wrist gives.
  constexpr double kMaxPull = 4.0;
  const Vec2& ahead = place_.tangent;
  const Vec2 to_goal = goal.point_m - tool;
  Vec2 pull =
      settings_.stiffness_n_per_m * (lead_m * ahead + to_goal - ahead.dot(to_goal) * ahead) +
      settings_.damping_n_s_per_m * (way_ * settings_.speed_m_per_s * ahead - velocity_m_per_s.head<2>());
  if (pull.norm() > kMaxPull) pull *= kMaxPull / pull.norm();
  const Vec2 left(-ahead.y(), ahead.x());
  const double push = std::clamp(sideways_n_ + settings_.tremor_n * std::sin(tremor_phase_rad_),
                                 -settings_.max_sideways_n, settings_.max_sideways_n);
  HandSample hand;
  hand.force_n.head<2>() = pull + push * left;
  hand.force_n.z() = 0.2 * push;  // a hand never pushes quite level
  hand.force_n = disturbed(settings_.disturbances, now_s - guided_since_s_, place_.tangent, hand.force_n);
  hand.trigger = button_;
  return hand;
}

}  // namespace telekerf::master
