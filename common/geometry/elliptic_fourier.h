// SPDX-License-Identifier: Apache-2.0
// Elliptic Fourier descriptors: a closed contour as a sum of ellipses (thesis 3.2.2, eq. 8-9).
#pragma once

#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "common/geometry/polyline.h"

namespace telekerf::geometry {

/// Coefficients of one harmonic of eq. 8-9: x gets a cos + b sin, y gets c cos + d sin.
struct Harmonic {
  double a = 0.0;
  double b = 0.0;
  double c = 0.0;
  double d = 0.0;
};

/// A point of a curve and its derivatives by the curve's own parameter, or by time.
struct CurveState {
  Vec2 position = Vec2::Zero();
  Vec2 first = Vec2::Zero();
  Vec2 second = Vec2::Zero();
  Vec2 third = Vec2::Zero();
};

struct EllipticFourier {
  Vec2 centre = Vec2::Zero();       ///< (a0, c0)
  std::vector<Harmonic> harmonics;  ///< k = 1 .. n

  /// Position and derivatives by theta in [0, 2 pi). Real-time: noexcept, no allocation, O(n).
  CurveState at(double theta) const noexcept;
  Vec2 position(double theta) const noexcept;
};

/// Derivatives of a curve by arc length, from those by any parameter (they do not exist where first = 0).
CurveState by_arc_length(const CurveState& state) noexcept;
/// Derivatives by time of a point that runs along with speed V(t), from those by arc length:
/// second = V' r_s + V^2 r_ss, third = V'' r_s + 3 V V' r_ss + V^3 r_sss.
CurveState by_time(const CurveState& by_arc, double speed, double speed_rate = 0.0,
                   double speed_rate2 = 0.0) noexcept;

/// Kuhl and Giardina's integrals over the closed polygon: exact, parametrised by arc length. Zero-length
/// segments are dropped. Errors: open, fewer than three distinct points, coordinates that are not finite, n
/// outside 1..4096.
tl::expected<EllipticFourier, std::string> fit_elliptic_fourier(const Polyline& polygon,
                                                                std::size_t harmonics);

/// Least squares on equally spaced points, which is a discrete Fourier transform; for a polygon of M equal
/// chords its coefficient k is the integral's divided by sinc^2(pi k / M). Needs more than 2 n points.
tl::expected<EllipticFourier, std::string> fit_elliptic_fourier_least_squares(const Polyline& polygon,
                                                                              std::size_t harmonics);

/// Largest distance between polygon and curve, looked at from both (Hausdorff, sampled).
double largest_deviation_m(const EllipticFourier& curve, const Polyline& polygon);

struct ChosenHarmonics {
  EllipticFourier curve;
  double largest_deviation_m = 0.0;
  bool reached = false;  ///< false: `most` harmonics were not enough
};
/// The fewest harmonics (found by doubling and halving) that keep the largest deviation within the tolerance.
/// Shares of the power mislead: 99.99 % of it leaves 4.8 % of corner error on a square.
tl::expected<ChosenHarmonics, std::string> choose_harmonics(const Polyline& polygon, double tolerance_m,
                                                            std::size_t most = 256);

/// Start point at the end of the first ellipse's long axis, and that axis turned onto x. Of the two ends (pi
/// apart) the one is taken that makes the largest coefficient of even order positive.
struct Normalised {
  EllipticFourier curve;      ///< centre at the origin, size unchanged
  double phase_rad = 0.0;     ///< the parameter of the new start point
  double rotation_rad = 0.0;  ///< of the long axis, before
  double semi_major_m = 0.0;
  double axis_ratio = 1.0;
};
/// Error when the first ellipse is too round (axis ratio up to 1.05): then it has no long axis to speak of.
tl::expected<Normalised, std::string> normalised(const EllipticFourier& curve);

/// The curve by distance travelled, for time parametrisation at any speed.
class EllipticFourierPath {
 public:
  explicit EllipticFourierPath(EllipticFourier curve);

  double length_m() const noexcept { return arc_.back(); }
  const EllipticFourier& curve() const noexcept { return curve_; }
  /// Parameter at a distance travelled (wraps). Real-time; exact to about 1e-12 of the length.
  double theta_at(double arc_length_m) const noexcept;
  /// Position and derivatives by arc length.
  CurveState at(double arc_length_m) const noexcept {
    return by_arc_length(curve_.at(theta_at(arc_length_m)));
  }

 private:
  double arc_between(double theta_from, double theta_to) const noexcept;

  EllipticFourier curve_;
  std::vector<double> arc_;  ///< at equal steps of theta
};

}  // namespace telekerf::geometry
