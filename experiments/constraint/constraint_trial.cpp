// SPDX-License-Identifier: Apache-2.0
#include "experiments/constraint/constraint_trial.h"
#include "common/robot/drivers/simulated_robot.h"

#include <cmath>
#include <limits>
#include <numbers>

namespace telekerf::experiments {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kHandoverSpeed = 0.03;

/// An arc from angle `from` through `sweep` about `centre`, without its last point.
void add_arc(std::vector<Vec2>& points, const Vec2& centre, double radius, double from, double sweep) {
  const int steps = std::max(8, static_cast<int>(std::abs(sweep) * radius / 20e-6));
  for (int i = 0; i < steps; ++i) {
    const double angle = from + sweep * i / steps;
    points.push_back(centre + radius * Vec2(std::cos(angle), std::sin(angle)));
  }
}

}  // namespace

Trial run_trial(const ContourMessage& contour, const TrialSettings& settings) {
  master::StationSettings chosen = settings.station;
  chosen.record_s = settings.duration_s + 1.0;
  master::Station station(chosen);
  const auto task = station.prepare(contour);
  master::ConstraintSettings wanted = chosen.node.constraint;
  wanted.period_s = station.control_period_s();
  wanted.bandwidth_rad_s = station.node().bandwidths().law_rad_per_s;
  const double dt = station.control_period_s();

  geometry::Polyline truth;
  truth.closed = contour.closed;
  for (const auto& point : contour.points_m) truth.points_m.push_back(point / chosen.beta);
  const geometry::NearestIndex curve(truth);

  Trial trial;
  trial.bandwidth_rad_s = station.node().bandwidths().law_rad_per_s;
  std::optional<master::ActiveConstraint> before;
  std::optional<double> guided_since;
  double squares = 0.0;
  std::size_t guided = 0;
  const auto steps = static_cast<std::int64_t>(settings.duration_s / dt);
  for (std::int64_t n = 0; n < steps; ++n) {
    const double now = static_cast<double>(n) * dt;
    if (settings.form && guided_since) {
      if (const auto form = settings.form(now - *guided_since)) station.set_constraint(*form);
    }
    const Vec3 true_tool = *station.machine().true_tool_m();  // as in the record: before the step moves it
    const auto out = station.step(std::llround(now * 1e9), task.get(), {}, {});
    const bool is_guided = out.mode == master::MasterMode::kGuiding;
    trial.off_m.push_back(std::numeric_limits<double>::quiet_NaN());
    trial.constraint_n.push_back(out.constraint_n);
    if (!is_guided) continue;
    if (!guided_since) guided_since = now;
    trial.saturated = trial.saturated || out.saturated;
    const control::KinematicState tool{out.tool_m, out.velocity_m_per_s, Vec3::Zero()};
    if (before && out.corridor_m <= 0.0 && out.velocity_m_per_s.head<2>().norm() <= kHandoverSpeed) {
      before->phi_m = before->piece.shape.phi(out.tool_m.head<2>());
      const Vec3 step = guided_acceleration(out.active, wanted, tool, out.hand_n) -
                        guided_acceleration(*before, wanted, tool, out.hand_n);
      trial.max_handover_m_per_s =
          std::max(trial.max_handover_m_per_s,
                   std::abs(step.head<2>().dot(out.active.piece.shape.gradient(out.tool_m.head<2>()))) * dt);
    }
    before = out.active;
    const geometry::Nearest nearest = curve.find(true_tool.head<2>());
    trial.off_m.back() = nearest.signed_distance_m;
    squares += nearest.distance_m * nearest.distance_m;
    trial.max_m = std::max(trial.max_m, nearest.distance_m);
    trial.travelled_m += out.velocity_m_per_s.head<2>().norm() * dt;
    ++guided;
  }
  if (guided > 0) {
    trial.rms_m = std::sqrt(squares / static_cast<double>(guided));
    trial.mean_speed_m_per_s = trial.travelled_m / (static_cast<double>(guided) * dt);
  }
  trial.broken = station.machine().plant()->broken();
  RunRecord record;
  station.report(record);
  trial.rows = std::move(record.master);
  return trial;
}

ContourMessage rounded_outline(double radius_m, double size_m) {
  // A plus sign: eight corners outwards, four inwards, every one of them an arc of the radius.
  ContourMessage contour;
  contour.id = 1;
  contour.source = "rounded";
  const double arm = 0.5 * size_m;
  const double waist = size_m / 6.0;
  auto& points = contour.points_m;
  for (int quarter = 0; quarter < 4; ++quarter) {
    std::vector<Vec2> part;
    add_arc(part, {arm - radius_m, -waist + radius_m}, radius_m, -kPi / 2, kPi / 2);
    add_arc(part, {arm - radius_m, waist - radius_m}, radius_m, 0.0, kPi / 2);
    add_arc(part, {waist + radius_m, waist + radius_m}, radius_m, -kPi / 2, -kPi / 2);
    const double c = std::cos(quarter * kPi / 2);
    const double s = std::sin(quarter * kPi / 2);
    for (const auto& p : part) points.emplace_back(c * p.x() - s * p.y(), s * p.x() + c * p.y());
  }
  return contour;
}

ContourMessage circle_outline(double radius_m) {
  ContourMessage contour;
  contour.id = 2;
  contour.source = "circle";
  add_arc(contour.points_m, Vec2::Zero(), radius_m, 0.0, 2 * kPi);
  return contour;
}

ContourMessage figure_eight_outline(double half_width_m) {
  ContourMessage contour;
  contour.id = 3;
  contour.source = "figure-8";
  constexpr int kPoints = 4000;
  for (int i = 0; i < kPoints; ++i) {
    const double t = 2 * kPi * i / kPoints;
    // Off the centre, so that a tool that comes from there does not start at the crossing.
    contour.points_m.emplace_back(half_width_m * std::sin(t), half_width_m * (0.5 * std::sin(2 * t) + 0.25));
  }
  return contour;
}

}  // namespace telekerf::experiments
