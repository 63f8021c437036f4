// SPDX-License-Identifier: Apache-2.0
// What is measured of a pass, against passes whose errors are known.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "slave/machining/contour_pass.h"

namespace telekerf::machining {
namespace {

using geometry::Polyline;

/// Two legs of 5 mm, the second turned by so many degrees.
Polyline bent(double degrees) {
  const double t = degrees * std::numbers::pi / 180;
  return {{{-5e-3, 0}, {0, 0}, {5e-3 * std::cos(t), 5e-3 * std::sin(t)}}, false};
}

/// Of radius R, by so many degrees, between straights of 3 mm.
Polyline rounded(double radius_m, double degrees) {
  Polyline line{{{-3e-3, 0}}, false};
  const double turn = degrees * std::numbers::pi / 180;
  Vec2 p(0, 0);
  for (int i = 0; i <= 200; ++i) {
    const double t = turn * i / 200;
    p = {radius_m * std::sin(t), radius_m * (1 - std::cos(t))};
    line.points_m.push_back(p);
  }
  line.points_m.emplace_back(p + 3e-3 * Vec2(std::cos(turn), std::sin(turn)));
  return line;
}

TEST(CornersOf, TurnByMoreThanThirtyDegrees) {
  for (const double sign : {-1.0, 1.0}) {
    EXPECT_EQ(corners_of(bent(sign * 29.0)).size(), 0u);
    for (const double degrees : {31.0, 90.0, 150.0}) {
      const auto corners = corners_of(bent(sign * degrees));
      ASSERT_EQ(corners.size(), 1u) << degrees;
      EXPECT_LT(corners[0].norm(), 25e-6) << degrees;
    }
  }
}

TEST(CornersOf, OfAClosedContourTheStartsIsFoundOnceAndAnOpenOnesEndsAreNone) {
  Polyline square{{{0, 0}, {4e-3, 0}, {4e-3, 4e-3}, {0, 4e-3}}, true};
  // Wherever it begins: at a corner, within its window, on a side.
  for (const Vec2& start : {Vec2(0, 0), Vec2(0.1e-3, 0), Vec2(2e-3, 0), Vec2(3.9e-3, 0)}) {
    Polyline from = square;
    if (start.x() > 0.0) {
      from.points_m = {start, {4e-3, 0}, {4e-3, 4e-3}, {0, 4e-3}, {0, 0}};
    }
    const auto corners = corners_of(from);
    ASSERT_EQ(corners.size(), 4u) << start.x();
    for (const Vec2& vertex : square.points_m) {
      EXPECT_TRUE(std::any_of(corners.begin(), corners.end(),
                              [&](const Vec2& c) { return (c - vertex).norm() < 25e-6; }))
          << start.x() << ": " << vertex.transpose();
    }
  }
  square.closed = false;
  EXPECT_EQ(corners_of(square).size(), 2u);
}

TEST(CornersOf, ABendIsACornerWhereItTurnsSoonAndNoneWhereItTurnsAllTheWay) {
  EXPECT_EQ(corners_of(rounded(0.1e-3, 90)).size(), 1u);
  EXPECT_EQ(corners_of(rounded(0.3e-3, 90)).size(), 1u);
  EXPECT_EQ(corners_of(rounded(1.0e-3, 90)).size(), 0u) << "26 degrees within its window of 0.45 mm";
  EXPECT_EQ(corners_of(rounded(0.4e-3, 180)).size(), 0u) << "a bend of 1.3 mm is no place";
}

struct Pass {
  explicit Pass(Polyline line)
      : contour(std::move(line)), plan(make_timed_path(contour, settings()).value()) {
    pass.plan = &plan;
    pass.contour = &contour;
  }
  static TimedPathSettings settings() {
    TimedPathSettings out;
    out.speed_m_per_s = 10e-3;
    return out;
  }
  Pass(const Pass&) = delete;
  Pass& operator=(const Pass&) = delete;

  /// The tool is `off_m` beside the reference (along, across, up), and `faster_m_per_s` along it.
  template <class Off, class Faster>
  void cut(Off off_m, Faster faster_m_per_s, double to_m = 1.0) {
    for (std::size_t i = 0; i < plan.trajectory.size(); ++i) {
      const Reference& r = plan.trajectory[i];
      if (!r.beam || r.arc_length_m > to_m) continue;
      const Vec3 left(-r.tangent.y(), r.tangent.x(), 0.0);
      const Vec3 off = off_m(r.arc_length_m);
      pass.rows.push_back(pass_row(r, r.position_m + off[0] * r.tangent + off[1] * left + Vec3(0, 0, off[2]),
                                   r.velocity_m_per_s + faster_m_per_s(r.arc_length_m) * r.tangent, 5.0));
    }
  }
  nlohmann::ordered_json measured() const { return measure({&pass, 1}, 10e-3); }

