// SPDX-License-Identifier: Apache-2.0
// Which contours a job cuts, and where beside them.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "slave/machining/job.h"

namespace telekerf::machining {
namespace {

geometry::Polyline square(double side_m) {
  const double h = side_m / 2;
  return {{{-h, -h}, {h, -h}, {h, h}, {-h, h}}, true};
}

TEST(JobContours, KerfIsTakenOffTheHoleAndAddedToThePiece) {
  JobSettings settings;
  settings.kerf_m = 0.2e-3;
  const auto job = make_job({square(10e-3), square(4e-3)}, settings);
  ASSERT_TRUE(job) << job.error();
  EXPECT_NEAR(job->plans[0].path.length_m(), 4 * 3.8e-3, 0.2e-3);
  EXPECT_NEAR(job->plans[1].path.length_m(), 4 * 10.2e-3, 0.3e-3);
}

TEST(JobContours, ChosenContoursKeepTheirNumbersAndAHoleChosenAloneIsStillOne) {
  JobSettings settings;
  settings.kerf_m = 0.2e-3;
  settings.select = {2, 1, 2};
  const auto two = make_job({square(10e-3), square(7e-3), square(4e-3)}, settings);
  ASSERT_TRUE(two) << two.error();
  EXPECT_EQ(two->order, (std::vector<std::size_t>{2, 1}));
  settings.select = {1};
  const auto hole = make_job({square(10e-3), square(7e-3), square(4e-3)}, settings);
  ASSERT_TRUE(hole) << hole.error();
  EXPECT_EQ(hole->order, (std::vector<std::size_t>{1}));
  EXPECT_NEAR(geometry::length_m(hole->lines[0]), 4 * 6.8e-3, 1e-6);
  for (const double number : {3.0, 0.5}) {
    settings.select = {number};
    const auto none = make_job({square(10e-3), square(7e-3), square(4e-3)}, settings);
    ASSERT_FALSE(none);
    EXPECT_EQ(none.error(),
              fmt::format("--select {:g}: there are the contours 0 to 2; --dry-run lists them", number));
  }
}

TEST(JobContours, AContourThatCannotBeCutIsNamed) {
  JobSettings settings;
  settings.kerf_m = 0.2e-3;
  const auto job = make_job({square(10e-3), square(0.1e-3)}, settings);
  ASSERT_FALSE(job);
  EXPECT_EQ(job.error(),
            "contour 1: it is somewhere narrower than the kerf of 0.2 mm; use a smaller --kerf-um");
  settings.kerf_m = 0.0;
  const auto none = make_job({square(10e-3), {{{0, 0}, {0, 0}}, false}}, settings);
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().find("contour 1: "), 0u) << none.error();
}

TEST(JobContours, ASlotThatTheBeamCannotEnterIsSaid) {
  geometry::Polyline plate = square(10e-3);
  plate.points_m.insert(plate.points_m.begin() + 1,
                        {{-0.05e-3, -5e-3}, {-0.05e-3, 0}, {0.05e-3, 0}, {0.05e-3, -5e-3}});
  JobSettings settings;
  settings.kerf_m = 0.2e-3;
  settings.select = {1};
  const auto job = make_job({square(20e-3), plate}, settings);
  ASSERT_TRUE(job) << job.error();
  EXPECT_TRUE(job->warnings.empty()) << "a hole is moved inwards: its tongue is cut";
  settings.select = {};
  const auto piece = make_job({plate}, settings);
  ASSERT_TRUE(piece) << piece.error();
  ASSERT_EQ(piece->warnings.size(), 1u);
  EXPECT_EQ(piece->warnings[0].find("contour 0: a slot or notch"), 0u) << piece->warnings[0];
}

}  // namespace
}  // namespace telekerf::machining
