// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <random>

#include "common/geometry/cubic_spline.h"
#include "common/geometry/curve_sampling.h"
#include "common/geometry/elliptic_fourier.h"

namespace telekerf::geometry {
namespace {

Polyline wavy(int points, unsigned seed) {
  std::mt19937_64 rng(seed);
  std::uniform_real_distribution<double> u(0.3, 1.0);
  Polyline out{{}, true};
  for (int i = 0; i < points; ++i) {
    const double a = 2.0 * M_PI * i / points;
    const double r = 0.01 * (1.0 + 0.2 * std::cos(2 * a + 1) + 0.1 * std::sin(3 * a)) + 2e-4 * u(rng);
    out.points_m.emplace_back(1.6 * r * std::cos(a), r * std::sin(a));
  }
  return out;
}

Polyline rotated(const Polyline& line, double angle) {
  Polyline out = line;
  const Eigen::Rotation2D<double> turn(angle);
  for (Vec2& p : out.points_m) p = turn * p;
  return out;
}

TEST(EllipticFourier, SquareHasItsTextbookCoefficients) {
  const auto efd = fit_elliptic_fourier({{{0, 0}, {1, 0}, {1, 1}, {0, 1}}, true}, 40);
  ASSERT_TRUE(efd);
  EXPECT_NEAR((efd->centre - Vec2(0.5, 0.5)).norm(), 0.0, 1e-15);
  for (std::size_t k = 1; k <= 40; ++k) {
    const double expected = k % 2 == 1 ? 4.0 / (M_PI * M_PI * double(k * k)) : 0.0;
    const Harmonic& h = efd->harmonics[k - 1];
    for (const double value : {h.a, h.b, h.c, h.d}) {
      if (k % 2 == 0) {
        EXPECT_NEAR(value, 0.0, 1e-12);
      }
    }
    EXPECT_NEAR(std::abs(h.a), expected, 1e-12) << k;
    EXPECT_NEAR(std::abs(h.d), expected, 1e-12) << k;
  }
}

TEST(EllipticFourier, LeastSquaresDiffersFromTheIntegralBySincSquared) {
  Polyline ring{{}, true};
  constexpr int kPoints = 24;
  for (int i = 0; i < kPoints; ++i) {
    const double a = 2.0 * M_PI * i / kPoints;
    ring.points_m.emplace_back(2.0 * std::cos(a), 2.0 * std::sin(a));
  }
  const auto integral = fit_elliptic_fourier(ring, 5);
  const auto samples = fit_elliptic_fourier_least_squares(ring, 5);
  ASSERT_TRUE(integral && samples);
  EXPECT_NEAR(samples->harmonics[0].a, 2.0, 1e-14);
  EXPECT_NEAR(integral->harmonics[0].a, 2.0 * std::pow(std::sin(M_PI / kPoints) / (M_PI / kPoints), 2),
              1e-14);
  EXPECT_NEAR(integral->harmonics[0].a, 1.98860291252711, 1e-13);
}

TEST(EllipticFourier, DerivativesAgreeWithDifferences) {
  const auto efd = fit_elliptic_fourier(wavy(300, 1), 8);
  ASSERT_TRUE(efd);
  const double h = 1e-5;
  for (double theta = 0.0; theta < 6.28; theta += 0.37) {
    const CurveState s = efd->at(theta);
    const CurveState before = efd->at(theta - h);
    const CurveState after = efd->at(theta + h);
    EXPECT_LT((s.position - efd->position(theta)).norm(), 1e-15);
    EXPECT_LT(((after.position - before.position) / (2 * h) - s.first).norm(), 1e-8);
    EXPECT_LT(((after.first - before.first) / (2 * h) - s.second).norm(), 1e-8);
    EXPECT_LT(((after.second - before.second) / (2 * h) - s.third).norm(), 1e-7);
  }
}

TEST(EllipticFourier, RunsAtItsSpeedWithExactDerivatives) {
  const auto efd = fit_elliptic_fourier(wavy(300, 2), 10);
  ASSERT_TRUE(efd);
  const EllipticFourierPath path(*efd);
  const double v = 0.05;
  for (double s = -0.01; s < 0.2; s += 3.1e-3) {
    const CurveState x = by_time(path.at(s), v);
    EXPECT_NEAR(x.first.norm(), v, 1e-12);
    const double dt = 1e-4;
    const CurveState before = by_time(path.at(s - v * dt), v);
    const CurveState after = by_time(path.at(s + v * dt), v);
    EXPECT_LT(((after.position - before.position) / (2 * dt) - x.first).norm(), 1e-4 * v);
    EXPECT_LT(((after.first - before.first) / (2 * dt) - x.second).norm(), 1e-4 * x.second.norm() + 1e-3);
    EXPECT_LT(((after.second - before.second) / (2 * dt) - x.third).norm(), 1e-3 * x.third.norm() + 0.05);
  }
  // A changing speed: s(t) = v t + t^2, against differences of the position alone.
  const double t = 0.4;
  const auto position = [&](double time) { return path.at(v * time + time * time).position; };
  const CurveState x = by_time(path.at(v * t + t * t), v + 2 * t, 2.0, 0.0);
  const double h = 1e-3;
  EXPECT_LT(((position(t + h) - 2 * position(t) + position(t - h)) / (h * h) - x.second).norm(),
            1e-2 * x.second.norm());
}

TEST(EllipticFourier, DistanceTravelledIsInvertedExactly) {
  const auto efd = fit_elliptic_fourier(wavy(200, 3), 12);
  ASSERT_TRUE(efd);
  const EllipticFourierPath path(*efd);
  // Length by a fine polygon, Richardson extrapolated.
  const auto polygon_length = [&](int n) {
    Polyline fine{{}, true};
    for (int i = 0; i < n; ++i) fine.points_m.push_back(efd->position(2 * M_PI * i / n));
    return length_m(fine);
  };
  const double truth = (4.0 * polygon_length(40000) - polygon_length(20000)) / 3.0;
  EXPECT_NEAR(path.length_m(), truth, 1e-11);
  EXPECT_NEAR(path.theta_at(path.length_m()), 0.0, 1e-9);
  double last = -1.0;
  for (int i = 0; i < 1000; ++i) {
    const double theta = path.theta_at(path.length_m() * i / 1000.0);
    EXPECT_GT(theta, last);
    last = theta;
  }
}

TEST(EllipticFourier, NormalisedDescriptorsIgnoreRotationAndStart) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const Polyline shape = wavy(180, seed);
    const auto reference = normalised(*fit_elliptic_fourier(shape, 20));
    ASSERT_TRUE(reference) << reference.error();
    EXPECT_GT(reference->axis_ratio, 1.05);
    const double size = reference->semi_major_m;
    for (int i = 0; i < 40; ++i) {
      const auto other =
          normalised(*fit_elliptic_fourier(rotated(started_at(shape, i * 4 % 180), 0.157 * i), 20));
      ASSERT_TRUE(other);
      for (std::size_t k = 0; k < 20; ++k) {
        const Harmonic& a = reference->curve.harmonics[k];
        const Harmonic& b = other->curve.harmonics[k];
        EXPECT_LT(std::abs(a.a - b.a) + std::abs(a.b - b.b) + std::abs(a.c - b.c) + std::abs(a.d - b.d),
                  1e-9 * size)
            << "seed " << seed << " start " << i * 4 % 180 << " harmonic " << k + 1;
      }
    }
    EXPECT_NEAR(reference->curve.harmonics[0].c, 0.0, 1e-12);
    EXPECT_GT(reference->curve.harmonics[0].a, 0.0);
  }
}

