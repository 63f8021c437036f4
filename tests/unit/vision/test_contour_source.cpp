// SPDX-License-Identifier: Apache-2.0
// What goes into a contour's message: its id, its reach, and as many further lines as fit; when two are the
// same.
#include <gtest/gtest.h>

#include <cmath>

#include "slave/vision/contour_source.h"
#include "slave/vision/vision_node.h"

namespace telekerf::vision_process {
namespace {

using geometry::Polyline;

vision::LoadedContours loaded(std::vector<Polyline> lines, std::size_t selected = 0) {
  vision::LoadedContours out;
  out.mode = "outline";
  out.metres_per_pixel = 1e-4;
  for (std::size_t i = 0; i < lines.size(); ++i) out.noise_m.push_back(1e-6 * static_cast<double>(i + 1));
  out.contours = std::move(lines);
  out.selected = selected;
  return out;
}

Polyline square(double half_m, bool closed = true) {
  return {{{-half_m, -half_m}, {half_m, -half_m}, {half_m, half_m}, {-half_m, half_m}}, closed};
}

ContourMessage message(std::vector<Polyline> lines, std::size_t selected = 0) {
  return message_of(loaded(std::move(lines), selected), "a.png", 0.05).value();
}

TEST(ContourSource, TheMessageIsTheSelectedLineAndTheOthersBehindIt) {
  const ContourMessage m = message({square(0.01), square(0.005, false), square(0.002)}, 1);
  EXPECT_EQ(m.points_m, square(0.005).points_m);
  EXPECT_FALSE(m.closed);
  EXPECT_EQ(m.source, "a.png");
  EXPECT_EQ(m.mode, "outline");
  EXPECT_EQ(m.metres_per_pixel, 1e-4);
  EXPECT_EQ(m.deviation_m, 2e-6);
  ASSERT_EQ(m.further.size(), 2u);
  EXPECT_EQ(m.further[0].points_m, square(0.01).points_m);
  EXPECT_TRUE(m.further[1].closed);
}

TEST(ContourSource, TheIdIsThatOfTheLines) {
  // FNV-1a over the coordinates' octets, an open line's bit turned first: the same after every restart.
  EXPECT_EQ(message({{{{0.001, 0.002}, {0.003, -0.004}}, true}}).id, 3185683509U);
  EXPECT_EQ(message({{{{0.001, 0.002}, {0.003, -0.004}}, false}}).id, 2504542804U);
  const auto id = message({square(0.01), square(0.005)}).id;
  EXPECT_EQ(message({square(0.01), square(0.005)}).id, id);
  EXPECT_NE(message({square(0.01), square(0.005, false)}).id, id);
  EXPECT_NE(message({square(0.01)}).id, id);
  EXPECT_NE(message({square(0.01), square(0.0050000001)}).id, id);
  EXPECT_NE(message({square(0.01), square(0.005)}, 1).id, id);
}

TEST(ContourSource, ReachesTheWorkspacesEdgeAndNotBeyond) {
  const auto fits = [](double reach_m) {
    return message_of(loaded({{{{0.0, 0.0}, {0.6 * reach_m, -0.8 * reach_m}}, false}}), "a.png", 0.02);
  };
  EXPECT_TRUE(fits(0.02 * (1.0 - 1e-12)));
  const auto beyond = fits(0.0201);
  ASSERT_FALSE(beyond);
  EXPECT_EQ(beyond.error(),
            "a.png: the contour reaches 20.1 mm from the workspace's centre, but the slave only 20.0 mm; "
            "use a smaller --width-mm");
}

TEST(ContourSource, FurtherLinesThatDoNotFitAreDust) {
  std::vector<Polyline> many(1001, square(0.001));
  EXPECT_EQ(message(many).further.size(), 1000u);
  many.push_back(square(0.001));
  EXPECT_EQ(message(many).further.size(), 1000u);
  Polyline half;
  half.points_m.assign(50'000, Vec2(1e-3, 1e-3));
  EXPECT_EQ(message({square(0.01), half, half}).further.size(), 2u) << "just all that a message holds";
  half.points_m.emplace_back(1e-3, 1e-3);
  EXPECT_EQ(message({square(0.01), half, half, square(0.001)}).further.size(), 1u);
}

ContourMessage ring(double radius_m, double shift_m = 0.0, double from = 0.0, int way = 1,
                    double part = 1.0) {
  ContourMessage out;
  out.closed = part == 1.0;
  for (int i = 0; i < 720; ++i) {
    const double t = from + way * part * 2.0 * M_PI * i / 720.0;
    out.points_m.emplace_back(shift_m + radius_m * std::cos(t), radius_m * std::sin(t));
  }
  return out;
}

TEST(SameContour, WithinItsToleranceWhateverItsStartAndDirection) {
  const ContourMessage a = ring(0.01);
  EXPECT_TRUE(same_contour(a, ring(0.01, 0.0, 1.0, -1), 1e-6));
  EXPECT_TRUE(same_contour(a, ring(0.01, 0.99e-4), 1e-4));
  EXPECT_FALSE(same_contour(a, ring(0.01, 1.01e-4), 1e-4));
  EXPECT_TRUE(same_contour(a, ring(0.010099), 1e-4));
  EXPECT_FALSE(same_contour(a, ring(0.010101), 1e-4));
  ContourMessage open = a;
  open.closed = false;
  EXPECT_FALSE(same_contour(a, open, 1e-3));
  // Each line has its like, in whatever order; one more is one too many.
  ContourMessage b = a, c = a;
  b.further = {{true, ring(0.002).points_m}, {true, ring(0.002, 0.02).points_m}};
  c.further = {b.further[1], b.further[0]};
  EXPECT_TRUE(same_contour(b, c, 1e-6));
  c.further[1] = c.further[0];
  EXPECT_FALSE(same_contour(b, c, 1e-6)) << "one has no like";
  EXPECT_FALSE(same_contour(c, b, 1e-6));
  c.further = {b.further[0]};
  EXPECT_FALSE(same_contour(b, c, 1e-6));
  // As near everywhere, but longer: two hundredths and two tolerances are taken, no more.
  const auto wavy = [](double height_m) {
    ContourMessage out;
    for (int i = 0; i < 2000; ++i) {
      const double r = 0.01 + height_m * std::sin(2.0 * M_PI * i / 20.0);
      out.points_m.emplace_back(r * std::cos(M_PI * i / 1000.0), r * std::sin(M_PI * i / 1000.0));
    }
    return out;
  };
  const auto longer = [&](double height_m) {
    const double length_m = geometry::length_m({wavy(height_m).points_m, true});
    return (length_m - geometry::length_m({a.points_m, true}) - 2.0 * 1e-4) / length_m;
  };
  EXPECT_LT(longer(0.26e-4), 0.02);
  EXPECT_TRUE(same_contour(a, wavy(0.26e-4), 1e-4));
  EXPECT_GT(longer(0.34e-4), 0.02);
  EXPECT_LT(longer(0.34e-4), 0.05);
  EXPECT_FALSE(same_contour(a, wavy(0.34e-4), 1e-4));
  // Of the longer one: 1.98 hundredths of it are more than two of the shorter one.
  double low = 0.26e-4, high = 0.34e-4;
  for (int i = 0; i < 30; ++i) (longer(0.5 * (low + high)) < 0.0198 ? low : high) = 0.5 * (low + high);
  ASSERT_NEAR(longer(low), 0.0198, 1e-6);
  EXPECT_TRUE(same_contour(a, wavy(low), 1e-4));
  // Round twice: no point lies off it, but it is twice as long.
  ContourMessage twice = a;
  twice.points_m.insert(twice.points_m.end(), a.points_m.begin(), a.points_m.end());
  EXPECT_FALSE(same_contour(a, twice, 1e-4));
}

}  // namespace
}  // namespace telekerf::vision_process
