// SPDX-License-Identifier: Apache-2.0
#include "master/constraint/guide_path.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "common/runtime/startup_error.h"

namespace telekerf::master {
namespace {

using geometry::CircleOrLine;

geometry::Polyline scaled_points(const ContourMessage& contour, double beta, double spacing_m) {
  geometry::Polyline line;
  line.closed = contour.closed;
  for (const auto& point : contour.points_m) line.points_m.push_back(point / beta);
  return geometry::resampled(line, spacing_m);
}

/// Index into a closed line, or the nearest one of an open line.
std::size_t index_of(const geometry::Polyline& line, long i) {
  const auto n = static_cast<long>(line.size());
  return static_cast<std::size_t>(line.closed ? ((i % n) + n) % n : std::clamp<long>(i, 0, n - 1));
}

/// Gaussian average along the curve: no tool turns a corner of no radius. A right angle loses 0.57 `sigma_m`
/// of its tip, a bend of radius R moves inwards by sigma^2 / 2R.
geometry::Polyline rounded(const geometry::Polyline& line, double spacing_m, double sigma_m) {
  const long reach = std::lround(3.0 * sigma_m / spacing_m);
  if (reach < 1) return line;
  geometry::Polyline out = line;
  for (long i = 0; i < static_cast<long>(line.size()); ++i) {
    // Ends of an open line stay where they are: there the average is over fewer points.
    const long room = line.closed ? reach : std::min({reach, i, static_cast<long>(line.size()) - 1 - i});
    Vec2 sum = Vec2::Zero();
    double weights = 0.0;
    for (long j = -room; j <= room; ++j) {
      const double u = static_cast<double>(j) * spacing_m / sigma_m;
      const double weight = std::exp(-0.5 * u * u);
      sum += weight * line.points_m[index_of(line, i + j)];
      weights += weight;
    }
    out.points_m[index_of(line, i)] = sum / weights;
  }
  return out;
}

/// Curvature of the circle through three points; a turn by a right angle or more counts as a point.
double bend_at(const Vec2& before, const Vec2& here, const Vec2& after) noexcept {
  const Vec2 in = here - before;
  const Vec2 out = after - here;
  if (in.dot(out) <= 0.0) return std::numeric_limits<double>::infinity();
  return 2.0 * std::abs(geometry::cross(in, out)) / (in.norm() * out.norm() * (in + out).norm());
}

/// Bends no tighter than `radius_m`: where one is, the points move towards the middle of their neighbours
/// (the curve shortens) until it is open enough, or until they have moved by `most_m`: a hairpin without
/// width has no such bend. An average along the curve does not do it: it makes a cusp short, not round.
geometry::Polyline opened(geometry::Polyline line, double spacing_m, double radius_m, double most_m) {
  constexpr int kRounds = 3000;
  if (radius_m <= 0.0 || line.size() < 5) return line;
  std::vector<Vec2> start = line.points_m;
  bool changed = false;
  for (int round = 0; round < kRounds; ++round) {
    const auto n = static_cast<long>(line.size());
    const std::vector<Vec2> old = line.points_m;
    std::vector<Vec2> kept, kept_start;
    bool moved = false;
    bool dropped = false;
    for (long i = 0; i < n; ++i) {
      Vec2 here = old[static_cast<std::size_t>(i)];
      const Vec2 from = start[static_cast<std::size_t>(i)];
      const Vec2& before = old[index_of(line, i - 1)];
      const Vec2& after = old[index_of(line, i + 1)];
      const bool end = !line.closed && (i == 0 || i == n - 1);
      if (!end && bend_at(before, here, after) > 1.0 / radius_m) {
        const Vec2 next = 0.5 * here + 0.25 * (before + after);
        if ((next - from).norm() <= most_m) {
          here = next;
          moved = true;
          // Points that come too close together would stop the rest.
          dropped = !dropped && (after - before).norm() < 1.2 * spacing_m;
          if (dropped) {
            // How far the tip has come in is told from where it began.
            if (!kept_start.empty()) kept_start.back() = from;
            start[index_of(line, i + 1)] = from;
            continue;
          }
        }
      } else {
        dropped = false;
      }
      kept.push_back(here);
      kept_start.push_back(from);
    }
    if (!moved) break;
    changed = true;
    line.points_m = std::move(kept);
    start = std::move(kept_start);
  }
  return changed ? geometry::resampled(line, spacing_m) : line;
}

/// The line through the weighted mean along the largest spread, in drawing order.
CircleOrLine fit_line(std::span<const Vec2> points, std::span<const double> weights) noexcept {
  Vec2 mean = Vec2::Zero();
  double sum = 0.0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    mean += weights[i] * points[i];
    sum += weights[i];
  }
  mean /= sum;
  double xx = 0.0, xy = 0.0, yy = 0.0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec2 d = points[i] - mean;
    xx += weights[i] * d.x() * d.x();
    xy += weights[i] * d.x() * d.y();
    yy += weights[i] * d.y() * d.y();
  }
  const double angle = 0.5 * std::atan2(2.0 * xy, xx - yy);
  CircleOrLine out;
  out.point_m = mean;
  out.direction = Vec2(std::cos(angle), std::sin(angle));
  if (out.direction.dot(points.back() - points.front()) < 0.0) out.direction = -out.direction;
  return out;
}

}  // namespace