TEST(EllipticFourier, ANormalFormIsTheCurveTurnedBackFromItsNewStart) {
  for (unsigned seed = 1; seed <= 8; ++seed) {
    const auto curve = *fit_elliptic_fourier(rotated(wavy(180, seed), 0.8 * seed), 12);
    const auto normal = normalised(curve);
    ASSERT_TRUE(normal);
    const Eigen::Rotation2D<double> back(-normal->rotation_rad);
    for (double theta = 0.0; theta < 6.28; theta += 0.5) {
      const Vec2 expected = back * (curve.position(normal->phase_rad + theta) - curve.centre);
      EXPECT_LT((normal->curve.position(theta) - expected).norm(), 1e-12) << seed << " " << theta;
    }
    EXPECT_NEAR(normal->semi_major_m, normal->curve.harmonics[0].a, 1e-12);
  }
  for (const double ratio : {1.04, 1.06}) {
    const EllipticFourier ellipse{Vec2::Zero(), {{ratio, 0, 0, 1}}};
    EXPECT_EQ(normalised(ellipse).has_value(), ratio > 1.05);
  }
}

TEST(EllipticFourier, ARoundShapeHasNoNormalForm) {
  Polyline ring{{}, true};
  for (int i = 0; i < 90; ++i) ring.points_m.emplace_back(std::cos(i * M_PI / 45), std::sin(i * M_PI / 45));
  const auto result = normalised(*fit_elliptic_fourier(ring, 5));
  ASSERT_FALSE(result);
  EXPECT_NE(result.error().find("1.05"), std::string::npos);
}

