// SPDX-License-Identifier: Apache-2.0
// The guide's parts, each against its closed form.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "master/constraint/guide_curve.h"
#include "master/constraint/guide_path.h"
#include "tests/unit/master/contours.h"

namespace telekerf::master {
namespace {

using namespace testing;
using geometry::Polyline;

constexpr double kSpacing_m = 25e-6;

ConstraintSettings plain_points() {
  ConstraintSettings settings;
  settings.rounding_m = 0.0;
  settings.min_radius_m = 0.0;
  return settings;
}

/// Sum of the Hann weights of whole offsets about a point, each times `f` of the offset.
template <typename F>
double windowed(double width, F f) {
  double sum = 0.0;
  for (int k = -40; k <= 40; ++k) {
    const double away = k / (width + 0.5);
    if (std::abs(away) < 1.0) sum += (0.5 + 0.5 * std::cos(std::numbers::pi * away)) * f(k);
  }
  return sum;
}

/// How far one point that is moved by a nanometre moves the family's curve at a point `d` points off, as a
/// share. `corner`: the line turns left there, 0: nowhere.
double answer(const ConstraintSettings& settings, int at, int d, int corner = 0) {
  Polyline line;
  for (int i = 0; i <= 200; ++i) {
    const bool up = corner > 0 && i > corner;
    line.points_m.emplace_back((up ? corner : i) * kSpacing_m, up ? (i - corner) * kSpacing_m : 0.0);
  }
  const double before = CircleFamily(line, kSpacing_m, settings).at(line, (at + d) * kSpacing_m).point_m.y();
  line.points_m[static_cast<std::size_t>(at)].y() += 1e-9;
  const GuidePiece piece = CircleFamily(line, kSpacing_m, settings).at(line, (at + d) * kSpacing_m);
  EXPECT_EQ(piece.arc_m, (at + d) * kSpacing_m);
  return (piece.point_m.y() - before) / 1e-9;
}

// A Hann window of k + 1/2 points to either side has the sum k + 1/2.
TEST(CircleFamily, APointCountsByAWindowThatIsZeroHalfAPointBeyondTheLastOne) {
  for (const int k : {2, 5, 8, 24}) {
    ConstraintSettings settings;
    settings.curve = CurveKind::kLines;
    settings.half_window = k;
    for (const int d : {0, 1, -1, k / 2, k, -k, k + 1, -k - 1}) {
      const double away = std::min(1.0, std::abs(d) / (k + 0.5));
      const double expected = (0.5 + 0.5 * std::cos(std::numbers::pi * away)) / (k + 0.5);
      EXPECT_NEAR(answer(settings, 100, d), expected, 1e-5) << k << " " << d;
    }
    settings.taper = false;
    for (const int d : {0, k, -k})
      EXPECT_NEAR(answer(settings, 100, d), 1.0 / (2 * k + 1), 1e-5) << k << " " << d;
    EXPECT_NEAR(answer(settings, 100, k + 1), 0.0, 1e-5) << k;
  }
  ConstraintSettings widest;
  widest.curve = CurveKind::kLines;
  widest.half_window = 40;
  EXPECT_NEAR(answer(widest, 100, 0), 1.0 / (geometry::kMaxHalfWindow + 0.5), 1e-5);
}

// m points before or behind a right angle the window would reach m points; but within two points it is two,
// and neighbours differ by half a point: 1 + m / 2. From 46 points on it is as wide as ever.
TEST(CircleFamily, WindowsCloseGraduallyOnBothSidesOfACorner) {
  ConstraintSettings settings;
  settings.curve = CurveKind::kLines;
  for (const int m : {8, 15, 20, 30, 45, 46, 47, 50}) {
    const double width = std::min(1.0 + 0.5 * m, 24.0);
    const double expected = 1.0 / windowed(width, [](int) { return 1.0; });
    EXPECT_NEAR(answer(settings, 100 - m, 0, 100), expected, 1e-5) << m << " before";
    Polyline line;  // the same corner, run through the other way
    for (int i = 0; i <= 200; ++i)
      line.points_m.emplace_back(std::max(0, i - 100) * kSpacing_m, std::max(0, 100 - i) * kSpacing_m);
    const double arc_m = (100 + m) * kSpacing_m;
    const double before = CircleFamily(line, kSpacing_m, settings).at(line, arc_m).point_m.y();
    line.points_m[static_cast<std::size_t>(100 + m)].y() += 1e-9;
    const double after = CircleFamily(line, kSpacing_m, settings).at(line, arc_m).point_m.y();
    EXPECT_NEAR((after - before) / 1e-9, expected, 1e-5) << m << " behind";
  }
}

// Beyond an end there is no direction, so the same holds of it: two points at the last two, half a point more
// each.
TEST(CircleFamily, WindowsCloseTowardsTheEndsOfAnOpenLine) {
  ConstraintSettings settings;
  settings.curve = CurveKind::kLines;
  for (const int i : {3, 10, 25, 40, 44, 46, 60}) {
    const double expected = 1.0 / windowed(std::min(1.5 + 0.5 * i, 24.0), [](int) { return 1.0; });
    EXPECT_NEAR(answer(settings, i, 0), expected, 1e-5) << i;
    EXPECT_NEAR(answer(settings, 200 - i, 0), expected, 1e-5) << i;
  }
}

Polyline ring(double radius_m, int points) {
  Polyline line{{}, true};
  for (int i = 0; i < points; ++i) {
    const double a = 2.0 * M_PI * i / points;
    line.points_m.emplace_back(radius_m * std::cos(a), radius_m * std::sin(a));
  }
  return line;
}

// Lines lie inside of a circle by the windowed mean of its sagitta: that tells how many points were taken.
TEST(CircleFamily, TakesFewerPointsWhereTheCurveBendsByMoreThanItMay) {
  struct Case {
    int points;       ///< once round
    double bend_rad;  ///< allowed
    int half;         ///< taken to either side
  };
  for (const auto& [points, bend_rad, half] :
       {Case{64, 0.7, 8}, Case{62, 0.7, 7}, Case{64, 0.8, 9}, Case{1000, 0.7, 24}, Case{12, 0.7, 2},
        Case{7, 0.7, 2}, Case{64, 3.2, 24}}) {
    ConstraintSettings settings = plain_points();
    settings.curve = CurveKind::kLines;
    settings.window_bend_rad = bend_rad;
    const double step_rad = 2.0 * M_PI / points;
    const double radius_m = 0.5 * kSpacing_m / std::sin(0.5 * step_rad);
    const Polyline line = ring(radius_m, points);
    const double expected = radius_m * windowed(half, [&](int k) { return std::cos(k * step_rad); }) /
                            windowed(half, [](int) { return 1.0; });
    EXPECT_NEAR(CircleFamily(line, kSpacing_m, settings).at(line, 0.0).point_m.norm(), expected, 1e-12)
        << points << " " << bend_rad;
  }
}

TEST(CircleFamily, NoCircleIsTighterThanSaid) {
  ConstraintSettings settings;
  settings.min_radius_m = 0.06e-3;
  for (const double radius_m : {0.055e-3, 0.07e-3}) {
    const int points = static_cast<int>(std::lround(2.0 * M_PI * radius_m / kSpacing_m));
    const Polyline line = ring(radius_m, points);
    const GuidePiece piece =
        CircleFamily(line, 2.0 * radius_m * std::sin(M_PI / points), settings).at(line, 0.0);
    EXPECT_NEAR(piece.shape.curvature(), 1.0 / std::max(radius_m, 0.06e-3), 1.0) << "turns to the left";
    EXPECT_LT((piece.shape.tangent(piece.point_m) - Vec2::UnitY()).norm(), 1e-9);
    EXPECT_NEAR(piece.shape.phi(piece.point_m), 0.0, 1e-12);
  }
}

/// Unsymmetrical, with bends of all kinds.
ContourMessage blob(bool backwards) {
  ContourMessage contour;
  for (int i = 0; i < 900; ++i) {
    const double t = (backwards ? 900 - i : i) * 2 * M_PI / 900;
    const double r =
        6e-3 + 1.1e-3 * std::cos(3 * t) + 0.5e-3 * std::sin(7 * t) + 0.25e-3 * std::cos(19 * t + 1);
    contour.points_m.emplace_back(r * std::cos(t), r * std::sin(t));
  }
  return contour;
}

TEST(GuidePath, OfTheReversedContourIsTheMirrorImage) {
  const GuidePath there = make_guide(blob(false), 1.0, {});
  const GuidePath back = make_guide(blob(true), 1.0, {});
  ASSERT_NEAR(there.length_m(), back.length_m(), 1e-9);
  double tightest_m = 1.0;
  for (double arc = 0.0; arc < there.length_m(); arc += 13e-6) {
    const GuidePiece a = there.at(arc);
    const GuidePiece b = back.at(there.length_m() - arc);
    EXPECT_LT((a.point_m - b.point_m).norm(), 1e-9) << arc;
    EXPECT_NEAR(a.shape.curvature(), -b.shape.curvature(), 1e-3 * (1.0 + std::abs(a.shape.curvature())))
        << arc;
    EXPECT_NEAR(there.speed_limit(arc).m_per_s, back.speed_limit(there.length_m() - arc).m_per_s, 1e-5)
        << arc;
    if (!a.shape.is_line) tightest_m = std::min(tightest_m, a.shape.radius_m);
  }
  EXPECT_LT(tightest_m, 0.6e-3) << "the windows have closed somewhere";
}

TEST(GuideCurve, RoundingMovesABendInwardsAndATipByAsMuchAsSaid) {
  ConstraintSettings settings;
  settings.min_radius_m = 0.0;
  settings.rounding_m = 0.12e-3;
  settings.spacing_m = kSpacing_m;
  const double sigma_m = settings.rounding_m;
  for (const double radius_m : {1e-3, 4e-3}) {
    const double in_m = sigma_m * sigma_m / (2.0 * radius_m);
    for (const Vec2& p : guide_curve(circle(radius_m), 1.0, settings).points_m)
      EXPECT_NEAR(radius_m - p.norm(), in_m, 0.04 * in_m);
  }
  ContourMessage angle;
  angle.closed = false;
  angle.points_m = {{-5e-3, 0}, {0, 0}, {0, 5e-3}};
  const Polyline bent = guide_curve(angle, 1.0, settings);
  const geometry::NearestIndex index(bent);
  EXPECT_NEAR(index.find(Vec2::Zero()).distance_m, 0.564 * sigma_m, 0.01 * sigma_m);
  EXPECT_EQ(bent.points_m.front(), Vec2(-5e-3, 0));
  EXPECT_EQ(bent.points_m.back(), Vec2(0, 5e-3));
  EXPECT_NEAR(index.find({-5e-3, 1e-3}).distance_m, 1e-3, 1e-12) << "and the legs stay straight";
}

TEST(GuideCurve, PointsAreAsFarApartAsSaidAndScaled) {
  const Polyline line = guide_curve(straight_line(0.01), 0.5, in_masters_size({}, 0.5));
  ASSERT_EQ(line.size(), 801u);
  for (std::size_t i = 0; i < line.size(); ++i)
    EXPECT_NEAR(line.points_m[i].x(), static_cast<double>(i) * kSpacing_m, 1e-12);
}

/// Tip of a thin wedge to the nearest point of its guide.
double lost_at_tip_m(double opening_m, double min_radius_m) {
  ConstraintSettings settings;
  settings.rounding_m = 0.12e-3;
  settings.spacing_m = kSpacing_m;
  settings.opening_m = opening_m;
  settings.min_radius_m = min_radius_m;
  ContourMessage wedge;
  wedge.closed = false;
  wedge.points_m = {{-5e-3, 0.3e-3}, {0, 0}, {-5e-3, -0.3e-3}};
  return geometry::NearestIndex(guide_curve(wedge, 1.0, settings)).find(Vec2::Zero()).distance_m;
}

TEST(GuideCurve, ATipIsOpenedUntilAToolCanTurnThere) {
  // A circle of r that touches both legs would be (1 / sin(half angle) - 1) r from the tip: 0.31 mm.
  EXPECT_NEAR(lost_at_tip_m(10e-3, 0.02e-3), 0.257e-3, 5e-6);
  EXPECT_NEAR(lost_at_tip_m(10e-3, 0.04e-3), 0.687e-3, 5e-6);
  EXPECT_NEAR(lost_at_tip_m(0.1e-3, 0.02e-3), 0.194e-3, 3e-6) << "no point moves by more than so much";
  EXPECT_NEAR(lost_at_tip_m(10e-3, 0.0), 0.0955e-3, 2e-6) << "what the rounding takes";
}

TEST(GuidePath, EveryPlaceIsFoundAgainAlsoFromBesideIt) {
  for (const CurveKind curve : {CurveKind::kCircles, CurveKind::kDescriptor}) {
    ConstraintSettings settings;
    settings.curve = curve;
    const GuidePath guide = make_guide(circle(0.01), 1.0, settings);
    const double length = guide.length_m();
    EXPECT_NEAR(length, 2.0 * M_PI * 0.01, 5e-6);
    for (const double share : {0.0, 0.1, 0.37, 0.5, 0.93, 0.9999}) {
      const double angle = 2.0 * M_PI * share;
      for (const double radius_m : {0.008, 0.01, 0.012}) {
        const Vec2 tool(radius_m * std::cos(angle), radius_m * std::sin(angle));
        const auto off = [&](double arc) { return std::remainder(arc - share * length, length); };
        EXPECT_NEAR(off(guide.find(tool)), 0.0, 1e-7) << share << " " << radius_m;
        EXPECT_NEAR(off(guide.find_near(tool, share * length + 1.5e-3)), 0.0, 1e-7)
            << share << " " << radius_m;
        EXPECT_NEAR(off(guide.find_near(tool, share * length - 1.5e-3)), 0.0, 1e-7)
            << share << " " << radius_m;
        EXPECT_GT(std::abs(off(guide.find_near(tool, share * length - 5e-3))), 1e-3) << "too far for it";
      }
      // Round and round.
      EXPECT_LT((guide.at(share * length - length).point_m - guide.at(share * length).point_m).norm(), 1e-12);
      EXPECT_LT((guide.at(share * length + length).point_m - guide.at(share * length).point_m).norm(), 1e-12);
      EXPECT_NEAR(guide.at(share * length).shape.curvature(), 100.0, 0.2);
    }
  }
}

TEST(GuidePath, OfAnOpenContourEndsAtItsEnds) {
  const GuidePath guide = make_guide(straight_line(0.01), 1.0, {});
  EXPECT_NEAR(guide.length_m(), 0.01, 1e-12);
  EXPECT_LT((guide.at(-1e-3).point_m - Vec2(0, 0)).norm(), 1e-9);
  EXPECT_LT((guide.at(0.02).point_m - Vec2(0.01, 0)).norm(), 1e-9);
  EXPECT_EQ(guide.at(0.02).arc_m, guide.length_m());
  EXPECT_EQ(guide.at(-1e-3).arc_m, 0.0);
  EXPECT_NEAR(guide.at(3.3e-3).point_m.x(), 3.3e-3, 1e-9);
}

TEST(GuidePath, ADescriptorOfTheContourIsWithinItsErrorAndRefusedByName) {
  ConstraintSettings settings;
  settings.curve = CurveKind::kDescriptor;
  const GuidePath guide = make_guide(blob(false), 1.0, settings);
  double worst_m = 0.0;
  for (double arc = 0.0; arc < guide.length_m(); arc += 50e-6)
    worst_m = std::max(worst_m, guide.curve.find(guide.at(arc).point_m).distance_m);
  EXPECT_LE(worst_m, settings.descriptor_error_m);
  EXPECT_GT(worst_m, 0.2 * settings.descriptor_error_m) << "with no more harmonics than it takes";
}

/// On a straight line, for a curvature that is given.
SpeedLimits limits_of(const ConstraintSettings& settings, double length_m, bool closed,
                      const std::function<double(double)>& curvature_at) {
  Polyline line{{}, closed};
  const int segments = static_cast<int>(std::lround(length_m / kSpacing_m));
  for (int i = 0; i <= segments; ++i) line.points_m.emplace_back(i * kSpacing_m, 0.0);
  return {line, kSpacing_m, settings, curvature_at};
}

TEST(SpeedLimits, AreTheLeastOfWhatABendAllows) {
  ConstraintSettings settings;
  settings.end_m_per_s = 1.0;  // ends do not matter
  struct Case {
    double curvature_per_m;
    double m_per_s;
  };
  for (const auto& [curvature, expected] :
       {Case{0.0, 0.2}, Case{24.0, 0.2}, Case{26.0, std::sqrt(1.0 / 26.0)}, Case{400.0, 0.05},
        Case{-400.0, 0.05}, Case{1599.0, std::sqrt(1.0 / 1599.0)}, Case{2000.0, 0.02}, Case{-2000.0, 0.02}}) {
    const SpeedLimits limits = limits_of(settings, 0.01, false, [&](double) { return curvature; });
    for (const double fraction : {0.1234, 0.5, 0.91})
      EXPECT_NEAR(limits.at(fraction).m_per_s, expected, 1e-12) << curvature;
  }
  // And of what its change along the curve allows.
  for (const double per_m2 : {1e6, -1e6}) {
    const SpeedLimits spiral =
        limits_of(settings, 2e-3, false, [&](double f) { return per_m2 * 1e-3 * (f - 0.5) * 2.0; });
    EXPECT_NEAR(spiral.at(0.5).m_per_s, std::cbrt(60.0 / 1e6), 1e-9) << per_m2;
  }
}

TEST(SpeedLimits, SeeABendOfThePointsWhereTheCircleIsTooFlat) {
  ConstraintSettings settings;
  const int points = 400;
  const double radius_m = 0.5 * kSpacing_m / std::sin(M_PI / points);
  const Polyline line = ring(radius_m, points);
  const double turn_per_m = 2.0 * M_PI / points / kSpacing_m;
  for (const double circle_per_m : {0.0, 0.9 * turn_per_m, 4.0 * turn_per_m}) {
    const SpeedLimits limits(line, kSpacing_m, settings, [&](double) { return circle_per_m; });
    const double bend = std::max(circle_per_m, turn_per_m);
    EXPECT_NEAR(limits.at(0.3).m_per_s, std::min(std::sqrt(1.0 / bend), 40.0 / bend), 1e-9) << circle_per_m;
  }
}

TEST(SpeedLimits, BrakeFromAnEndAndLeadByTheirSlopeEitherWay) {
  ConstraintSettings settings;
  const double length_m = 0.06;
  const SpeedLimits limits = limits_of(settings, length_m, false, [](double) { return 0.0; });
  double steepest = 0.0;
  for (double s = 0.0; s <= length_m; s += 0.7e-4) {
    const SpeedLimit limit = limits.at(s / length_m);
    const double to_end_m = std::min(s, length_m - s);
    if (to_end_m < 0.1e-3) continue;  // less than a few points
    EXPECT_NEAR(limit.m_per_s, std::min(0.2, std::sqrt(9e-6 + 1.6 * to_end_m)), 3e-5) << s;
    if (to_end_m < 1e-3 || std::abs(to_end_m - 0.025) < 1e-3) continue;
    const double slope = to_end_m > 0.025 ? 0.0 : (s < length_m - s ? 1.0 : -1.0) * 0.8 / limit.m_per_s;
    EXPECT_NEAR(limit.slope_per_s, slope, 0.02 * std::abs(slope) + 1e-9) << s;
    steepest = std::max(steepest, std::abs(slope));
  }
  EXPECT_GT(steepest, 15.0);
  EXPECT_EQ(limits.at(0.0).m_per_s, settings.end_m_per_s);
  EXPECT_EQ(limits.at(1.0).m_per_s, settings.end_m_per_s);
  EXPECT_LT(limits.at(1.0).slope_per_s, 0.0);
  EXPECT_GT(limits.at(0.0).slope_per_s, 0.0);
}

TEST(SpeedLimits, HaveTheSlopeThatDifferencesShowOnAGuideThatCloses) {
  ContourMessage square;
  square.points_m = {{0, 0}, {0.02, 0}, {0.02, 0.02}, {0, 0.02}};
  const GuidePath guide = make_guide(square, 1.0, {});
  constexpr double kStep_m = 1e-9;
  int rising = 0, falling = 0;
  for (double arc = 3.3e-6; arc < guide.length_m(); arc += 37e-6) {
    const double before = guide.speed_limit(arc - kStep_m).m_per_s;
    const double after = guide.speed_limit(arc + kStep_m).m_per_s;
    const double slope = (after - before) / (2.0 * kStep_m);
    EXPECT_NEAR(guide.speed_limit(arc).slope_per_s, slope, 1e-3 * (1.0 + std::abs(slope))) << arc;
    rising += slope > 1.0;
    falling += slope < -1.0;
  }
  EXPECT_GT(rising, 500);
  EXPECT_GT(falling, 500);
  EXPECT_NEAR(guide.speed_limit(guide.length_m() - 1e-12).m_per_s, guide.speed_limit(0.0).m_per_s, 1e-9);
}

}  // namespace
}  // namespace telekerf::master
