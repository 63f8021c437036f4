// SPDX-License-Identifier: Apache-2.0
#include "slave/machining/job.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <set>

#include "common/geometry/cutting_order.h"
#include "common/geometry/kerf.h"
#include "common/geometry/minimum_jerk.h"

namespace telekerf::machining {
namespace {

/// References under construction; moves are straight, at rest at both ends, of least jerk.
class Writer {
 public:
  Writer(const JobSettings& settings, const Vec3& home_m)
      : settings_(settings), period_s_(1.0 / settings.plan.control_hz), here_m_(home_m) {
    wait(period_s_, JobPhase::kApproach);
  }

  void wait(double time_s, JobPhase phase) {
    Reference rest;
    rest.position_m = here_m_;
    const auto ticks = static_cast<std::size_t>(std::ceil(time_s / period_s_));
    for (std::size_t i = 0; i < ticks; ++i) push(rest, phase);
  }

  void move(const Vec3& to_m, JobPhase phase) {
    const Vec3 way = to_m - here_m_;
    const double length = way.norm();
    if (!(length > 1e-9)) return;
    const TimedPathSettings& most = settings_.plan;
    const double time_s = std::max(
        geometry::kMinimumJerkPeakRate * length / std::min(settings_.travel_m_per_s, most.max_speed_m_per_s),
        std::sqrt(geometry::kMinimumJerkPeakRate2 * length /
                  std::min(settings_.travel_m_per_s2, most.max_acceleration_m_per_s2)));
    const auto ticks = static_cast<std::size_t>(std::ceil(time_s / period_s_));
    const double whole_s = static_cast<double>(ticks) * period_s_;
    for (std::size_t i = 1; i <= ticks; ++i) {
      const double u = static_cast<double>(i) / static_cast<double>(ticks);
      Reference r;
      const geometry::MinimumJerk motion = geometry::minimum_jerk(u);
      r.position_m = here_m_ + motion.place * way;
      r.tangent = way / length;
      r.speed_m_per_s = motion.rate * length / whole_s;
      r.speed_rate_m_per_s2 = motion.rate2 * length / (whole_s * whole_s);
      r.velocity_m_per_s = r.speed_m_per_s * r.tangent;
      r.acceleration_m_per_s2 = r.speed_rate_m_per_s2 * r.tangent;
      push(r, phase);
    }
    here_m_ = to_m;
  }

  void follow(const Trajectory& trajectory) {
    for (std::size_t i = 0; i < trajectory.size(); ++i) push(trajectory[i], JobPhase::kCut);
    here_m_ = trajectory[trajectory.size() - 1].position_m;
  }

  void follow(const Job& job) {
    for (std::size_t i = 0; i < job.trajectory.size(); ++i) push(job.trajectory[i], job.phases[i]);
  }

  std::vector<Reference> points;
  std::vector<JobPhase> phases;

 private:
  void push(const Reference& reference, JobPhase phase) {
    points.push_back(reference);
    phases.push_back(phase);
  }

  JobSettings settings_;
  double period_s_;
  Vec3 here_m_;
};

/// The contours' numbers in the order of the cuts.
tl::expected<std::vector<std::size_t>, std::string> order_of(const std::vector<geometry::Polyline>& contours,
                                                             const std::vector<double>& select,
                                                             const Vec2& home_m) {
  if (contours.empty()) return tl::unexpected<std::string>("there is no contour to machine");
  if (select.empty()) return geometry::cutting_order(contours, home_m).order;
  std::set<std::size_t> numbers;
  std::vector<geometry::Polyline> chosen;
  for (const double number : select) {
    if (number != std::floor(number) || number >= static_cast<double>(contours.size())) {
      return tl::unexpected(fmt::format("--select {:g}: there are the contours 0 to {}; --dry-run lists them",
                                        number, contours.size() - 1));
    }
    numbers.insert(static_cast<std::size_t>(number));
  }
  for (const std::size_t number : numbers) chosen.push_back(contours[number]);
  std::vector<std::size_t> out;
  for (const std::size_t which : geometry::cutting_order(chosen, home_m).order)
    out.push_back(*std::next(numbers.begin(), static_cast<std::ptrdiff_t>(which)));
  return out;
}

}  // namespace

tl::expected<Job, std::string> make_job(const std::vector<geometry::Polyline>& contours,
                                        const JobSettings& settings, const Vec3& home_m) {
  auto order = order_of(contours, settings.select, home_m.head<2>());
  if (!order) return tl::unexpected(order.error());
  const std::vector<bool> holes = geometry::holes(contours);
  std::vector<TimedPath> plans;
  std::vector<geometry::Polyline> lines;
  std::vector<std::string> warnings;
  std::vector<Vec2> all;
  double length_m = 0.0;
  for (const std::size_t which : *order) {
    auto line = geometry::compensated(contours[which], settings.kerf_m, holes[which]);
    if (!line) return tl::unexpected(fmt::format("contour {}: {}", which, line.error()));
    if (const std::string what = geometry::passed_by(contours[which], *line, settings.kerf_m); !what.empty())
      warnings.push_back(fmt::format("contour {}: {}", which, what));
    lines.push_back(std::move(*line));
    auto plan = make_timed_path(lines.back(), settings.plan);
    if (!plan) return tl::unexpected(fmt::format("contour {}: {}", which, plan.error()));
    length_m += plan->path.length_m();
    plans.push_back(std::move(*plan));
    all.insert(all.end(), lines.back().points_m.begin(), lines.back().points_m.end());
  }

  Writer writer(settings, home_m);
  if (settings.framing) {
    const geometry::Box box = geometry::bounding_box(all);
    const auto corner = [&](double x, double y) {
      const Vec2 place(x, y);
      const Vec2 near = place * std::min(1.0, settings.reach_m / std::max(place.norm(), 1e-9));
      return Vec3(near.x(), near.y(), home_m.z());
    };
    writer.move(corner(box.min.x(), box.min.y()), JobPhase::kApproach);
    writer.move(corner(box.max.x(), box.min.y()), JobPhase::kFraming);
    writer.move(corner(box.max.x(), box.max.y()), JobPhase::kFraming);
    writer.move(corner(box.min.x(), box.max.y()), JobPhase::kFraming);
    writer.move(corner(box.min.x(), box.min.y()), JobPhase::kFraming);
  }
  bool first = !settings.framing;
  for (const TimedPath& plan : plans) {
    writer.move(plan.trajectory[0].position_m, first ? JobPhase::kApproach : JobPhase::kTravel);
    writer.wait(settings.settle_s, JobPhase::kTravel);
    writer.follow(plan.trajectory);
    first = false;
  }
  writer.move(home_m, JobPhase::kReturn);
  return Job{Trajectory(std::move(writer.points)),
             std::move(writer.phases),
             std::move(*order),
             std::move(plans),
             std::move(lines),
             std::move(warnings),
             1.0 / settings.plan.control_hz,
             length_m};
}

Job approached_from(const Vec3& tool_m, const Job& job, const JobSettings& settings) {
  Writer writer(settings, tool_m);
  writer.move(job.trajectory[0].position_m, JobPhase::kApproach);
  writer.follow(job);
  Job whole = job;
  whole.trajectory = Trajectory(std::move(writer.points));
  whole.phases = std::move(writer.phases);
  return whole;
}

}  // namespace telekerf::machining