TEST(EllipticFourier, HarmonicsAreChosenByTheLargestDeviation) {
  const Polyline shape = resampled(wavy(400, 6), 1e-4);
  const auto chosen = choose_harmonics(shape, 5e-5);
  ASSERT_TRUE(chosen);
  EXPECT_TRUE(chosen->reached);
  EXPECT_LE(chosen->largest_deviation_m, 5e-5);
  ASSERT_GT(chosen->curve.harmonics.size(), 1u);
  EXPECT_GT(largest_deviation_m(*fit_elliptic_fourier(shape, chosen->curve.harmonics.size() - 1), shape),
            5e-5);
  EXPECT_FALSE(choose_harmonics(shape, 1e-12, 8)->reached);
  // 30 harmonics round the corners of a 10 mm square by about 95 um.
  const Polyline square = resampled({{{0, 0}, {0.01, 0}, {0.01, 0.01}, {0, 0.01}}, true}, 1e-5);
  EXPECT_NEAR(largest_deviation_m(*fit_elliptic_fourier(square, 30), square), 95e-6, 5e-6);
}

TEST(EllipticFourier, BadInputIsAnError) {
  const Polyline square{{{0, 0}, {1, 0}, {1, 1}, {0, 1}}, true};
  EXPECT_FALSE(fit_elliptic_fourier({square.points_m, false}, 3));
  EXPECT_FALSE(fit_elliptic_fourier(square, 0));
  EXPECT_FALSE(fit_elliptic_fourier(square, 1'000'000));
  EXPECT_FALSE(fit_elliptic_fourier({{{0, 0}, {1, 0}, {0, 0}}, true}, 3));
  EXPECT_FALSE(fit_elliptic_fourier({{{0, 0}, {NAN, 0}, {0, 1}}, true}, 3));
  EXPECT_FALSE(fit_elliptic_fourier_least_squares(square, 2));
  // Repeated points change nothing.
  const auto twice =
      fit_elliptic_fourier({{{0, 0}, {0, 0}, {1, 0}, {1, 1}, {1, 1}, {0, 1}, {0, 0}}, true}, 3);
  const auto once = fit_elliptic_fourier(square, 3);
  EXPECT_EQ(twice->harmonics[2].a, once->harmonics[2].a);
}

TEST(Doubling, CountsAndQuadratics) {
  std::mt19937_64 rng(1);
  std::uniform_real_distribution<double> u(-1.0, 1.0);
  for (std::size_t n = 3; n < 12; ++n) {
    Polyline line{{}, false};
    const Vec2 a(u(rng), u(rng)), b(u(rng), u(rng)), c(u(rng), u(rng));
    const auto parabola = [&](double t) { return Vec2(a + b * t + c * t * t); };
    for (std::size_t i = 0; i < n; ++i) line.points_m.push_back(parabola(double(i)));
    for (int k = 0; k <= 4; ++k) {
      const Polyline fine = doubled(line, k);
      ASSERT_EQ(fine.size(), (std::size_t{1} << k) * (n - 1) + 1);  // eq. 5
      for (std::size_t i = 0; i < fine.size(); ++i) {
        EXPECT_LT((fine.points_m[i] - parabola(double(i) / (1 << k))).norm(), 1e-11);
      }
    }
    line.closed = true;
    EXPECT_EQ(doubled(line, 3).size(), 8 * n);
  }
  EXPECT_EQ(doubled({{{0, 0}, {1, 1}}, false}, 5).size(), 2u);
}

