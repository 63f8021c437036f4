// SPDX-License-Identifier: Apache-2.0
#include "master/constraint/constraint.h"

#include <algorithm>
#include <cmath>

#include "master/constraint/virtual_wall.h"

namespace telekerf::master {
namespace {

/// Farther than this from where the last circle says, the foot point is searched along the curve.
constexpr double kLost_m = 0.5e-3;
/// Share of a circle's radius nearer than which its centre is not approached: there phi has no gradient.
constexpr double kNearCentre = 0.5;
/// Faster than this no circle moves under the tool, but that the foot point jumps.
constexpr double kFastest_m_per_s = 0.05;

/// A tool far on the inner side of a bend would pass the centre and be held to the far side of the circle.
/// There a wider circle with the same foot point and tangent stands for the curve.
void flatten(GuidePiece& piece, const Vec2& tool_m) noexcept {
  const Vec2 along = piece.shape.tangent(piece.point_m);
  const double off = geometry::cross(along, tool_m - piece.point_m);
  const double bend = piece.shape.curvature();
  if (bend * off > 1.0 - kNearCentre)
    piece.shape = geometry::osculating(piece.point_m, along, (1.0 - kNearCentre) / off);
}

double without(double force, double dead) noexcept { return force - std::clamp(force, -dead, dead); }

/// Eq. 65 with a bound on the speed of return: near the curve it is e'' = -K2 e' - K1 e. K1 and K2 are those
/// of eq. 66-67 for a held acceleration: sampled poles exp(p T) of the poles p that were chosen. (The
/// continuous gains at 1 kHz decay a tenth too fast.)
double decaying(const ConstraintSettings& settings, double e, double e_rate) noexcept {
  const double t = settings.period_s;
  const double w = settings.bandwidth_rad_s;
  const double zeta = settings.damping;
  const double inner = w * t * std::sqrt(std::abs(zeta * zeta - 1.0));
  const double sum = 2.0 * std::exp(-zeta * w * t) * (zeta >= 1.0 ? std::cosh(inner) : std::cos(inner));
  const double product = std::exp(-2.0 * zeta * w * t);
  const double k1 = (1.0 - sum + product) / (t * t);
  const double k2 = (3.0 - sum - product) / (2.0 * t);
  return -k2 * (e_rate + std::clamp(k1 / k2 * e, -settings.return_m_per_s, settings.return_m_per_s));
}

double along_the_curve(const ActiveConstraint& active, const ConstraintSettings& settings, double pull,
                       double speed, bool hold_in_bends) noexcept {
  double a = (without(pull, settings.dead_force_n) - settings.drag_ns_per_m * speed) / settings.mass_kg;
  if (hold_in_bends) {
    // v' <= (limit - v) / tau on either way along the curve; the slope leads it into the bend.
    constexpr double kRate = 250.0;
    const double limit = active.limit.m_per_s;
    const double lead = active.limit.slope_per_s * speed;
    if (speed >= 0.0) {
      a = std::min(a, kRate * (limit - speed) + std::min(lead, 0.0));
    } else {
      a = std::max(a, kRate * (-limit - speed) - std::min(lead, 0.0));
    }
  }
  if (active.beyond_end_m != 0.0) {
    const double side = std::copysign(1.0, active.beyond_end_m);
    a = side * walled(side * a, side * active.beyond_end_m, side * speed, settings.wall_skin_m,
                      settings.end_bandwidth_rad_s);
  }
  return a;
}

}  // namespace

ActiveConstraint ConstraintGenerator::at(const GuidePath& guide, const Vec2& tool_m, double dt_s) noexcept {
  ActiveConstraint active;
  if (!last_) {
    active.piece = guide.at(guide.find(tool_m));
  } else {
    // One Newton step along the last circle: a tick moves the foot by micrometres.
    const geometry::CircleOrLine& shape = last_->shape;
    const double bend = 1.0 - shape.curvature() * shape.phi(tool_m);
    const double step = shape.tangent(tool_m).dot(tool_m - last_->point_m) / std::max(bend, kNearCentre);
    active.piece = guide.at(last_->arc_m + std::clamp(step, -kLost_m, kLost_m));
    const double left = active.piece.shape.tangent(tool_m).dot(tool_m - active.piece.point_m);
    const bool at_end =
        !guide.closed() && (active.piece.arc_m <= 0.0 || active.piece.arc_m >= guide.length_m());
    if (std::abs(left) > kLost_m && !at_end)
      active.piece = guide.at(guide.find_near(tool_m, active.piece.arc_m));
  }
  flatten(active.piece, tool_m);
  active.phi_m = active.piece.shape.phi(tool_m);
  if (last_ && dt_s > 0.0) {
    active.drift_m_per_s =
        std::clamp((active.phi_m - last_->shape.phi(tool_m)) / dt_s, -kFastest_m_per_s, kFastest_m_per_s);
  }
  last_ = active.piece;
  active.limit = guide.speed_limit(active.piece.arc_m);
  if (!guide.closed()) {
    const double past = active.piece.shape.tangent(tool_m).dot(tool_m - active.piece.point_m);
    const bool at_start = active.piece.arc_m <= 0.0;
    const bool at_end = active.piece.arc_m >= guide.length_m();
    if ((at_start && past < 0.0) || (at_end && past > 0.0)) active.beyond_end_m = past;
  }
  return active;
}

Vec3 guided_acceleration(const ActiveConstraint& active, const ConstraintSettings& settings,
                         const ToolState& tool, const ConstraintReference& reference) noexcept {
  const Vec2 x = tool.position_m.head<2>();
  const Vec2 v = tool.velocity_m_per_s.head<2>();
  // Rows of J_phi: the unit gradient in plane, and z. Its right inverse is its transpose.
  const geometry::CircleOrLine& shape = active.piece.shape;
  const Vec2 across = shape.gradient(x);
  const Vec2 along = shape.tangent(x);
  const double bend = v.dot(shape.hessian(x) * v);  // J_phi' x'
  const double rate = across.dot(v) + active.drift_m_per_s;
  const double a_across =
      reference.acceleration_m_per_s2[0] - bend +
      decaying(settings, active.phi_m - reference.place_m[0], rate - reference.velocity_m_per_s[0]);
  const double a_along =
      along_the_curve(active, settings, along.dot(tool.hand_n.head<2>()), along.dot(v), true);
  Vec3 wanted;
  wanted.head<2>() = a_across * across + a_along * along;
  wanted.z() = reference.acceleration_m_per_s2[1] +
               decaying(settings, tool.position_m.z() - reference.place_m[1],
                        tool.velocity_m_per_s.z() - reference.velocity_m_per_s[1]);
  return wanted;
}

Vec3 region_acceleration(const ActiveConstraint& active, const ConstraintSettings& settings,
                         const ConstraintMode& form, const ToolState& tool) noexcept {
  const Vec2 x = tool.position_m.head<2>();
  const Vec2 v = tool.velocity_m_per_s.head<2>();
  const Vec2 across = active.piece.shape.gradient(x);
  const Vec2 along = active.piece.shape.tangent(x);
  const double phi = active.phi_m;
  const double rate = across.dot(v) + active.drift_m_per_s;

  const double drag = settings.drag_ns_per_m + 2.0 * std::sqrt(form.stiffness_n_per_m * settings.mass_kg);
  const double push = without(across.dot(tool.hand_n.head<2>()), settings.dead_force_n);
  double a_across = (push - drag * across.dot(v) - form.stiffness_n_per_m * phi) / settings.mass_kg;
  const double side = std::copysign(1.0, phi);
  a_across = side * walled(side * a_across, side * phi - form.corridor_m, side * rate, settings.wall_skin_m,
                           settings.bandwidth_rad_s);
  const double a_along =
      along_the_curve(active, settings, along.dot(tool.hand_n.head<2>()), along.dot(v), false);
  Vec3 wanted;
  wanted.head<2>() = a_across * across + a_along * along;
  wanted.z() = decaying(settings, tool.position_m.z(), tool.velocity_m_per_s.z());
  return wanted;
}

void ConstraintController::enter() noexcept {
  entering_ = true;
  generator_.reset();
}

void ConstraintController::choose(const ConstraintMode& form) noexcept {
  const bool was_free = form_.corridor_m > 0.0;
  const bool is_free = form.corridor_m > 0.0;
  if (was_free && !is_free) entering_ = true;
  if (!was_free && is_free && !entering_) opened_s_ = 0.0;  // a tool that was held
  form_ = form;
}

void ConstraintController::begin_entry(const ToolState& tool) noexcept {
  const geometry::CircleOrLine& shape = active_.piece.shape;
  const Vec2 x = tool.position_m.head<2>();
  const Vec2 v = tool.velocity_m_per_s.head<2>();
  entry_m_ = {active_.phi_m, tool.position_m.z()};
  entry_m_per_s_ = {shape.gradient(x).dot(v) + active_.drift_m_per_s, tool.velocity_m_per_s.z()};
  entered_s_ = 0.0;
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
Vec2 ConstraintController::parked(const ToolState& tool) noexcept {
  constexpr double kRest = 1e-3;
  constexpr double kHold = 40.0;
  const Vec2 x = tool.position_m.head<2>();
  const Vec2 along = active_.piece.shape.tangent(x);
  const double speed = along.dot(tool.velocity_m_per_s.head<2>());
  if (std::abs(along.dot(tool.hand_n.head<2>())) > settings_.dead_force_n || std::abs(speed) > kRest) {
    parked_m_.reset();
    return Vec2::Zero();
  }
  if (!parked_m_) parked_m_ = x;
  return (-kHold * kHold * along.dot(x - *parked_m_) - 2.0 * kHold * speed) * along;
}

Vec3 ConstraintController::step(const GuidePath& guide, const ToolState& tool, double dt_s) noexcept {
  active_ = generator_.at(guide, tool.position_m.head<2>(), dt_s);
  if (entering_) {
    entering_ = false;
    begin_entry(tool);
  }
  const ConstraintReference reference = this->reference();
  entered_s_ += dt_s;
  if (form_.corridor_m > 0.0) {
    parked_m_.reset();
    Vec3 free = region_acceleration(active_, settings_, form_, tool);
    if (opened_s_ >= settings_.entry_s) return free;
    // An opened corridor gives the hand its freedom gradually.
    opened_s_ += dt_s;
    const double u = std::min(opened_s_ / settings_.entry_s, 1.0);
    const double share = u * u * u * (10.0 + u * (-15.0 + 6.0 * u));
    return (1.0 - share) * guided_acceleration(active_, settings_, tool, reference) + share * free;
  }
  faster_m_per_s_ = std::max(0.0, faster_m_per_s_ - settings_.bend_m_per_s2 * dt_s);
  active_.limit.m_per_s += faster_m_per_s_;
  Vec3 wanted = guided_acceleration(active_, settings_, tool, reference);
  wanted.head<2>() += parked(tool);
  return wanted;
}

}  // namespace telekerf::master