GuidePath::GuidePath(const ContourMessage& contour, double scale, const ConstraintSettings& settings)
    : contour_id(contour.id),
      beta(scale),
      curve(opened(
          rounded(scaled_points(contour, scale, settings.spacing_m), settings.spacing_m, settings.rounding_m),
          settings.spacing_m, settings.tightest_m, settings.opening_m)),
      settings_(settings),
      kind_(settings.curve) {
  const auto segments = static_cast<double>(curve.line().segments());
  length_m_ = curve.length_m();
  spacing_m_ = length_m_ / segments;
  if (kind_ == CurveKind::kDescriptor) {
    if (!closed()) throw StartupError("a descriptor needs a closed contour; use --curve circles");
    const auto chosen = geometry::choose_harmonics(curve.line(), settings.descriptor_error_m);
    if (!chosen) throw StartupError("no descriptor of this contour: " + chosen.error());
    descriptor_.emplace(chosen->curve);
    length_m_ = descriptor_->length_m();
  }
  fit_windows();
  limit_speed();
}

void GuidePath::fit_windows() {
  const geometry::Polyline& line = curve.line();
  const auto n = static_cast<long>(line.size());
  const auto tangent = [&](long i) -> Vec2 {
    return (line.points_m[index_of(line, i + 1)] - line.points_m[index_of(line, i - 1)]).normalized();
  };
  const auto most = static_cast<double>(std::min<long>(settings_.half_window, geometry::kMaxHalfWindow));
  half_window_.assign(static_cast<std::size_t>(n), most);
  if (kind_ == CurveKind::kDescriptor || settings_.window_bend_rad >= std::numbers::pi) return;
  for (long i = 0; i < n; ++i) {
    const Vec2 here = tangent(i);
    double& half = half_window_[static_cast<std::size_t>(i)];
    for (long k = 1; static_cast<double>(k) < most; ++k) {
      const double cosine = std::min(here.dot(tangent(i + k)), here.dot(tangent(i - k)));
      if (cosine >= std::cos(settings_.window_bend_rad)) continue;
      half = std::max(2.0, static_cast<double>(k));
      break;
    }
  }
  // Neighbours differ by half a point at most, so that the windows open and close gradually.
  const long steps = line.closed ? 2 * n : n - 1;
  const auto soften = [&](long from, long to) {
    double& half = half_window_[index_of(line, to)];
    half = std::min(half, half_window_[index_of(line, from)] + 0.5);
  };
  for (long i = 0; i < steps; ++i) soften(i, i + 1);
  for (long i = steps; i > 0; --i) soften(i, i - 1);
}

double GuidePath::wrapped(double arc_m) const noexcept {
  if (!closed()) return std::clamp(arc_m, 0.0, length_m_);
  const double arc = std::fmod(arc_m, length_m_);
  return arc < 0.0 ? arc + length_m_ : arc;
}

double GuidePath::find(const Vec2& tool_m) const noexcept { return refined(tool_m, curve.find(tool_m)); }

double GuidePath::find_near(const Vec2& tool_m, double arc_m) const noexcept {
  const double share = wrapped(arc_m) / length_m_;
  const auto segment = static_cast<std::size_t>(share * static_cast<double>(curve.line().segments()));
  return refined(tool_m, curve.find_near(tool_m, segment));
}

double GuidePath::refined(const Vec2& tool_m, const geometry::Nearest& nearest) const noexcept {
  const auto segments = static_cast<double>(curve.line().segments());
  double arc = length_m_ * (static_cast<double>(nearest.segment) + nearest.along) / segments;
  for (int i = 0; i < 4; ++i) {
    const GuidePiece piece = at(arc);
    const double step = piece.shape.tangent(tool_m).dot(tool_m - piece.point_m);
    arc = wrapped(arc + std::clamp(step, -2.0 * spacing_m_, 2.0 * spacing_m_));
  }
  return arc;
}

GuidePiece GuidePath::at(double arc_m) const noexcept {
  const double arc = wrapped(arc_m);
  return descriptor_ ? described(arc) : fitted(arc);
}

