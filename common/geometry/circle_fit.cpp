// SPDX-License-Identifier: Apache-2.0
#include "common/geometry/circle_fit.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace telekerf::geometry {

Window window(const Polyline& line, std::size_t m, std::size_t k) noexcept {
  Window out;
  const std::size_t n = line.size();
  if (n == 0) return out;
  m = std::min(m, n - 1);
  k = std::min({k, kMaxHalfWindow, (n - 1) / 2});
  out.count = 2 * k + 1;
  const std::size_t first = line.closed ? m + n - k : std::clamp(m, k, n - 1 - k) - k;
  for (std::size_t i = 0; i < out.count; ++i) out.points[i] = line.points_m[(first + i) % n];
  return out;
}

double CircleOrLine::curvature() const noexcept {
  if (is_line) return 0.0;
  return (anticlockwise ? 1.0 : -1.0) / radius_m;
}

double CircleOrLine::phi(const Vec2& x) const noexcept {
  if (is_line) return cross(direction, x - point_m);
  const double outside = (x - centre_m).norm() - radius_m;
  return anticlockwise ? -outside : outside;
}

Vec2 CircleOrLine::gradient(const Vec2& x) const noexcept {
  Vec2 left(-direction.y(), direction.x());
  if (is_line) return left;
  const Vec2 d = x - centre_m;
  const double distance = d.norm();
  if (distance <= 1e-12 * radius_m) return left;
  return (anticlockwise ? -1.0 : 1.0) / distance * d;
}

Eigen::Matrix2d CircleOrLine::hessian(const Vec2& x) const noexcept {
  const double distance = (x - centre_m).norm();
  if (is_line || distance <= 1e-12 * radius_m) return Eigen::Matrix2d::Zero();
  const Vec2 t = tangent(x);
  return (anticlockwise ? -1.0 : 1.0) / distance * (t * t.transpose());
}

Vec2 CircleOrLine::tangent(const Vec2& x) const noexcept {
  const Vec2 g = gradient(x);
  return {g.y(), -g.x()};
}

Vec2 CircleOrLine::project(const Vec2& x) const noexcept { return x - phi(x) * gradient(x); }

CircleOrLine osculating(const Vec2& point, const Vec2& tangent, double curvature) noexcept {
  CircleOrLine out;
  out.point_m = point;
  out.direction = tangent;
  out.is_line = std::abs(curvature) < 1e-3;
  if (out.is_line) return out;
  out.anticlockwise = curvature > 0.0;
  out.radius_m = 1.0 / std::abs(curvature);
  out.centre_m = point + Vec2(-tangent.y(), tangent.x()) / curvature;
  return out;
}

CircleOrLine fit_circle(std::span<const Vec2> points) noexcept { return fit_circle(points, {}); }

CircleOrLine fit_circle(std::span<const Vec2> points, std::span<const double> weights) noexcept {
  CircleOrLine out;
  if (points.empty()) return out;
  double sum = 0.0;
  for (const double w : weights) sum += w;
  const double even = 1.0 / static_cast<double>(points.size());
  const auto share = [&](std::size_t i) { return sum > 0.0 ? weights[i] / sum : even; };

  Vec2 mean = Vec2::Zero();
  for (std::size_t i = 0; i < points.size(); ++i) mean += share(i) * points[i];
  double spread = 0.0;
  for (std::size_t i = 0; i < points.size(); ++i) spread += share(i) * (points[i] - mean).squaredNorm();
  const double scale = std::sqrt(spread);
  out.point_m = mean;
  if (!(scale > 0.0)) return out;

  // Travel: the sum of steps weighted towards nothing is the chord; on (nearly) closed sets the first step
  // decides.
  Vec2 travel = points.back() - points.front();
  if (travel.norm() < 1e-3 * scale) travel = points[1] - points[0];

  // Centred and scaled, z = |p|^2 has mean 1, and Taubin's constraint 4 A^2 + B^2 + C^2 = 1 turns the fit of
  // A (z - 1) + B x + C y = 0 into the smallest eigenvector of a 3x3 matrix. A = 0 is the straight line:
  // nothing is ill-conditioned there, because z and x are independent on it.
  Eigen::Matrix3d gram = Eigen::Matrix3d::Zero();
  double extent = 0.0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec2 u = (points[i] - mean) / scale;
    const Eigen::Vector3d row(0.5 * (u.squaredNorm() - 1.0), u.x(), u.y());
    gram += share(i) * row * row.transpose();
    extent = std::max(extent, u.norm());
  }
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(gram);
  const Eigen::Vector3d v = solver.eigenvectors().col(0);
  const double a = 0.5 * v[0];
  Vec2 normal(v[1], v[2]);
  const double discriminant = std::sqrt(normal.squaredNorm() + 4.0 * a * a);  // of the radius, D = -A
  const double bend = std::abs(a) * extent * extent;  // sagitta, as |normal| is about 1

  if (points.size() < 3 || bend <= 1e-7 * extent * normal.norm() || !std::isfinite(discriminant)) {
    // The direction of largest spread, from the plain 2x2 covariance: better than `normal` for two points.
    const Eigen::Matrix2d covariance = gram.bottomRightCorner<2, 2>();
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes(covariance);
    out.direction = axes.eigenvectors().col(1);
    if (out.direction.dot(travel) < 0.0) out.direction = -out.direction;
    out.residual_m = scale * std::sqrt(std::max(0.0, axes.eigenvalues()[0]));
    return out;
  }

  out.is_line = false;
  out.centre_m = mean - scale / (2.0 * a) * normal;
  out.radius_m = scale * discriminant / (2.0 * std::abs(a));
  // Turning sense from the swept angle, which is right for any share of the circle.
  double swept = 0.0;
  for (std::size_t i = 1; i < points.size(); ++i) {
    const Vec2 from = points[i - 1] - out.centre_m;
    const Vec2 to = points[i] - out.centre_m;
    swept += std::atan2(cross(from, to), from.dot(to));
  }
  out.anticlockwise = swept >= 0.0;
  const Vec2& middle = points[points.size() / 2];
  Vec2 outwards = middle - out.centre_m;
  const double distance = outwards.norm();
  outwards = distance > 0.0 ? Vec2(outwards / distance) : Vec2::UnitX();
  out.point_m = out.centre_m + out.radius_m * outwards;
  out.direction = Vec2(-outwards.y(), outwards.x()) * (out.anticlockwise ? 1.0 : -1.0);
  double squares = 0.0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double e = (points[i] - out.centre_m).norm() - out.radius_m;
    squares += share(i) * e * e;
  }
  out.residual_m = std::sqrt(squares);
  return out;
}

}  // namespace telekerf::geometry
