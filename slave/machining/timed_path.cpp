// SPDX-License-Identifier: Apache-2.0
#include "slave/machining/timed_path.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/geometry/interpolation.h"
#include "common/geometry/speed_profile.h"
#include "slave/machining/even_burn.h"

namespace telekerf::machining {
namespace {

constexpr double kGrid_m = 0.5e-6;  ///< an acute tip is rounded within a few of these
constexpr std::size_t kMostTicks = 20'000'000;

/// Greatest speed at equal steps along the way: what was asked, what curvature allows, and what can still be
/// braked down to the next slow place and to the end.
std::vector<double> speed_limits(const Path& path, const TimedPathSettings& s, double from_m, double to_m) {
  const auto count = static_cast<std::size_t>(std::ceil((to_m - from_m) / kGrid_m)) + 1;
  const bool slow = s.corner == CornerPolicy::kSlow;
  const double across = slow ? std::min(s.slow_acceleration_m_per_s2, s.max_acceleration_m_per_s2)
                             : 0.8 * s.max_acceleration_m_per_s2;
  const double along = slow ? across : std::min(s.ramp_m_per_s2, s.max_acceleration_m_per_s2);
  const double wanted = s.speed_m_per_s;
  std::vector<double> limit(count, wanted);
  for (std::size_t i = 0; i < count; ++i) {
    const double bend = path.at(from_m + static_cast<double>(i) * kGrid_m).second.norm();
    if (bend > 0.0) limit[i] = std::min(wanted, geometry::speed_in_bend(bend, across));
  }
  // The smoothing in time mixes neighbours: the slow place is made longer by what it may reach.
  std::vector<double> wide = limit;
  for (std::size_t i = 0; i < count; ++i) {
    if (limit[i] >= wanted) continue;
    const auto reach = static_cast<std::size_t>(0.5 * limit[i] * s.smoothing_s / kGrid_m) + 1;
    for (std::size_t k = i > reach ? i - reach : 0; k < std::min(count, i + reach + 1); ++k) {
      wide[k] = std::min(wide[k], limit[i]);
    }
  }
  geometry::keep_brakable(wide, kGrid_m, along);
  const double ramp = std::min(s.ramp_m_per_s2, s.max_acceleration_m_per_s2);
  for (std::size_t i = 0; i < count; ++i) {
    wide[i] = std::min(wide[i],
                       std::sqrt(2.0 * ramp * (to_m - from_m - static_cast<double>(i) * kGrid_m + kGrid_m)));
  }
  return wide;
}

/// Mean over `width` neighbours (odd); the ends are held.
std::vector<double> box(const std::vector<double>& in, std::size_t width) {
  const auto half = static_cast<std::ptrdiff_t>(width / 2);
  const auto last = static_cast<std::ptrdiff_t>(in.size()) - 1;
  const auto at = [&](std::ptrdiff_t i) {
    return in[static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(i, 0, last))];
  };
  std::vector<double> out(in.size());
  // Sums of differences to the first value keep the rounding at the size of one step.
  const double base = in.front();
  double sum = 0.0;
  for (std::ptrdiff_t k = -half; k <= half; ++k) sum += at(k) - base;
  for (std::ptrdiff_t i = 0; i <= last; ++i) {
    out[static_cast<std::size_t>(i)] = base + sum / static_cast<double>(2 * half + 1);
    sum += at(i + half + 1) - at(i - half);
  }
  return out;
}

}  // namespace

Reference Trajectory::at(double tick) const noexcept {
  const double last = static_cast<double>(points_.size() - 1);
  if (!(tick > 0.0) || tick >= last) {
    Reference end = tick > 0.0 ? points_.back() : points_.front();
    if (tick > last || tick < 0.0) {
      end.velocity_m_per_s.setZero();
      end.acceleration_m_per_s2.setZero();
    }
    return end;
  }
  const auto i = static_cast<std::size_t>(tick);
  const double part = tick - static_cast<double>(i);
  const Reference& a = points_[i];
  if (part == 0.0) return a;
  const Reference& b = points_[i + 1];
  Reference out = a;
  out.position_m += part * (b.position_m - a.position_m);
  out.velocity_m_per_s += part * (b.velocity_m_per_s - a.velocity_m_per_s);
  out.acceleration_m_per_s2 += part * (b.acceleration_m_per_s2 - a.acceleration_m_per_s2);
  return out;
}

PathSettings path_settings(const TimedPathSettings& settings) noexcept {
  PathSettings path;
  path.tolerance_m = settings.tolerance_m;
  switch (settings.corner) {
    case CornerPolicy::kExact:
      path.tolerance_m = 0.0;
      break;
    case CornerPolicy::kRounded:
      break;
    case CornerPolicy::kSlow:
      path.tolerance_m = std::min(settings.tolerance_m, 10e-6);
      break;
  }
  return path;
}

