// SPDX-License-Identifier: Apache-2.0
#include "common/geometry/elliptic_fourier.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "common/geometry/nearest.h"

namespace telekerf::geometry {
namespace {

constexpr std::size_t kMostHarmonics = 4096;

tl::expected<Polyline, std::string> checked(const Polyline& polygon, std::size_t harmonics) {
  if (!polygon.closed)
    return tl::unexpected<std::string>("elliptic Fourier descriptors need a closed contour");
  if (!all_finite(polygon.points_m))
    return tl::unexpected<std::string>("a coordinate of the contour is not finite");
  if (harmonics < 1 || harmonics > kMostHarmonics) {
    return tl::unexpected(fmt::format("{} harmonics: must lie within [1, {}]", harmonics, kMostHarmonics));
  }
  Polyline clean = without_duplicates(polygon);
  if (clean.size() < 3)
    return tl::unexpected<std::string>("the contour has fewer than three distinct points");
  return clean;
}

}  // namespace

Vec2 EllipticFourier::position(double theta) const noexcept {
  Vec2 p = centre;
  const double c1 = std::cos(theta);
  const double s1 = std::sin(theta);
  double c = 1.0;
  double s = 0.0;
  for (const Harmonic& h : harmonics) {
    const double next = c * c1 - s * s1;
    s = s * c1 + c * s1;
    c = next;
    p += Vec2(h.a * c + h.b * s, h.c * c + h.d * s);
  }
  return p;
}

CurveState EllipticFourier::at(double theta) const noexcept {
  CurveState out;
  out.position = centre;
  const double c1 = std::cos(theta);
  const double s1 = std::sin(theta);
  double c = 1.0;
  double s = 0.0;
  double k = 0.0;
  for (const Harmonic& h : harmonics) {
    const double next = c * c1 - s * s1;
    s = s * c1 + c * s1;
    c = next;
    k += 1.0;
    const Vec2 even(h.a * c + h.b * s, h.c * c + h.d * s);
    const Vec2 odd(h.b * c - h.a * s, h.d * c - h.c * s);
    out.position += even;
    out.first += k * odd;
    out.second -= k * k * even;
    out.third -= k * k * k * odd;
  }
  return out;
}

CurveState by_arc_length(const CurveState& r) noexcept {
  const double v2 = r.first.squaredNorm();
  if (!(v2 > 0.0)) return {r.position};
  const double v = std::sqrt(v2);
  const double r12 = r.first.dot(r.second);
  // theta by arc length: 3.2.4 made analytic (closed contours), here at unit speed.
  const double t1 = 1.0 / v;
  const double t2 = -r12 / (v2 * v2);
  const double t3 =
      (4.0 * r12 * r12 - v2 * (r.second.squaredNorm() + r.first.dot(r.third))) / (v2 * v2 * v2 * v);
  return {r.position, t1 * r.first, t1 * t1 * r.second + t2 * r.first,
          t1 * t1 * t1 * r.third + 3.0 * t1 * t2 * r.second + t3 * r.first};
}

CurveState by_time(const CurveState& r, double speed, double speed_rate, double speed_rate2) noexcept {
  return {r.position, speed * r.first, speed_rate * r.first + speed * speed * r.second,
          speed_rate2 * r.first + 3.0 * speed * speed_rate * r.second + speed * speed * speed * r.third};
}

tl::expected<EllipticFourier, std::string> fit_elliptic_fourier(const Polyline& polygon,
                                                                std::size_t harmonics) {
  const auto clean = checked(polygon, harmonics);
  if (!clean) return tl::unexpected(clean.error());
  const std::vector<double> t = arc_lengths(*clean);
  const double period = t.back();
  EllipticFourier out;
  out.harmonics.resize(harmonics);
  for (std::size_t i = 0; i < clean->segments(); ++i) {
    out.centre += 0.5 * (t[i + 1] - t[i]) / period * (clean->start_of(i) + clean->end_of(i));
  }
  for (std::size_t i = 0; i < clean->segments(); ++i) {
    const Vec2 slope = (clean->end_of(i) - clean->start_of(i)) / (t[i + 1] - t[i]);
    const double from = 2.0 * M_PI * t[i] / period;
    const double to = i + 1 == clean->segments() ? 0.0 : 2.0 * M_PI * t[i + 1] / period;
    for (std::size_t k = 1; k <= harmonics; ++k) {
      const auto n = static_cast<double>(k);
      const double gain = period / (2.0 * n * n * M_PI * M_PI);
      const double dc = gain * (std::cos(n * to) - std::cos(n * from));
      const double ds = gain * (std::sin(n * to) - std::sin(n * from));
      Harmonic& h = out.harmonics[k - 1];
      h.a += slope.x() * dc;
      h.b += slope.x() * ds;
      h.c += slope.y() * dc;
      h.d += slope.y() * ds;
    }
  }
  return out;
}

tl::expected<EllipticFourier, std::string> fit_elliptic_fourier_least_squares(const Polyline& polygon,
                                                                              std::size_t harmonics) {
  const auto clean = checked(polygon, harmonics);
  if (!clean) return tl::unexpected(clean.error());
  const std::size_t m = clean->size();
  if (m <= 2 * harmonics) {
    return tl::unexpected(fmt::format("{} harmonics need more than {} points, the contour has {}", harmonics,
                                      2 * harmonics, m));
  }
  EllipticFourier out;
  out.harmonics.resize(harmonics);
  for (const Vec2& p : clean->points_m) out.centre += p / static_cast<double>(m);
  const double gain = 2.0 / static_cast<double>(m);
  for (std::size_t k = 1; k <= harmonics; ++k) {
    Harmonic& h = out.harmonics[k - 1];
    for (std::size_t i = 0; i < m; ++i) {
      const double angle = 2.0 * M_PI * static_cast<double>(i * k % m) / static_cast<double>(m);
      const Vec2 p = clean->points_m[i] - out.centre;
      h.a += gain * p.x() * std::cos(angle);
      h.b += gain * p.x() * std::sin(angle);
      h.c += gain * p.y() * std::cos(angle);
      h.d += gain * p.y() * std::sin(angle);
    }
  }
  return out;
}

double largest_deviation_m(const EllipticFourier& curve, const Polyline& polygon) {
  const std::size_t samples = std::clamp<std::size_t>(24 * curve.harmonics.size(), 720, 8192);
  Polyline sampled{{}, true};
  sampled.points_m.reserve(samples);
  for (std::size_t i = 0; i < samples; ++i) {
    sampled.points_m.push_back(
        curve.position(2.0 * M_PI * static_cast<double>(i) / static_cast<double>(samples)));
  }
  const NearestIndex of_polygon(polygon);
  double worst = 0.0;
  for (const Vec2& p : sampled.points_m) worst = std::max(worst, of_polygon.find(p).distance_m);
  const NearestIndex of_curve(std::move(sampled));
  for (const Vec2& p : polygon.points_m) worst = std::max(worst, of_curve.find(p).distance_m);
  return worst;
}

tl::expected<ChosenHarmonics, std::string> choose_harmonics(const Polyline& polygon, double tolerance_m,
                                                            std::size_t most) {
  const auto full = fit_elliptic_fourier(polygon, std::max<std::size_t>(most, 1));
  if (!full) return tl::unexpected(full.error());
  // A truncated series has the same coefficients, so one fit serves every length.
  const auto cut = [&](std::size_t n) {
    ChosenHarmonics out{{full->centre, {full->harmonics.begin(), full->harmonics.begin() + n}}, 0.0, false};
    out.largest_deviation_m = largest_deviation_m(out.curve, polygon);
    out.reached = out.largest_deviation_m <= tolerance_m;
    return out;
  };
  std::size_t low = 0;
  std::size_t high = 1;
  ChosenHarmonics best = cut(high);
  while (!best.reached && high < full->harmonics.size()) {
    low = high;
    high = std::min(2 * high, full->harmonics.size());
    best = cut(high);
  }
  while (best.reached && high - low > 1) {
    const std::size_t middle = (low + high) / 2;
    ChosenHarmonics candidate = cut(middle);
    if (candidate.reached) {
      best = std::move(candidate);
      high = middle;
    } else {
      low = middle;
    }
  }
  return best;
}

tl::expected<Normalised, std::string> normalised(const EllipticFourier& curve) {
  if (curve.harmonics.empty())
    return tl::unexpected<std::string>("there is no first harmonic to normalise by");
  const Harmonic& h = curve.harmonics[0];
  Normalised out;
  // Kuhl and Giardina: the phase at which |(x, y)| of the first ellipse is largest.
  out.phase_rad =
      0.5 * std::atan2(2.0 * (h.a * h.b + h.c * h.d), h.a * h.a + h.c * h.c - h.b * h.b - h.d * h.d);
  const double cos1 = std::cos(out.phase_rad);
  const double sin1 = std::sin(out.phase_rad);
  const Vec2 major(h.a * cos1 + h.b * sin1, h.c * cos1 + h.d * sin1);
  const Vec2 minor(h.b * cos1 - h.a * sin1, h.d * cos1 - h.c * sin1);
  out.semi_major_m = major.norm();
  out.axis_ratio = minor.norm() > 0.0 ? major.norm() / minor.norm() : INFINITY;
  if (!(out.semi_major_m > 0.0) || out.axis_ratio <= 1.05) {
    return tl::unexpected(
        fmt::format("the first ellipse is a circle (axis ratio {:.4f}, needs more than 1.05), so the "
                    "descriptors have no normal start point and rotation",
                    out.axis_ratio));
  }
  out.rotation_rad = std::atan2(major.y(), major.x());
  const double c = std::cos(out.rotation_rad);
  const double s = std::sin(out.rotation_rad);
  double largest_even = 0.0;
  out.curve.harmonics.resize(curve.harmonics.size());
  for (std::size_t i = 0; i < curve.harmonics.size(); ++i) {
    const Harmonic& in = curve.harmonics[i];
    const double k = static_cast<double>(i + 1) * out.phase_rad;
    const double ck = std::cos(k);
    const double sk = std::sin(k);
    const Harmonic shifted{in.a * ck + in.b * sk, in.b * ck - in.a * sk, in.c * ck + in.d * sk,
                           in.d * ck - in.c * sk};
    Harmonic& n = out.curve.harmonics[i];
    n = {c * shifted.a + s * shifted.c, c * shifted.b + s * shifted.d, c * shifted.c - s * shifted.a,
         c * shifted.d - s * shifted.b};
    if (i % 2 == 1) {
      for (const double value : {n.a, n.b, n.c, n.d}) {
        if (std::abs(value) > std::abs(largest_even)) largest_even = value;
      }
    }
  }
  if (largest_even < 0.0) {
    // Half a round further and turned by pi: odd orders stay, even ones change their sign.
    out.phase_rad += M_PI;
    out.rotation_rad += out.rotation_rad > 0.0 ? -M_PI : M_PI;
    for (std::size_t i = 1; i < out.curve.harmonics.size(); i += 2) {
      Harmonic& n = out.curve.harmonics[i];
      n = {-n.a, -n.b, -n.c, -n.d};
    }
  }
  return out;
}

EllipticFourierPath::EllipticFourierPath(EllipticFourier curve) : curve_(std::move(curve)) {
  const std::size_t steps = std::clamp<std::size_t>(32 * curve_.harmonics.size(), 512, 32768);
  arc_.assign(steps + 1, 0.0);
  for (std::size_t i = 0; i < steps; ++i) {
    const double step = 2.0 * M_PI / static_cast<double>(steps);
    arc_[i + 1] = arc_[i] + arc_between(static_cast<double>(i) * step, static_cast<double>(i + 1) * step);
  }
}

double EllipticFourierPath::arc_between(double theta_from, double theta_to) const noexcept {
  // Five-point Gauss-Legendre: the steps are far shorter than the highest harmonic's period.
  constexpr std::array<std::pair<double, double>, 3> kGauss{{{0.0, 0.5688888888888889},
                                                             {0.5384693101056831, 0.4786286704993665},
                                                             {0.9061798459386640, 0.2369268850561891}}};
  const double half = 0.5 * (theta_to - theta_from);
  const double middle = 0.5 * (theta_to + theta_from);
  double sum = kGauss[0].second * curve_.at(middle).first.norm();
  for (int i = 1; i < 3; ++i) {
    sum += kGauss[i].second * (curve_.at(middle + half * kGauss[i].first).first.norm() +
                               curve_.at(middle - half * kGauss[i].first).first.norm());
  }
  return half * sum;
}

double EllipticFourierPath::theta_at(double arc_length_m) const noexcept {
  const double length = arc_.back();
  if (!(length > 0.0)) return 0.0;
  double s = std::fmod(arc_length_m, length);
  if (s < 0.0) s += length;
  const auto above = std::upper_bound(arc_.begin() + 1, arc_.end() - 1, s);
  const auto i = static_cast<std::size_t>(above - arc_.begin()) - 1;
  const double step = 2.0 * M_PI / static_cast<double>(arc_.size() - 1);
  const double from = static_cast<double>(i) * step;
  const double span = arc_[i + 1] - arc_[i];
  double theta = from + (span > 0.0 ? step * (s - arc_[i]) / span : 0.0);
  for (int iteration = 0; iteration < 3; ++iteration) {
    const double speed = curve_.at(theta).first.norm();
    if (!(speed > 0.0)) break;
    theta = std::clamp(theta - (arc_[i] + arc_between(from, theta) - s) / speed, from, from + step);
  }
  return theta;
}

}  // namespace telekerf::geometry