TEST(Stepping, ChordsAreExactOnARandomPath) {
  const Polyline line{wavy(500, 4).points_m, false};
  const StepSettings settings{.period_s = 1e-3};
  const auto steps = chord_steps(line, constant_speed(0.008), settings);
  ASSERT_TRUE(steps);
  for (std::size_t i = 1; i + 1 < steps->points_m.size(); ++i) {
    EXPECT_NEAR((steps->points_m[i] - steps->points_m[i - 1]).norm(), 8e-6, 8e-6 * 1e-11);
    EXPECT_GT(steps->arc_lengths_m[i], steps->arc_lengths_m[i - 1]);
  }
  EXPECT_EQ(steps->points_m.back(), line.points_m.back());
  EXPECT_LE((steps->points_m.back() - *(steps->points_m.end() - 2)).norm(), 8e-6);
}

TEST(Stepping, ArcStepsFollowASpeedThatVaries) {
  const Polyline line = wavy(500, 5);
  const auto speed = [](double t, double s) { return 0.004 + 0.002 * std::sin(7.0 * t) + 0.05 * s; };
  const auto steps = arc_steps(line, speed, {.period_s = 1e-3});
  ASSERT_TRUE(steps);
  for (std::size_t i = 1; i + 1 < steps->points_m.size(); ++i) {
    const double wanted = 1e-3 * speed(1e-3 * double(i - 1), steps->arc_lengths_m[i - 1]);
    EXPECT_NEAR(steps->arc_lengths_m[i] - steps->arc_lengths_m[i - 1], wanted, 1e-15);
  }
  EXPECT_EQ(steps->points_m.back(), line.points_m.front());
}

TEST(Stepping, StretchingLeavesNoShortStep) {
  const Polyline line = wavy(300, 6);
  const StepSettings settings{.period_s = 1e-3, .remainder = Remainder::kStretch};
  for (const bool chords : {true, false}) {
    const auto steps = chords ? chord_steps(line, constant_speed(0.0371), settings)
                              : arc_steps(line, constant_speed(0.0371), settings);
    ASSERT_TRUE(steps);
    EXPECT_NEAR(steps->speed_scale, 1.0, 1e-3);
    const double r = 0.0371e-3 * steps->speed_scale;
    for (std::size_t i = 1; i < steps->points_m.size(); ++i) {
      const double step = chords ? (steps->points_m[i] - steps->points_m[i - 1]).norm()
                                 : steps->arc_lengths_m[i] - steps->arc_lengths_m[i - 1];
      EXPECT_NEAR(step, r, 1e-6 * r) << i << " of " << steps->points_m.size();
    }
  }
}

TEST(Stepping, ArcExcessOfAChordIsAsPredicted) {
  Polyline ring{{}, true};
  constexpr double kRadius = 5e-3;
  for (int i = 0; i < 200000; ++i) {
    const double a = 2 * M_PI * i / 200000;
    ring.points_m.emplace_back(kRadius * std::cos(a), kRadius * std::sin(a));
  }
  const auto steps = chord_steps(ring, constant_speed(0.5), {.period_s = 1e-3});
  ASSERT_TRUE(steps);
  const double arc = (steps->arc_lengths_m[10] - steps->arc_lengths_m[0]) / 10;
  const double ratio = 0.5e-3 / kRadius;
  const double excess =
      ratio * ratio / 24 + 3 * std::pow(ratio, 4) / 640;  // R^2 / (24 rho^2) and its next term
  EXPECT_NEAR(arc / 0.5e-3 - 1.0, excess, 2e-8);
}

TEST(Stepping, RefusesWhatHasNoEnd) {
  const Polyline line{{{0, 0}, {1, 0}}, false};
  EXPECT_FALSE(arc_steps(line, constant_speed(0.0), {}));
  EXPECT_FALSE(arc_steps(line, constant_speed(NAN), {}));
  EXPECT_FALSE(arc_steps(line, constant_speed(1e-6), {.max_steps = 1000}));
  EXPECT_FALSE(arc_steps({{{0, 0}, {0, 0}}, false}, constant_speed(1.0), {}));
  EXPECT_FALSE(chord_steps({{{0, 0}, {NAN, 0}}, false}, constant_speed(1.0), {}));
}

