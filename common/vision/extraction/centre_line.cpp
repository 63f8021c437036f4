// SPDX-License-Identifier: Apache-2.0
#include "common/vision/extraction/centre_line.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <utility>

#include "common/geometry/circle_fit.h"
#include "common/geometry/smoothing.h"
#include "common/vision/extraction/corners.h"
#include "common/vision/extraction/tangents.h"

namespace telekerf::vision {
namespace {

/// Distance from `p` along `direction` to where the ink ends, if that is within `reach`. Within `sure` of `p`
/// a gap would be a blemish.
std::optional<double> ink_ends(const Field& field, const Vec2& p, const Vec2& direction, double reach,
                               double sure = 0.0) {
  constexpr double kStep = 1.0;
  double before = field.value(p);
  if (before <= 0.0) return std::nullopt;
  double from = 0.0;
  if (sure > kStep) {
    const double there = field.value(p + sure * direction);
    if (there > 0.0) {
      before = there;
      from = sure;
    }
  }
  // Two pixels at a time, then the one of the two where the ink ends.
  for (double t = from + 2.0 * kStep; t < reach + 2.0 * kStep; t += 2.0 * kStep) {
    const double here = field.value(p + t * direction);
    if (here <= 0.0) {
      const double between = field.value(p + (t - kStep) * direction);
      if (between <= 0.0) return t - kStep - kStep * between / (between - before);
      return t - kStep * here / (here - between);
    }
    before = here;
  }
  return std::nullopt;
}

/// Runs of points that are not `good`, as first and last index; on a closed line they may wrap past the end.
std::vector<std::pair<std::size_t, std::size_t>> runs_of_bad(const std::vector<bool>& good, bool closed) {
  const std::size_t n = good.size();
  std::vector<std::pair<std::size_t, std::size_t>> runs;
  std::size_t begin = 0;
  if (closed) {
    while (begin < n && !good[begin]) ++begin;
    if (begin == n) return runs;
  }
  for (std::size_t k = 0; k < n;) {
    const std::size_t i = begin + k;
    if (good[i % n]) {
      ++k;
      continue;
    }
    std::size_t length = 1;
    while (k + length < n && !good[(i + length) % n]) ++length;
    runs.emplace_back(i, i + length - 1);
    k += length;
  }
  return runs;
}

/// Keeps each point's mark while the line is given evenly spaced points.
void space_evenly(std::vector<Vec2>& p, std::vector<bool>& junction, bool closed, double spacing_px) {
  const geometry::Polyline line{p, closed};
  const std::vector<double> s = geometry::arc_lengths(line);
  geometry::Polyline even = geometry::resampled(line, spacing_px);
  std::vector<bool> marks(even.size(), false);
  std::size_t at = 0;
  for (std::size_t i = 0; i < even.size(); ++i) {
    const double here =
        s.back() * static_cast<double>(i) / static_cast<double>(std::max<std::size_t>(1, even.segments()));
    while (at + 1 < p.size() && s[at + 1] <= here) ++at;
    marks[i] = junction[at] || junction[(at + 1) % p.size()];
  }
  p = std::move(even.points_m);
  junction = std::move(marks);
}

/// The middle between the two borders, and the width, at each point. Where the borders are not found at about
/// one width from each other (corners, overlaps), the shift of the neighbours is carried over.
double centre_once(const Field& field, std::vector<Vec2>& p, const std::vector<bool>& junction, bool closed,
                   double width_px, double spacing_px) {
  const std::size_t n = p.size();
  const auto reach = static_cast<std::size_t>(std::lround(std::max(2.0, 0.6 * width_px / spacing_px)));
  const std::vector<Vec2> tangents = tangents_of(p, closed, reach);
  std::vector<double> shift(n, 0.0);
  std::vector<double> found(n, 0.0);  // width; 0: the borders are not there
  for (std::size_t i = 0; i < n; ++i) {
    if (junction[i]) continue;
    const Vec2 normal(-tangents[i].y(), tangents[i].x());
    const auto left = ink_ends(field, p[i], normal, 1.2 * width_px + 2.0, 0.3 * width_px);
    const auto right = ink_ends(field, p[i], -normal, 1.2 * width_px + 2.0, 0.3 * width_px);
    if (!left || !right || *left + *right > 1.45 * width_px + 1.0) continue;
    found[i] = *left + *right;
    shift[i] = 0.5 * (*left - *right);
  }
  std::vector<bool> good(n, false);
  std::vector<double> widths;
  for (std::size_t i = 0; i < n; ++i) {
    good[i] = found[i] > 0.0;
    if (good[i]) widths.push_back(found[i]);
  }
  for (const auto& [first, last] : runs_of_bad(good, closed)) {
    const bool open_front = !closed && first == 0;
    const bool open_back = !closed && last == n - 1;
    const double from = open_front ? (open_back ? 0.0 : shift[last + 1]) : shift[(first + n - 1) % n];
    const double to = open_back ? from : shift[(last + 1) % n];
    for (std::size_t i = first; i <= last; ++i) {
      const double t = static_cast<double>(i - first + 1) / static_cast<double>(last - first + 2);
      shift[i % n] = (1.0 - t) * from + t * to;
    }
  }
  for (std::size_t i = 0; i < n; ++i) p[i] += shift[i] * Vec2(-tangents[i].y(), tangents[i].x());
  if (widths.empty()) return width_px;
  std::nth_element(widths.begin(), widths.begin() + widths.size() / 2, widths.end());
  return widths[widths.size() / 2];
}

/// How far the middle of the pen's last touch lies before the end of the ink: half the pen (filter and lens,
/// about 0.8 px, have widened the stroke), less what they take from a round end: about blur^2 over its
/// diameter.
double pen_inset(const Field& field, double width_px) {
  const double blur = std::hypot(field.sigma_px, 0.8);
  const double pen = std::sqrt(std::max(0.0, width_px * width_px - std::pow(2.355 * blur, 2)));
  return 0.5 * pen - std::min(0.6, pen > 0.5 ? blur * blur / pen : 0.6);
}

/// Puts the last point half a pen before the end of the ink, along the stroke's direction and bend before
/// it.
void set_end(const Field& field, std::vector<Vec2>& p, double width_px) {
  const auto back = static_cast<std::size_t>(std::lround(0.7 * width_px + 1.0));
  const auto span = static_cast<std::size_t>(std::lround(width_px + 6.0));
  if (p.size() < back + span + 4) return;
  // What thinning drew inside the cap follows the cap, not the stroke.
  p.resize(p.size() - back);
  const auto fit = geometry::fit_circle(std::span(p).last(std::min(span, 2 * geometry::kMaxHalfWindow)));
  const double bend = std::clamp(fit.curvature(), -1.0 / (2.0 * width_px), 1.0 / (2.0 * width_px));
  Vec2 direction = fit.tangent(p.back());
  Vec2 at = p.back();
  constexpr double kStep = 0.25;
  std::vector<Vec2> beyond;
  double on = 0.0;
  for (double before = field.value(at); before > 0.0; on += kStep) {
    if (on > 4.0 * width_px + 4.0) return;
    const double angle = 0.5 * bend * kStep;
    direction = Eigen::Rotation2D<double>(angle) * direction;
    at += kStep * direction;
    direction = Eigen::Rotation2D<double>(angle) * direction;
    beyond.push_back(at);
    const double here = field.value(at);
    if (here <= 0.0) on -= kStep * here / (here - before);  // back to where it crosses zero
    before = here;
  }
  if (beyond.empty()) return;
  const double wanted = on - pen_inset(field, width_px);
  const auto push = [&](double t) {  // the inset of a hairline is negative: never past what was walked
    const auto i = static_cast<std::size_t>(std::max(1L, std::lround(t / kStep))) - 1;
    p.push_back(beyond[std::min(beyond.size() - 1, i)]);
  };
  for (double t = 1.0; t < wanted; t += 1.0) push(t);
  if (wanted > 0.25) push(wanted);
}

/// Replaces the marked points by a cubic that continues the directions on both sides.
void bridge(std::vector<Vec2>& p, const std::vector<bool>& junction, bool closed) {
  const std::size_t n = p.size();
  if (n == 0) return;
  std::vector<bool> good(n);
  for (std::size_t i = 0; i < n; ++i) good[i] = !junction[i];
  for (const auto& [first, last] : runs_of_bad(good, closed)) {
    if (!closed && (first == 0 || last == n - 1)) continue;
    const std::size_t a = (first + n - 1) % n;
    const std::size_t b = (last + 1) % n;
    const double gap = (p[b] - p[a]).norm();
    const auto reach = std::clamp<std::size_t>(static_cast<std::size_t>(0.5 * gap), 2, 12);
    if (!closed && (a < reach || b + reach >= n)) continue;
    const Vec2 in = p[a] - p[(a + n - reach) % n];
    const Vec2 out = p[(b + reach) % n] - p[b];
    if (!(gap > 0.0) || !(in.norm() > 0.0) || !(out.norm() > 0.0)) continue;
    const Vec2 m0 = gap * in.normalized();
    const Vec2 m1 = gap * out.normalized();
    const auto steps = static_cast<double>(last - first + 2);
    for (std::size_t i = first; i <= last; ++i) {
      const double t = static_cast<double>(i - first + 1) / steps;
      const double t2 = t * t;
      const double t3 = t2 * t;
      p[i % n] =
          (2 * t3 - 3 * t2 + 1) * p[a] + (t3 - 2 * t2 + t) * m0 + (3 * t2 - 2 * t3) * p[b] + (t3 - t2) * m1;
    }
  }
}

}  // namespace

PixelContour centred(const Field& field, const Route& route, double width_px) {
  PixelContour out;
  out.closed = route.closed;
  out.width_px = width_px;
  std::vector<Vec2> p = route.points_px;
  std::vector<bool> junction = route.junction;
  if (p.size() < 4) {
    out.points_px = std::move(p);
    return out;
  }
  bridge(p, junction, out.closed);
  double spacing_px = 1.0;
  for (int pass = 0; pass < 2; ++pass) {
    spacing_px = std::max(1.0, std::floor(width_px / (pass == 0 ? 2.5 : 12.0)));
    space_evenly(p, junction, out.closed, spacing_px);
    geometry::smooth_keeping_bends(p, out.closed, std::max(1.0, 0.35 * width_px) / spacing_px);
    out.width_px = centre_once(field, p, junction, out.closed, out.width_px, spacing_px);
    bridge(p, junction, out.closed);
  }
  // Ends and corners count points as pixels.
  if (spacing_px > 1.0) p = geometry::resampled({std::move(p), out.closed}, 1.0).points_m;
  if (!out.closed) {
    if (route.to_end) set_end(field, p, out.width_px);
    std::reverse(p.begin(), p.end());
    if (route.from_end) set_end(field, p, out.width_px);
    std::reverse(p.begin(), p.end());
  }
  // A pen that turns at a corner leaves ink half a width around it, a bend of the same turn does not.
  const double w = out.width_px;
  sharpen_corners(p, out.closed,
                  {.rounded_px = std::max(4.0, 1.3 * w),
                   .side_px = std::max(8.0, 1.5 * w),
                   .max_distance_px = 1.6 * w + 3.0,
                   .pen_px = w,
                   .agrees =
                       [&](const Vec2& corner, const Vec2& outwards) {
                         const auto ink = ink_ends(field, corner, outwards, 3.0 * w);
                         return ink && *ink > pen_inset(field, w) - 0.1 * w - 0.2 && *ink < 0.8 * w + 0.5;
                       },
                   .tip = [&](const Vec2& rounded, const Vec2& outwards) -> std::optional<Vec2> {
                     const auto ink = ink_ends(field, rounded, outwards, 6.0 * w);
                     if (!ink || *ink < 0.5 * w) return std::nullopt;
                     return rounded + (*ink - pen_inset(field, w)) * outwards;
                   },
                   .single =
                       [&](const Vec2& point, const Vec2& tangent) {
                         const Vec2 normal = Vec2(-tangent.y(), tangent.x()).normalized();
                         const auto left = ink_ends(field, point, normal, w + 2.0);
                         const auto right = ink_ends(field, point, -normal, w + 2.0);
                         return left && right && std::abs(*left + *right - w) < 0.12 * w + 0.3;
                       }});
  out.points_px = std::move(p);
  return out;
}

}  // namespace telekerf::vision