  Polyline contour;
  TimedPath plan;
  ContourPass pass;
};

TEST(MeasuredPass, ErrorsAreThoseOfTheMovingFrameAndOfTheLines) {
  Pass straight({{{-4e-3, 1e-3}, {4e-3, 1e-3}}, false});
  straight.cut([](double) { return Vec3(2e-6, 5e-6, -3e-6); }, [](double) { return -0.1e-3; });
  const auto& row = straight.pass.rows[40];
  EXPECT_LT((row.error_in_frame_m - Vec3(-2e-6, -5e-6, 3e-6)).norm(), 1e-12);
  EXPECT_EQ(row.laser_w, 5.0);
  const auto m = straight.measured();
  const auto near = [&](const char* what, double um) {
    EXPECT_NEAR(m[what]["rms"].get<double>(), um, 0.01) << what;
    EXPECT_NEAR(m[what]["max"].get<double>(), um, 0.01) << what;
  };
  near("contour_error_um", 5.0);
  EXPECT_NEAR(m["reference_error_um"]["rms"].get<double>(), 5.0, 0.01);
  EXPECT_NEAR(m["reference_error_um"]["max"].get<double>(), std::hypot(5.0, 2.0), 0.01) << "beyond its end";
  near("normal_error_um", 5.0);
  near("tangential_error_um", 2.0);
  near("height_error_um", 3.0);
  EXPECT_NEAR(m["model_error_um"]["max"].get<double>(), 0.0, 1e-3);
  EXPECT_EQ(m["tangential_speed"]["commanded_mm_s"], 10.0);
  EXPECT_NEAR(m["tangential_speed"]["mean_mm_s"].get<double>(), 9.9, 1e-3);
  EXPECT_NEAR(m["tangential_speed"]["ripple_percent"].get<double>(), 100 * 0.1 / 9.9, 1e-3);
  EXPECT_NEAR(m["tangential_speed"]["ripple_peak_percent"].get<double>(), 100 * 0.1 / 9.9, 1e-3);
  EXPECT_TRUE(m["tangential_speed"]["ripple_at_corners_peak_percent"].is_null()) << "there is none";
  EXPECT_NEAR(m["tangential_speed"]["slowest_planned_mm_s"].get<double>(),
              1e3 * straight.plan.slowest_m_per_s, 1e-9);
  EXPECT_EQ(m["corners"], 0);
  EXPECT_EQ(m["corner_error_um"], 0.0);
  EXPECT_TRUE(m["closure_gap_um"].is_null()) << "an open line has none";
}

TEST(MeasuredPass, SpeedAndModelNearACornerAreTheCornersOwn) {
  for (const double away_m : {0.3e-3, 0.6e-3}) {
    Pass elbow(bent(90.0));
    elbow.cut([](double) { return Vec3(0, 0, 0); },
              [&](double arc_m) { return std::abs(std::abs(arc_m - 5e-3) - away_m) < 50e-6 ? 2e-3 : 0.0; });
    const auto m = elbow.measured();
    EXPECT_NEAR(m["tangential_speed"]["ripple_peak_percent"].get<double>(), away_m > 0.4e-3 ? 20.0 : 0.0, 0.3)
        << away_m;
    EXPECT_NEAR(m["tangential_speed"]["ripple_at_corners_peak_percent"].get<double>(),
                away_m > 0.4e-3 ? 0.0 : 20.0, 0.3)
        << away_m;
    EXPECT_NEAR(m["tangential_speed"]["ripple_everywhere_peak_percent"].get<double>(), 20.0, 0.3) << away_m;
    // Two stretches of 0.1 mm in 10 mm.
    EXPECT_NEAR(m["tangential_speed"]["ripple_everywhere_percent"].get<double>(), 20.0 * std::sqrt(0.02), 0.1)
        << away_m;
    EXPECT_EQ(m["corners"], 1);
    const double rounding_um = m["model_error_um"]["max_at_corners"];
    EXPECT_NEAR(m["corner_error_um"].get<double>(), std::numbers::sqrt2 * rounding_um, 0.1 * rounding_um)
        << "along the bisector the corner is that far";
    EXPECT_LT(m["model_error_um"]["max"].get<double>(), 0.1 * rounding_um);
    EXPECT_NEAR(rounding_um, 9.0, 1.0);
  }
}

TEST(MeasuredPass, CornersThatWereNotReachedAreNotMissed) {
  for (const double to_m : {4.9e-3, 5.1e-3}) {
    Pass elbow(bent(90.0));
    elbow.cut([](double) { return Vec3(0, 0, 0); }, [](double) { return 0.0; }, to_m);
    const auto m = elbow.measured();
    EXPECT_EQ(m["corners"], 1);
    EXPECT_EQ(m["corner_error_um"].get<double>() > 0.0, to_m > 5e-3) << to_m;
  }
}

TEST(MeasuredPass, TheEndOfAClosedCutIsMeasuredWhereItPassesItsStart) {
  Polyline ring{{}, true};
  for (int i = 0; i < 360; ++i)
    ring.points_m.emplace_back(2e-3 * std::cos(i * std::numbers::pi / 180),
                               2e-3 * std::sin(i * std::numbers::pi / 180));
  Pass whole(ring);
  const double length_m = whole.plan.path.length_m();
  // From its second half on the tool runs 4 um inside.
  whole.cut([&](double arc_m) { return Vec3(0, arc_m > 0.75 * length_m ? 4e-6 : 0.0, 0); },
            [](double) { return 0.0; });
  EXPECT_NEAR(whole.measured()["closure_gap_um"].get<double>(), 4.0, 0.1);
  Pass half(ring);
  half.cut([](double) { return Vec3(0, 0, 0); }, [](double) { return 0.0; }, 0.4 * length_m);
  EXPECT_EQ(half.measured()["closure_gap_um"], 0.0) << "it was stopped";
  // Both passes together: of each error the larger, of speeds the mean.
  const ContourPass passes[] = {half.pass, whole.pass};
  const auto both = measure(passes, 10e-3);
  EXPECT_NEAR(both["closure_gap_um"].get<double>(), 4.0, 0.1);
  EXPECT_NEAR(both["normal_error_um"]["max"].get<double>(), 4.0, 0.01);
  EXPECT_NEAR(both["tangential_speed"]["mean_mm_s"].get<double>(), 10.0, 0.02);
  const auto nothing = measure({}, 10e-3);
  EXPECT_EQ(nothing["tangential_speed"]["mean_mm_s"], 0.0);
  EXPECT_EQ(nothing["tangential_speed"]["ripple_percent"], 0.0);
}

}  // namespace
}  // namespace telekerf::machining
