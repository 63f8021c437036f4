// SPDX-License-Identifier: Apache-2.0
// Where a path begins and ends when that is given, and how a drawing's lines are scaled and anchored.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "common/vision/export/overlay.h"
#include "common/vision/extraction/ends.h"
#include "common/vision/load.h"

namespace telekerf::vision {
namespace {

/// Points a pixel apart from (0, y) to (n - 1, y).
PixelContour straight(int n, double y = 0.0) {
  PixelContour out;
  out.closed = false;
  out.width_px = 2.0;  // ends nearer than 8 points count as the line's own
  for (int i = 0; i < n; ++i) out.points_px.emplace_back(i, y);
  return out;
}

std::pair<double, double> ends_of(const Contours& contours) {
  const auto& p = contours.front().points_px;
  return {p.front().x(), p.back().x()};
}

TEST(Ends, CutAnOpenLineWhereTheyAreGiven) {
  const auto cut = [](std::optional<Vec2> start, std::optional<Vec2> end) {
    Contours contours{straight(100)};
    apply_ends(contours, start, end);
    EXPECT_FALSE(contours[0].closed);
    return ends_of(contours);
  };
  using Ends = std::pair<double, double>;
  const Vec2 early(20, 1), late(70, -1);
  EXPECT_EQ(cut({}, {}), Ends(0, 99));
  EXPECT_EQ(cut(early, late), Ends(20, 70));
  EXPECT_EQ(cut(late, early), Ends(70, 20));
  EXPECT_EQ(cut(early, {}), Ends(20, 99)) << "on to the far end";
  EXPECT_EQ(cut(late, {}), Ends(70, 0));
  EXPECT_EQ(cut({}, late), Ends(0, 70));
  EXPECT_EQ(cut({}, early), Ends(99, 20));
  EXPECT_EQ(cut(Vec2(8, 0), Vec2(92, 0)), Ends(0, 99)) << "so near to the line's own ends it stays whole";
  EXPECT_EQ(cut(Vec2(9, 0), Vec2(91, 0)), Ends(9, 91));
  EXPECT_EQ(cut(Vec2(90, 0), Vec2(9, 0)), Ends(90, 9));
}

TEST(Ends, TheContourThatTheyLieOnComesFirst) {
  Contours contours{straight(100, 0.0), straight(100, 10.0), straight(100, 20.0)};
  apply_ends(contours, Vec2(30, 19), {});
  EXPECT_EQ(contours[0].points_px[0], Vec2(30, 20));
  EXPECT_EQ(contours[1].points_px[0], Vec2(0, 0)) << "the others keep their order";
  EXPECT_EQ(contours[2].points_px[0], Vec2(0, 10));
}

PixelContour ring() {
  PixelContour out;
  out.width_px = 2.0;
  for (int i = 0; i < 100; ++i) out.points_px.emplace_back(i, i < 50 ? i : 100 - i);
  return out;
}

TEST(Ends, OfARingLeaveTheLongerWay) {
  const auto cut = [](double start, double end) {
    Contours contours{ring()};
    const PixelContour whole = ring();
    apply_ends(contours, whole.points_px[static_cast<std::size_t>(start)],
               whole.points_px[static_cast<std::size_t>(end)]);
    return contours[0];
  };
  const PixelContour far = cut(10, 80);  // on through 80
  EXPECT_FALSE(far.closed);
  EXPECT_EQ(far.points_px.size(), 71u);
  EXPECT_EQ(far.points_px[1].x(), 11);
  EXPECT_EQ(far.points_px.back().x(), 80);
  const PixelContour near = cut(10, 40);  // back through 9, 0, 99
  EXPECT_FALSE(near.closed);
  EXPECT_EQ(near.points_px.size(), 71u);
  EXPECT_EQ(near.points_px[1].x(), 9);
  EXPECT_EQ(near.points_px.back().x(), 40);
  EXPECT_TRUE(cut(10, 18).closed) << "eight points on: all the way round";
  EXPECT_FALSE(cut(10, 19).closed);
  EXPECT_TRUE(cut(10, 2).closed);
  EXPECT_FALSE(cut(10, 1).closed);
  Contours turned{ring()};
  apply_ends(turned, ring().points_px[30], {});
  EXPECT_TRUE(turned[0].closed);
  EXPECT_EQ(turned[0].points_px.size(), 100u);
  EXPECT_EQ(turned[0].points_px[0].x(), 30);
}

/// A page of 40 x 20 mm: a line of 20 mm, and one of 8 mm above it.
LoadedContours drawing(const LoadRequest& request) {
  const auto file =
      std::filesystem::temp_directory_path() / ("telekerf-ends-" + std::to_string(::getpid()) + ".svg");
  std::ofstream(file) << "<svg stroke='black' fill='none' width='40mm' height='20mm' viewBox='0 0 40 "
                         "20'><path d='M20 4h8'/><path d='M10 12h20'/></svg>";
  const auto out = load_contours(file.string(), request);
  std::filesystem::remove(file);
  EXPECT_TRUE(out) << out.error();
  return out.value_or(LoadedContours{});
}

TEST(LoadDrawing, SizeAndAnchorAreAsAsked) {
  const auto at = [](const LoadedContours& l, std::size_t line, double x0, double x1, double y) {
    ASSERT_EQ(l.contours.size(), 2u);
    const auto& p = l.contours[line].points_m;
    EXPECT_NEAR((p.front() - 1e-3 * Vec2(x0, y)).norm() + (p.back() - 1e-3 * Vec2(x1, y)).norm(), 0.0, 1e-12)
        << line << ": " << p.front().transpose() << " to " << p.back().transpose();
  };
  LoadRequest request;
  at(drawing(request), 0, -10, 10, 0);  // the longest first, its box on the origin
  at(drawing(request), 1, 0, 8, 8);
  request.select = 1;
  at(drawing(request), 1, -4, 4, 0);
  request.fit_all = true;
  at(drawing(request), 0, -10, 10, -4);
  request.scale.anchor = AnchorMode::kFirstPoint;
  at(drawing(request), 1, 0, 8, 0);
  request.scale.anchor = AnchorMode::kImageCentre;
  at(drawing(request), 0, -10, 10, -2);
  request.scale.picture_width_m = 0.02;  // half the page's width
  at(drawing(request), 0, -5, 5, -1);
  at(drawing(request), 1, 0, 4, 3);
}

TEST(Overlay, ShowsTheChosenLineInRedAndItsStartInGreen) {
  LoadedContours loaded;
  loaded.contours = {{{{0.0, 0.0}, {0.02, 0.0}, {0.02, 0.01}}, false}, {{{0.0, 0.01}, {0.005, 0.01}}, false}};
  const cv::Mat picture = overlay_of(loaded);
  ASSERT_EQ(picture.cols, 800);
  ASSERT_EQ(picture.rows, 420);
  const auto shows = [&](int x, int y, const cv::Vec3b& colour) {  // lines are smoothed
    return cv::norm(cv::Vec3d(picture.at<cv::Vec3b>(y, x)) - cv::Vec3d(colour)) < 40.0;
  };
  EXPECT_TRUE(shows(400, 400, {0, 0, 220}));
  EXPECT_TRUE(shows(780, 200, {0, 0, 220}));
  EXPECT_TRUE(shows(20, 400, {0, 160, 0}));
  EXPECT_TRUE(shows(150, 20, {200, 120, 0}));
  EXPECT_TRUE(shows(400, 200, {255, 255, 255}));
  loaded.picture = cv::Mat(100, 200, CV_8U, cv::Scalar(100));
  loaded.scale.metres_per_pixel = 1e-4;
  loaded.scale.anchor_px = {0, 99};
  const cv::Mat over = overlay_of(loaded);
  ASSERT_EQ(over.size(), loaded.picture.size());
  EXPECT_EQ(over.at<cv::Vec3b>(50, 50), cv::Vec3b(160, 160, 160)) << "half as bright, and paler";
  EXPECT_LT(over.at<cv::Vec3b>(99, 100)[1], 30);
}

}  // namespace
}  // namespace telekerf::vision
