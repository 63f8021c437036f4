// SPDX-License-Identifier: Apache-2.0
#include "common/geometry/curve_sampling.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace telekerf::geometry {
namespace {

/// Position along a line while it is walked forwards, once round at most.
struct Walker {
  const Polyline& line;
  std::vector<double> arc;
  std::size_t segment = 0;
  double along_m = 0.0;  ///< within the segment

  explicit Walker(const Polyline& l) : line(l), arc(arc_lengths(l)) {}
  double travelled() const { return arc[segment] + along_m; }
  double segment_length() const { return arc[segment + 1] - arc[segment]; }
  Vec2 direction() const { return (line.end_of(segment) - line.start_of(segment)) / segment_length(); }
  Vec2 position() const {
    return segment_length() > 0.0 ? Vec2(line.start_of(segment) + along_m * direction())
                                  : line.start_of(segment);
  }

  /// Moves on to the first point at chord r; false at the end.
  bool chord(double r) {
    const Vec2 from = position();
    for (std::size_t i = segment; i < line.segments(); ++i) {
      if ((line.end_of(i) - from).norm() < r) continue;
      const double length = arc[i + 1] - arc[i];
      if (!(length > 0.0)) continue;
      // |a + u d - from| = r has exactly one root ahead: inside at the start, outside at the end, convex
      // between.
      const Vec2 d = (line.end_of(i) - line.start_of(i)) / length;
      const Vec2 a = line.start_of(i) + (i == segment ? along_m : 0.0) * d - from;
      const double b = a.dot(d);
      const double c = a.squaredNorm() - r * r;
      const double root = std::sqrt(std::max(0.0, b * b - c));
      const double u = b > 0.0 ? -c / (b + root) : root - b;  // without cancellation
      along_m = std::min(length, (i == segment ? along_m : 0.0) + u);
      segment = i;
      return true;
    }
    return false;
  }

  bool arc_step(double r) {
    const double target = travelled() + r;
    if (target > arc.back()) return false;
    while (segment + 1 < line.segments() && arc[segment + 1] < target) ++segment;
    along_m = std::min(target - arc[segment], segment_length());
    return true;
  }
};

tl::expected<Steps, std::string> steps_along(const Polyline& line, const SpeedLaw& speed,
                                             const StepSettings& settings, double scale, bool chords,
                                             double* remainder_m = nullptr) {
  if (line.segments() == 0 || !(length_m(line) > 0.0))
    return tl::unexpected<std::string>("the path has no length");
  if (!all_finite(line.points_m))
    return tl::unexpected<std::string>("a coordinate of the path is not finite");
  if (!(settings.period_s > 0.0)) return tl::unexpected<std::string>("the sampling period must be positive");
  Walker walker(line);
  Steps out;
  out.speed_scale = scale;
  out.points_m.push_back(line.points_m.front());
  out.arc_lengths_m.push_back(0.0);
  double last_step = 0.0;
  while (true) {
    if (out.points_m.size() > settings.max_steps) {
      return tl::unexpected(fmt::format("the path needs more than {} steps; go faster or sample more slowly",
                                        settings.max_steps));
    }
    const double time_s = static_cast<double>(out.points_m.size() - 1) * settings.period_s;
    const double v = speed(time_s, walker.travelled());
    if (!(v > 0.0) || !std::isfinite(v)) {
      return tl::unexpected(fmt::format("the speed {} m/s at {:.4f} s is not positive", v, time_s));
    }
    last_step = scale * v * settings.period_s;
    if (!(chords ? walker.chord(last_step) : walker.arc_step(last_step))) break;
    out.points_m.push_back(walker.position());
    out.arc_lengths_m.push_back(walker.travelled());
  }
  const Vec2 end = line.closed ? line.points_m.front() : line.points_m.back();
  const double left =
      chords ? (end - out.points_m.back()).norm() : walker.arc.back() - out.arc_lengths_m.back();
  if (remainder_m != nullptr) *remainder_m = left / last_step;
  if (left > 1e-9 * last_step || out.points_m.size() == 1) {
    out.points_m.push_back(end);
    out.arc_lengths_m.push_back(walker.arc.back());
  }
  return out;
}

tl::expected<Steps, std::string> steps_with_remainder(const Polyline& line, const SpeedLaw& speed,
                                                      const StepSettings& settings, bool chords) {
  double left = 0.0;
  auto out = steps_along(line, speed, settings, 1.0, chords, &left);
  if (!out || settings.remainder == Remainder::kShortStep || left < 1e-9) return out;
  // One step more or less, whichever is nearer: find the scale at which the steps come out even, by secant.
  const auto whole = static_cast<double>(out->points_m.size() - 2);
  const double wanted = std::max(1.0, std::round(whole + left));
  double scale = (whole + left) / wanted;
  for (int i = 0; i < 60; ++i) {
    out = steps_along(line, speed, settings, scale, chords, &left);
    if (!out) return out;
    const bool even = out->points_m.size() < 2 || left <= 1e-9;
    const double done = static_cast<double>(out->points_m.size() - (even ? 1 : 2)) + (even ? 0.0 : left);
    if (std::abs(done - wanted) < 1e-9) break;
    scale *= done / wanted;
  }
  // The last step carries what rounding left.
  if (static_cast<double>(out->points_m.size() - 1) > wanted) {
    out->points_m.erase(out->points_m.end() - 2);
    out->arc_lengths_m.erase(out->arc_lengths_m.end() - 2);
  }
  return out;
}

}  // namespace

Polyline doubled(const Polyline& line, int times) {
  Polyline out = line;
  for (int pass = 0; pass < times && out.size() >= 3; ++pass) {
    const std::vector<Vec2> p = std::move(out.points_m);
    const std::size_t n = p.size();
    out.points_m.clear();
    out.points_m.reserve(2 * n);
    for (std::size_t i = 0; i + (line.closed ? 0 : 2) < n; ++i) {
      out.points_m.push_back(p[i]);
      out.points_m.push_back((3.0 * p[i] + 6.0 * p[(i + 1) % n] - p[(i + 2) % n]) / 8.0);
    }
    if (line.closed) continue;
    out.points_m.push_back(p[n - 2]);
    out.points_m.push_back((-p[n - 3] + 6.0 * p[n - 2] + 3.0 * p[n - 1]) / 8.0);
    out.points_m.push_back(p[n - 1]);
  }
  return out;
}

tl::expected<Steps, std::string> chord_steps(const Polyline& line, const SpeedLaw& speed,
                                             const StepSettings& settings) {
  return steps_with_remainder(line, speed, settings, true);
}

tl::expected<Steps, std::string> arc_steps(const Polyline& line, const SpeedLaw& speed,
                                           const StepSettings& settings) {
  return steps_with_remainder(line, speed, settings, false);
}

tl::expected<std::vector<Eigen::Vector3d>, std::string> to_joint_space(const std::vector<Vec2>& points_m,
                                                                       double z_m,
                                                                       const InverseKinematics& inverse) {
  std::vector<Eigen::Vector3d> joints(points_m.size());
  for (std::size_t i = 0; i < points_m.size(); ++i) {
    const Eigen::Vector3d tool(points_m[i].x(), points_m[i].y(), z_m);
    if (!inverse(tool, joints[i])) {
      return tl::unexpected(
          fmt::format("point {} at ({:.4f}, {:.4f}, {:.4f}) m is out of the machine's reach", i, tool.x(),
                      tool.y(), tool.z()));
    }
  }
  return joints;
}

}  // namespace telekerf::geometry