void TimedPathSettings::keep_within(const robot::ToolLimits& limits) noexcept {
  max_acceleration_m_per_s2 = std::min(max_acceleration_m_per_s2, 0.5 * limits.acceleration_m_per_s2);
  max_speed_m_per_s = std::min(max_speed_m_per_s, 0.9 * limits.velocity_m_per_s);
}

tl::expected<TimedPath, std::string> make_timed_path(const geometry::Polyline& contour,
                                                     const TimedPathSettings& settings) {
  const double size = geometry::all_finite(contour.points_m) && contour.size() > 0
                          ? geometry::bounding_box(contour.points_m).size().maxCoeff()
                          : INFINITY;  // refused below
  if (size < 2.0 * settings.spot_radius_m) {
    return tl::unexpected(
        fmt::format("the contour is {:.3g} mm across, less than the beam's {:g} mm; use a larger "
                    "--width-mm",
                    size * 1e3, 2e3 * settings.spot_radius_m));
  }
  auto path = Path::through(contour, path_settings(settings));
  if (!path) return tl::unexpected(path.error());
  return make_timed_path(std::move(*path), settings);
}

tl::expected<TimedPath, std::string> make_timed_path(Path path, const TimedPathSettings& s) {
  if (!(s.speed_m_per_s > 0.0)) return tl::unexpected<std::string>("the speed must be greater than zero");
  if (s.speed_m_per_s > s.max_speed_m_per_s) {
    return tl::unexpected(
        fmt::format("a speed of {:g} mm/s is more than the {:g} mm/s that this machine has for it; use a "
                    "smaller --speed-mm-s",
                    s.speed_m_per_s * 1e3, s.max_speed_m_per_s * 1e3));
  }
  const double period = 1.0 / s.control_hz;
  const double ramp = std::min(s.ramp_m_per_s2, s.max_acceleration_m_per_s2);
  const double speed = s.speed_m_per_s;
  const double run_up =
      speed * speed / (2.0 * ramp) + 1.5 * speed * s.smoothing_s + std::min(s.settle_m, speed * s.settle_s);
  const double cut_end = path.length_m() + (path.closed() ? s.overlap_m : 0.0);
  const double from = -run_up;
  const double to = cut_end + run_up;
  const std::vector<double> limit = speed_limits(path, s, from, to);
  const auto limit_at = [&](double arc) { return geometry::interpolated(limit, (arc - from) / kGrid_m); };

  const auto width = static_cast<std::size_t>(s.smoothing_s * s.control_hz / 3.0) | 1U;
  const std::size_t pad = 2 * width;
  const bool slow = s.corner == CornerPolicy::kSlow;
  const double along = slow ? std::min(s.slow_acceleration_m_per_s2, ramp) : ramp;
  std::vector<double> arc(pad, from);
  double v = 0.0;
  double place = from;
  while (place < to - 1e-9) {
    if (arc.size() > kMostTicks) return tl::unexpected<std::string>("the path takes too long at this speed");
    v = std::min(v + along * period, std::max(limit_at(place + 0.5 * v * period), 0.5 * ramp * period));
    place = std::min(to, place + v * period);
    arc.push_back(place);
  }
  arc.resize(arc.size() + pad, to);
  for (int pass = 0; pass < 3; ++pass) arc = box(arc, width);

  const EvenBurn even(path, cut_end, s.spot_radius_m, path.closed() ? s.overlap_m : 0.0);
  std::vector<Reference> points(arc.size());
  std::size_t cut_ticks = 0;
  double slowest = speed;
  const auto rate = [&](std::size_t i) {
    return i == 0 || i + 1 >= arc.size() ? 0.0 : (arc[i + 1] - arc[i - 1]) / (2.0 * period);
  };
  for (std::size_t i = 0; i < arc.size(); ++i) {
    const PathPoint p = path.at(arc[i]);
    Reference& r = points[i];
    r.arc_length_m = arc[i];
    r.speed_m_per_s = rate(i);
    r.speed_rate_m_per_s2 =
        i == 0 || i + 1 >= arc.size() ? 0.0 : (arc[i + 1] - 2.0 * arc[i] + arc[i - 1]) / (period * period);
    r.position_m = p.position_m;
    r.tangent = p.first;
    r.tangent_s = p.second;
    r.tangent_ss = p.third;
    r.velocity_m_per_s = r.speed_m_per_s * p.first;
    r.acceleration_m_per_s2 = r.speed_rate_m_per_s2 * p.first + r.speed_m_per_s * r.speed_m_per_s * p.second;
    r.beam = arc[i] >= 0.0 && arc[i] <= cut_end;
    if (r.beam) {
      ++cut_ticks;
      r.power = r.speed_m_per_s / s.speed_m_per_s * even.fraction(arc[i]);
      slowest = std::min(slowest, r.speed_m_per_s);
    }
  }
  TimedPath plan{std::move(path), Trajectory(std::move(points)), period, 0.0, 0.0, slowest};
  plan.cut_s = static_cast<double>(cut_ticks) * period;
  plan.mean_speed_m_per_s = cut_end / plan.cut_s;
  return plan;
}

}  // namespace telekerf::machining