GuidePiece GuidePath::fitted(double arc_m) const noexcept {
  const geometry::Polyline& line = curve.line();
  const double place = arc_m / spacing_m_;
  const long middle = std::lround(place);
  const long before = std::clamp<long>(static_cast<long>(place), 0, static_cast<long>(line.segments()) - 1);
  const double share = place - static_cast<double>(before);
  const double here = half_window_[index_of(line, before)];
  const double width = here + share * (half_window_[index_of(line, before + 1)] - here);
  const long half = std::min<long>(std::lround(std::ceil(width)), geometry::kMaxHalfWindow);

  std::array<Vec2, 2 * geometry::kMaxHalfWindow + 1> points;
  std::array<double, 2 * geometry::kMaxHalfWindow + 1> weights;
  std::size_t count = 0;
  for (long i = middle - half; i <= middle + half; ++i) {
    if (!line.closed && (i < 0 || i >= static_cast<long>(line.size()))) continue;
    points[count] = line.points_m[index_of(line, i)];
    // Hann: the nearest point changes half way between two, where the outermost ones weigh nothing.
    const double away = (static_cast<double>(i) - place) / (width + 0.5);
    weights[count] =
        settings_.taper ? 0.5 + 0.5 * std::cos(std::numbers::pi * std::clamp(away, -1.0, 1.0)) : 1.0;
    ++count;
  }
  const std::span<const Vec2> used(points.data(), count);
  const std::span<const double> weighted(weights.data(), count);

  GuidePiece piece;
  piece.arc_m = arc_m;
  piece.shape = kind_ == CurveKind::kLines ? fit_line(used, weighted) : geometry::fit_circle(used, weighted);
  const Vec2& a = line.start_of(static_cast<std::size_t>(before));
  const Vec2& b = line.end_of(static_cast<std::size_t>(before));
  piece.point_m = piece.shape.project(a + share * (b - a));
  // Through a hairpin a circle may be as tight as it likes; no tool turns round within one.
  const double bend = piece.shape.curvature();
  if (settings_.tightest_m > 0.0 && std::abs(bend) * settings_.tightest_m > 1.0) {
    piece.shape = geometry::osculating(piece.point_m, piece.shape.tangent(piece.point_m),
                                       std::copysign(1.0 / settings_.tightest_m, bend));
  }
  return piece;
}

GuidePiece GuidePath::described(double arc_m) const noexcept {
  const geometry::CurveState state = descriptor_->at(arc_m);
  const Vec2 tangent = state.first.normalized();
  return {arc_m, state.position,
          geometry::osculating(state.position, tangent, geometry::cross(tangent, state.second))};
}

void GuidePath::limit_speed() {
  const geometry::Polyline& line = curve.line();
  const auto n = static_cast<long>(line.size());
  std::vector<double> bends(static_cast<std::size_t>(n));  // signed curvature, of the larger of two
  for (long i = 0; i < n; ++i) {
    // Of the circle and of the points themselves: a circle through a cusp may be too flat.
    const double share = static_cast<double>(i) / static_cast<double>(line.segments());
    const Vec2 in = line.points_m[index_of(line, i)] - line.points_m[index_of(line, i - 2)];
    const Vec2 out = line.points_m[index_of(line, i + 2)] - line.points_m[index_of(line, i)];
    const double turn = 0.5 * std::atan2(geometry::cross(in, out), in.dot(out)) / spacing_m_;
    const double circle = at(length_m_ * share).shape.curvature();
    bends[static_cast<std::size_t>(i)] = std::abs(circle) > std::abs(turn) ? circle : turn;
  }
  limit_m_per_s_.resize(static_cast<std::size_t>(n));
  for (long i = 0; i < n; ++i) {
    const double bend = std::max(std::abs(bends[static_cast<std::size_t>(i)]), 1e-6);
    const double change =
        std::abs(bends[index_of(line, i + 2)] - bends[index_of(line, i - 2)]) / (4.0 * spacing_m_);
    limit_m_per_s_[static_cast<std::size_t>(i)] =
        std::min({settings_.max_speed_m_per_s, std::sqrt(settings_.bend_m_per_s2 / bend),
                  settings_.bend_rad_s / bend, std::cbrt(settings_.bend_m_per_s3 / std::max(change, 1e-3))});
  }
  if (!closed()) limit_m_per_s_.front() = limit_m_per_s_.back() = settings_.end_m_per_s;
  // v^2 may grow by 2 a ds; on a closed curve twice round, so that the seam is seen from both sides.
  const double growth = 2.0 * settings_.slowing_m_per_s2 * spacing_m_;
  const auto soften = [&](long from, long to) {
    auto& limited = limit_m_per_s_[static_cast<std::size_t>(((to % n) + n) % n)];
    const double neighbour = limit_m_per_s_[static_cast<std::size_t>(((from % n) + n) % n)];
    limited = std::min(limited, std::sqrt(neighbour * neighbour + growth));
  };
  const long steps = closed() ? 2 * n : n - 1;
  for (long i = 0; i < steps; ++i) soften(i, i + 1);
  for (long i = steps; i > 0; --i) soften(i, i - 1);
}

GuidePath::SpeedLimit GuidePath::speed_limit(double arc_m) const noexcept {
  const std::size_t n = limit_m_per_s_.size();
  const auto segments = curve.line().segments();
  const double place = wrapped(arc_m) / length_m_ * static_cast<double>(segments);
  const auto i = std::min(static_cast<std::size_t>(place), segments - 1);
  const double here = limit_m_per_s_[i];
  const double next = limit_m_per_s_[i + 1 < n ? i + 1 : 0];
  const double share = place - static_cast<double>(i);
  return {here + share * (next - here), (next - here) / spacing_m_};
}

}  // namespace telekerf::master