TEST(JointSpace, NamesThePointOutOfReach) {
  const InverseKinematics inverse = [](const Eigen::Vector3d& tool, Eigen::Vector3d& joints) {
    joints = 2.0 * tool;
    return tool.x() < 0.5;
  };
  const auto good = to_joint_space({{0.1, 0.2}, {0.3, 0.4}}, 0.09, inverse);
  ASSERT_TRUE(good);
  EXPECT_EQ((*good)[1], Eigen::Vector3d(0.6, 0.8, 0.18));
  const auto bad = to_joint_space({{0.1, 0.2}, {0.6, 0.4}}, 0.09, inverse);
  ASSERT_FALSE(bad);
  EXPECT_NE(bad.error().find("point 1"), std::string::npos);
}

using Spline = CubicSpline<2>;

TEST(CubicSpline, ReproducesCubicsWithAllDerivatives) {
  const auto f = [](double t) { return Vec2(1 + t - 2 * t * t + 0.5 * t * t * t, 3 - t * t * t); };
  std::vector<double> times{0.0, 0.3, 0.5, 1.1, 1.2, 2.0};
  std::vector<Vec2> values;
  values.reserve(times.size());
  for (const double t : times) values.push_back(f(t));
  const auto spline = Spline::through(times, values);
  ASSERT_TRUE(spline);
  for (double t = 0.0; t <= 2.0; t += 0.05) {
    const auto s = spline->at(t);
    EXPECT_LT((s.position - f(t)).norm(), 1e-12);
    EXPECT_LT((s.velocity - Vec2(1 - 4 * t + 1.5 * t * t, -3 * t * t)).norm(), 1e-11);
    EXPECT_LT((s.acceleration - Vec2(-4 + 3 * t, -6 * t)).norm(), 1e-10);
    EXPECT_LT((s.jerk - Vec2(3, -6)).norm(), 1e-9);
  }
}

TEST(CubicSpline, IsTwiceContinuousThroughItsKnots) {
  std::mt19937_64 rng(8);
  std::uniform_real_distribution<double> u(0.1, 1.0);
  for (const SplineEnds ends : {SplineEnds::kNotAKnot, SplineEnds::kAtRest, SplineEnds::kPeriodic}) {
    for (int n = 3; n < 40; ++n) {
      std::vector<double> times{0.0};
      std::vector<Vec2> values{{u(rng), u(rng)}};
      for (int i = 1; i < n; ++i) {
        times.push_back(times.back() + u(rng));
        values.emplace_back(u(rng), u(rng));
      }
      if (ends == SplineEnds::kPeriodic) values.back() = values.front();
      const auto spline = Spline::through(times, values, ends);
      ASSERT_TRUE(spline);
      for (int i = 0; i < n; ++i) EXPECT_LT((spline->at(times[i]).position - values[i]).norm(), 1e-12);
      for (int i = 1; i + 1 < n; ++i) {
        const auto before = spline->at(times[i] - 1e-9);
        const auto after = spline->at(times[i] + 1e-9);
        EXPECT_LT((before.velocity - after.velocity).norm(), 1e-5);
        EXPECT_LT((before.acceleration - after.acceleration).norm(), 1e-4) << n;
      }
      if (ends == SplineEnds::kAtRest) {
        EXPECT_LT(spline->at(0.0).velocity.norm() + spline->at(times.back()).velocity.norm(), 1e-9);
      }
      if (ends == SplineEnds::kPeriodic) {
        EXPECT_LT((spline->at(0.0).velocity - spline->at(times.back()).velocity).norm(), 1e-9);
        EXPECT_LT((spline->at(0.0).acceleration - spline->at(times.back()).acceleration).norm(), 1e-8) << n;
      }
    }
  }
}

TEST(CubicSpline, RefusesBadKnots) {
  EXPECT_FALSE(Spline::through({0.0}, {{0, 0}}));
  EXPECT_FALSE(Spline::through({0.0, 0.0}, {{0, 0}, {1, 1}}));
  EXPECT_FALSE(Spline::through({0.0, 1.0}, {{0, 0}, {NAN, 1}}));
  EXPECT_EQ(Spline::through({0.0, 1.0}, {{0, 0}, {1, 1}})->at(0.5).position, Vec2(0.5, 0.5));
}

}  // namespace
}  // namespace telekerf::geometry
