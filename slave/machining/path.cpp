// SPDX-License-Identifier: Apache-2.0
#include "slave/machining/path.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "common/geometry/cubic_spline.h"
#include "common/geometry/elliptic_fourier.h"
#include "common/geometry/smoothing.h"

namespace telekerf::machining {
namespace {

using geometry::Polyline;

/// Nodes a standard deviation of the smoothing: the pieces between them then follow it to nanometres.
constexpr double kNodesPerSmoothing = 3.0;
/// Harmonics beyond the one that the Gaussian weights with exp(-kTaper^2 / 2) are left out.
constexpr double kTaper = 3.7;

Vec3 flat(const Vec2& p) { return {p.x(), p.y(), 0.0}; }

/// Quintic Hermite piece over a width h; u in 0..1.
struct Piece {
  std::array<Vec3, 6> c;  // by u
  Piece(const PathNode& a, const PathNode& b, double h) noexcept {
    const Vec3 va = h * a.first, vb = h * b.first, aa = h * h * a.second, ab = h * h * b.second;
    const Vec3 d = b.position_m - a.position_m;
    c = {a.position_m,
         va,
         0.5 * aa,
         10.0 * d - 6.0 * va - 4.0 * vb - 1.5 * aa + 0.5 * ab,
         -15.0 * d + 8.0 * va + 7.0 * vb + 1.5 * aa - ab,
         6.0 * d - 3.0 * (va + vb) + 0.5 * (ab - aa)};
  }
  Vec3 value(double u) const noexcept {
    return c[0] + u * (c[1] + u * (c[2] + u * (c[3] + u * (c[4] + u * c[5]))));
  }
  Vec3 slope(double u) const noexcept {
    return c[1] + u * (2.0 * c[2] + u * (3.0 * c[3] + u * (4.0 * c[4] + u * 5.0 * c[5])));
  }
  Vec3 bend(double u) const noexcept {
    return 2.0 * c[2] + u * (6.0 * c[3] + u * (12.0 * c[4] + u * 20.0 * c[5]));
  }
  Vec3 third(double u) const noexcept { return 6.0 * c[3] + u * (24.0 * c[4] + u * 60.0 * c[5]); }
};

tl::expected<Path, std::string> closed_path(const Polyline& line, double sigma_m, std::size_t& harmonics) {
  const double length = geometry::length_m(line);
  const double wave = 2.0 * std::numbers::pi * sigma_m / length;
  harmonics = std::clamp<std::size_t>(static_cast<std::size_t>(std::ceil(kTaper / wave)), 8, 4096);
  auto fitted = geometry::fit_elliptic_fourier(line, harmonics);
  if (!fitted) return tl::unexpected(fitted.error());
  for (std::size_t i = 0; i < harmonics; ++i) {
    const double k = static_cast<double>(i + 1) * wave;
    const double weight = std::exp(-0.5 * k * k);
    auto& h = fitted->harmonics[i];
    h = {weight * h.a, weight * h.b, weight * h.c, weight * h.d};
  }
  const auto count = static_cast<std::size_t>(std::ceil(kNodesPerSmoothing * length / sigma_m)) + 16;
  std::vector<PathNode> nodes;
  nodes.reserve(count + 1);
  for (std::size_t i = 0; i < count; ++i) {
    const double theta = 2.0 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(count);
    const auto r = fitted->at(theta);
    nodes.push_back({theta, flat(r.position), flat(r.first), flat(r.second)});
  }
  nodes.push_back(nodes.front());
  nodes.back().parameter = 2.0 * std::numbers::pi;
  return Path::through(nodes, true);
}

tl::expected<Path, std::string> open_path(const Polyline& line, double sigma_m) {
  const double length = geometry::length_m(line);
  const auto segments = static_cast<std::size_t>(std::ceil(kNodesPerSmoothing * length / sigma_m)) + 4;
  const double spacing = length / static_cast<double>(segments);
  Polyline even = geometry::resampled_to(line, segments);
  even.points_m = geometry::gaussian_smoothed(even.points_m, false, sigma_m / spacing);
  std::vector<double> along{0.0};
  for (std::size_t i = 1; i < even.size(); ++i) {
    along.push_back(along.back() + (even.points_m[i] - even.points_m[i - 1]).norm());
  }
  const auto spline = geometry::CubicSpline<2>::through(along, even.points_m);
  if (!spline) return tl::unexpected(spline.error());
  std::vector<PathNode> nodes;
  for (const double s : along) {
    const auto r = spline->at(s);
    nodes.push_back({s, flat(r.position), flat(r.velocity), flat(r.acceleration)});
  }
  return Path::through(nodes, false);
}

}  // namespace

double smoothing_for(const Polyline& line, const PathSettings& settings) {
  const double spacing = settings.min_smoothing_m / 2.0;
  const auto segments = std::clamp<std::size_t>(
      static_cast<std::size_t>(std::ceil(geometry::length_m(line) / spacing)), 16, 200'000);
  const Polyline even = geometry::resampled_to(line, segments);
  const double step = geometry::length_m(line) / static_cast<double>(segments);
  const auto moved = [&](double sigma_m) {
    const auto after = geometry::gaussian_smoothed(even.points_m, even.closed, sigma_m / step);
    double worst = 0.0;
    for (std::size_t i = 0; i < after.size(); ++i) {
      // Across the line: along it a point may move without harm.
      const Vec2& before = even.points_m[i];
      const std::size_t n = even.size();
      const Vec2& next = even.points_m[(i + 1) % n];
      const Vec2& last = even.points_m[(i + n - 1) % n];
      const Vec2 tangent = (next - last).normalized();
      const Vec2 shift = after[i] - before;
      worst = std::max(worst, std::abs(geometry::cross(tangent, shift)));
    }
    return worst;
  };
  double low = settings.min_smoothing_m;
  double high = settings.max_smoothing_m;
  if (moved(high) <= settings.tolerance_m) return high;
  for (int i = 0; i < 6; ++i) {
    const double middle = 0.5 * (low + high);
    (moved(middle) <= settings.tolerance_m ? low : high) = middle;
  }
  return low;
}

tl::expected<Path, std::string> Path::through(const Polyline& line, const PathSettings& settings) {
  if (!geometry::all_finite(line.points_m)) return tl::unexpected<std::string>("a coordinate is not finite");
  const Polyline clean = geometry::without_duplicates(line, 1e-9);
  if (clean.size() < (clean.closed ? 3U : 2U)) {
    return tl::unexpected<std::string>("the contour has too few distinct points");
  }
  const double sigma_m = smoothing_for(clean, settings);
  std::size_t harmonics = 0;
  auto path = clean.closed ? closed_path(clean, sigma_m, harmonics) : open_path(clean, sigma_m);
  if (path) {
    path->smoothing_m_ = sigma_m;
    path->harmonics_ = harmonics;
  }
  return path;
}

tl::expected<Path, std::string> Path::through(const std::vector<PathNode>& nodes, bool closed) {
  if (nodes.size() < 2) return tl::unexpected<std::string>("a path needs two nodes");
  Path path;
  path.closed_ = closed;
  path.nodes_.reserve(nodes.size());
  double arc = 0.0;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const PathNode& node = nodes[i];
    const double speed = node.first.norm();
    if (!(speed > 0.0) || !std::isfinite(speed)) {
      return tl::unexpected<std::string>("the path has a point without a direction");
    }
    if (i > 0) {
      const double h = node.parameter - nodes[i - 1].parameter;
      if (!(h > 0.0)) return tl::unexpected<std::string>("the path's parameter does not increase");
      const Piece piece(nodes[i - 1], node, h);
      // Gauss-Legendre, five points.
      constexpr std::array<double, 5> kAt{0.04691007703067, 0.23076534494716, 0.5, 0.76923465505284,
                                          0.95308992296933};
      constexpr std::array<double, 5> kWeight{0.118463442528095, 0.239314335249683, 0.284444444444444,
                                              0.239314335249683, 0.118463442528095};
      for (std::size_t k = 0; k < kAt.size(); ++k) arc += kWeight[k] * piece.slope(kAt[k]).norm();
    }
    const Vec3 tangent = node.first / speed;
    const Vec3 bend = (node.second - node.second.dot(tangent) * tangent) / (speed * speed);
    path.nodes_.push_back({arc, node.position_m, tangent, bend});
  }
  return path;
}

PathPoint Path::at(double arc_length_m) const noexcept {
  double s = arc_length_m;
  if (closed_) {
    s = std::fmod(s, length_m());
    if (s < 0.0) s += length_m();
  } else if (s < 0.0 || s > length_m()) {
    const PathNode& end = s < 0.0 ? nodes_.front() : nodes_.back();
    return {end.position_m + (s - end.parameter) * end.first, end.first};
  }
  const auto above = std::upper_bound(nodes_.begin() + 1, nodes_.end() - 1, s,
                                      [](double value, const PathNode& n) { return value < n.parameter; });
  const PathNode& b = *above;
  const PathNode& a = *(above - 1);
  const double h = b.parameter - a.parameter;
  const double u = (s - a.parameter) / h;
  const Piece piece(a, b, h);
  return {piece.value(u), (piece.slope(u) / h).normalized(), piece.bend(u) / (h * h),
          piece.third(u) / (h * h * h)};
}

tl::expected<Path, std::string> wrapped(const Path& flat_path, const SurfaceLaw& surface) {
  const auto count = std::max<std::size_t>(
      64, static_cast<std::size_t>(flat_path.length_m() / std::max(flat_path.smoothing_m() / 3.0, 5e-6)));
  std::vector<PathNode> nodes;
  nodes.reserve(count + 1);
  for (std::size_t i = 0; i <= count; ++i) {
    const double s = flat_path.length_m() * static_cast<double>(i) / static_cast<double>(count);
    // The last node of a closed way is its first one.
    const PathPoint p = flat_path.at(flat_path.closed() && i == count ? 0.0 : s);
    const Surface h = surface(p.position_m.head<2>());
    const Vec2 t = p.first.head<2>();
    const Vec2 b = p.second.head<2>();
    PathNode node{s, p.position_m, p.first, p.second};
    node.position_m.z() += h.height_m;
    node.first.z() = h.slope.dot(t);
    node.second.z() = h.slope.dot(b) + t.dot(h.curvature * t);
    nodes.push_back(node);
  }
  return Path::through(nodes, flat_path.closed());
}

}  // namespace telekerf::machining
