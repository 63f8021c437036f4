// SPDX-License-Identifier: Apache-2.0
// Drawings with a known truth, seen through blur (1.2 px), noise (sigma 8) and uneven light, at several
// angles and sizes.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/imgproc.hpp>

#include "common/vision/extraction/contour_extraction.h"
#include "tests/unit/vision/truth.h"

namespace telekerf::vision {
namespace {

struct Case {
  const char* shape;
  ExtractionMode mode;
  ExtractionMode used;  ///< what auto chooses
};

class Truth : public testing::TestWithParam<Case> {};

TEST_P(Truth, PointsLieOnTheDrawingInOrder) {
  for (int round = 0; round < 4; ++round) {
    const drawing::Drawing drawing = turned(GetParam().shape, round);
    const auto found = extract(drawing::render(drawing, hard_appearance(round)), {.mode = GetParam().mode});
    ASSERT_TRUE(found) << found.error();
    EXPECT_EQ(found->mode, GetParam().used);
    const PixelContour& contour = found->contours.front();
    ASSERT_EQ(contour.closed, drawing.lines_px.front().closed) << "round " << round;
    const Comparison c = compare(contour, drawing.lines_px.front());
    EXPECT_LT(c.rms_px, 0.5) << "round " << round;
    EXPECT_LT(c.max_px, 2.0) << "round " << round;
    EXPECT_LT(c.missed_px, 2.0) << "round " << round;
    EXPECT_NEAR(c.length_ratio, 1.0, 0.02) << "round " << round;
    EXPECT_LT(c.backwards, 0.01) << "round " << round;
    EXPECT_NEAR(c.once, 1.0, 0.03) << "round " << round;  // every branch once, the crossing twice
  }
}

std::string name_of_case(const testing::TestParamInfo<Case>& info) {
  std::string out = std::string(info.param.shape) + "_" + std::string(kExtractionModes.word(info.param.mode));
  std::replace(out.begin(), out.end(), '-', '_');
  return out;
}

INSTANTIATE_TEST_SUITE_P(Drawings, Truth,
                         testing::Values(Case{"line", ExtractionMode::kAuto, ExtractionMode::kStroke},
                                         Case{"circle", ExtractionMode::kAuto, ExtractionMode::kStroke},
                                         Case{"figure-8", ExtractionMode::kAuto, ExtractionMode::kStroke},
                                         Case{"spiral", ExtractionMode::kAuto, ExtractionMode::kStroke},
                                         Case{"heart", ExtractionMode::kAuto, ExtractionMode::kStroke},
                                         Case{"letter-s", ExtractionMode::kAuto, ExtractionMode::kStroke},
                                         Case{"script-e", ExtractionMode::kAuto, ExtractionMode::kStroke},
                                         Case{"gear", ExtractionMode::kAuto, ExtractionMode::kOutline},
                                         Case{"cam", ExtractionMode::kAuto, ExtractionMode::kOutline},
                                         Case{"octagon", ExtractionMode::kAuto, ExtractionMode::kOutline},
                                         Case{"letter-e", ExtractionMode::kAuto, ExtractionMode::kOutline},
                                         Case{"blob", ExtractionMode::kAuto, ExtractionMode::kOutline},
                                         Case{"line", ExtractionMode::kThesis, ExtractionMode::kThesis},
                                         Case{"circle", ExtractionMode::kThesis, ExtractionMode::kThesis},
                                         Case{"figure-8", ExtractionMode::kThesis, ExtractionMode::kThesis},
                                         Case{"spiral", ExtractionMode::kThesis, ExtractionMode::kThesis},
                                         Case{"script-e", ExtractionMode::kThesis, ExtractionMode::kThesis},
                                         Case{"letter-s", ExtractionMode::kThesis, ExtractionMode::kThesis},
                                         Case{"cam", ExtractionMode::kThesis, ExtractionMode::kThesis},
                                         Case{"octagon", ExtractionMode::kThesis, ExtractionMode::kThesis},
                                         Case{"gear", ExtractionMode::kThesis, ExtractionMode::kThesis},
                                         Case{"blob", ExtractionMode::kThesis, ExtractionMode::kThesis}),
                         name_of_case);

/// A pen drawing of straight lines between points of a unit circle's size.
drawing::Drawing penned(std::vector<Vec2> points, bool closed, double pen_px) {
  for (Vec2& p : points) p = Vec2(319.5, 239.5) + 180.0 * Vec2(p.x(), -p.y());
  return {{{std::move(points), closed}}, false, pen_px};
}

std::vector<Vec2> star_points(int stride, double inner) {
  std::vector<Vec2> out;
  for (int i = 0; i < (inner > 0.0 ? 10 : 5); ++i) {
    const double a = 0.2 + (inner > 0.0 ? M_PI / 5.0 * i : 2.0 * M_PI / 5.0 * stride * i);
    out.push_back((inner > 0.0 && i % 2 == 1 ? inner : 1.0) * Vec2(std::cos(a), std::sin(a)));
  }
  return out;
}

TEST(Extract, SharpCornersOfAStrokeAreGoneRound) {
  for (const double pen : {3.0, 5.0, 8.0}) {
    const std::vector<drawing::Drawing> drawings{
        penned({{-1, -.5}, {-.6, .5}, {-.2, -.5}, {.2, .5}, {.6, -.5}, {1, .5}}, false, pen),  // 44 degrees
        penned({{-.6, -.8}, {-.6, .8}, {.6, -.8}, {.6, .8}}, false, pen),                      // 37
        penned(star_points(1, 0.42), true, pen),                                               // 43
        penned(star_points(2, 0.0), true, pen)};  // 36, and five crossings
    for (const drawing::Drawing& drawing : drawings) {
      for (const ExtractionMode mode : {ExtractionMode::kStroke, ExtractionMode::kThesis}) {
        const auto found = extract(drawing::render(drawing, hard_appearance(2)), {.mode = mode});
        ASSERT_TRUE(found) << found.error();
        const PixelContour& contour = found->contours.front();
        EXPECT_EQ(contour.closed, drawing.lines_px.front().closed);
        const Comparison c = compare(contour, drawing.lines_px.front());
        const auto what = testing::Message() << kExtractionModes.word(mode) << ", pen " << pen << ", "
                                             << drawing.lines_px.front().size() << " corners";
        EXPECT_LT(c.rms_px, 0.5) << what;
        EXPECT_LT(c.max_px, 2.0) << what;
        EXPECT_NEAR(c.length_ratio, 1.0, 0.02) << what;
        EXPECT_NEAR(c.once, 1.0, 0.03) << what;
      }
    }
  }
}

/// Largest turn within four pixels, at least `margin_px` from the drawing's sharp corners and from its ends.
double sharpest_turn(const PixelContour& contour, const std::vector<Vec2>& corners, double margin_px) {
  const auto& p = contour.points_px;
  const std::size_t n = p.size();
  constexpr std::size_t kReach = 2;
  double most = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    if (!contour.closed && (i < kReach || i + kReach >= n)) continue;
    if (std::any_of(corners.begin(), corners.end(),
                    [&](const Vec2& c) { return (c - p[i]).norm() < margin_px; }))
      continue;
    const Vec2 in = p[i] - p[(i + n - kReach) % n];
    const Vec2 out = p[(i + kReach) % n] - p[i];
    most = std::max(most, std::abs(std::atan2(geometry::cross(in, out), in.dot(out))));
  }
  return most;
}

TEST(Extract, StrokesAreSmoothUpToTheirCorners) {
  for (const double pen : {3.0, 5.0, 8.0, 12.0}) {
    for (int round = 0; round < 4; ++round) {
      drawing::Drawing drawing = turned("heart", round);
      drawing.pen_px = pen;
      const auto& truth = drawing.lines_px.front().points_m;
      const auto found = extract(drawing::render(drawing, hard_appearance(round)));
      ASSERT_TRUE(found) << found.error();
      const PixelContour& contour = found->contours.front();
      EXPECT_LT(compare(contour, drawing.lines_px.front()).max_px, 1.0)
          << "pen " << pen << ", round " << round;
      EXPECT_LT(sharpest_turn(contour, {truth[0], truth[truth.size() / 2]}, 3.5), 0.14)
          << "pen " << pen << ", round " << round;
    }
  }
}

TEST(Extract, StrokesThatCrossAtASmallAngleGoStraightOn) {
  for (const double pen : {3.0, 6.0, 9.0}) {
    drawing::Drawing drawing{{{{}, true}}, false, pen};
    for (int i = 0; i < 1800; ++i) {
      const double a = 2.0 * M_PI * i / 1800.0;
      drawing.lines_px[0].points_m.emplace_back(319.5 + 190.0 * std::sin(3 * a + 0.4),
                                                239.5 + 180.0 * std::sin(2 * a));
    }
    const auto found = extract(drawing::render(drawing, hard_appearance(1)));
    ASSERT_TRUE(found) << found.error();
    const Comparison c = compare(found->contours.front(), drawing.lines_px.front());
    EXPECT_TRUE(found->contours.front().closed);
    EXPECT_LT(c.rms_px, 0.5) << pen;
    EXPECT_NEAR(c.length_ratio, 1.0, 0.02) << pen;
    EXPECT_LT(c.missed_px, 4.0) << pen;
  }
}

TEST(Extract, CornersOfARegionAreSharpAndCurvesStayRound) {
  drawing::Drawing star = penned(star_points(1, 0.42), true, 1.0);
  star.filled = true;
  drawing::Drawing waves{{{{}, true}}, true, 1.0};
  for (int i = 0; i < 2400; ++i) {
    const double a = 2.0 * M_PI * i / 2400.0;
    const double r = 180.0 * (0.9 + 0.08 * std::sin(24 * a));
    waves.lines_px[0].points_m.emplace_back(319.5 + r * std::cos(a), 239.5 + r * std::sin(a));
  }
  for (const drawing::Drawing& drawing : {star, waves}) {
    const auto found =
        extract(drawing::render(drawing, hard_appearance(1)), {.mode = ExtractionMode::kOutline});
    ASSERT_TRUE(found) << found.error();
    const Comparison c = compare(found->contours.front(), drawing.lines_px.front());
    EXPECT_LT(c.max_px, 1.5);
    EXPECT_LT(c.missed_px, 2.0);
  }
}

TEST(Extract, PensOfAnyWidthAndFaintLines) {
  for (const double pen : {1.0, 2.0, 3.0, 8.0, 14.0, 20.0, 30.0}) {
    for (const char* shape : {"circle", "figure-8", "letter-s"}) {
      drawing::Drawing drawing = turned(shape, 1);
      drawing.pen_px = pen;
      const auto found = extract(drawing::render(drawing, hard_appearance(3)));
      ASSERT_TRUE(found) << found.error();
      EXPECT_EQ(found->mode, ExtractionMode::kStroke);
      const Comparison c = compare(found->contours.front(), drawing.lines_px.front());
      EXPECT_LT(c.rms_px, 0.5) << shape << " pen " << pen;
      EXPECT_LT(c.missed_px, 2.0) << shape << " pen " << pen;
    }
  }
}

TEST(Extract, LightOnDarkIsTheSameDrawing) {
  const drawing::Drawing drawing = turned("script-e", 1);
  const cv::Mat picture = drawing::render(drawing, hard_appearance(1));
  const auto found = extract(255 - picture);
  ASSERT_TRUE(found) << found.error();
  EXPECT_LT(compare(found->contours.front(), drawing.lines_px.front()).rms_px, 0.5);
}

TEST(Extract, HolesAreContoursOfTheirOwn) {
  const drawing::Drawing drawing = turned("flange", 1);
  const auto found = extract(drawing::render(drawing, hard_appearance(1)));
  ASSERT_TRUE(found) << found.error();
  ASSERT_EQ(found->contours.size(), 7u);
  EXPECT_FALSE(found->contours[0].hole);
  for (std::size_t i = 1; i < 7; ++i) EXPECT_TRUE(found->contours[i].hole);
}

TEST(Extract, EndsCanBeGivenAndCutThePath) {
  const drawing::Drawing drawing = *drawing::by_name("letter-s");
  const cv::Mat picture = drawing::render(drawing, hard_appearance(1));
  const geometry::Polyline& truth = drawing.lines_px.front();
  const Vec2 first = truth.points_m.front();
  const Vec2 last = truth.points_m.back();
  const Vec2 quarter = geometry::NearestIndex(truth).at(0.25 * geometry::length_m(truth)).point_m;
  for (const bool swap : {false, true}) {
    const auto found = extract(picture, {.start_px = swap ? last : first, .end_px = swap ? first : last});
    ASSERT_TRUE(found) << found.error();
    const auto& p = found->contours.front().points_px;
    EXPECT_LT((p.front() - (swap ? last : first)).norm(), 2.0);
    EXPECT_LT((p.back() - (swap ? first : last)).norm(), 2.0);
  }
  const auto part = extract(picture, {.start_px = quarter, .end_px = last});
  ASSERT_TRUE(part);
  const auto& p = part->contours.front().points_px;
  EXPECT_LT((p.front() - quarter).norm(), 1.5);
  EXPECT_NEAR(geometry::length_m({p, false}), 0.75 * geometry::length_m(truth), 5.0);
  const auto ring =
      extract(drawing::render(*drawing::by_name("circle"), hard_appearance(1)), {.start_px = Vec2(500, 240)});
  ASSERT_TRUE(ring);
  EXPECT_LT((ring->contours.front().points_px.front() - Vec2(501, 240)).norm(), 3.0);
}

TEST(Extract, DepthsAlphaAndPalettesAreTheSamePicture) {
  const drawing::Drawing drawing = turned("cam", 1);
  const cv::Mat grey = drawing::render(drawing, hard_appearance(1));
  std::vector<cv::Mat> pictures;
  cv::Mat wide;
  grey.convertTo(wide, CV_16U, 200.0, 900.0);
  pictures.push_back(wide);
  cv::Mat real;
  grey.convertTo(real, CV_32F, 1.0 / 255.0);
  pictures.push_back(real);
  cv::Mat colour;
  cv::cvtColor(grey, colour, cv::COLOR_GRAY2BGR);
  pictures.push_back(colour);
  // A white drawing on nothing: only alpha knows it.
  cv::Mat alpha(grey.size(), CV_8UC4, cv::Scalar(255, 255, 255, 0));
  cv::Mat coverage = 255 - grey;
  cv::insertChannel(coverage, alpha, 3);
  pictures.push_back(alpha);
  // A black drawing on transparency.
  cv::Mat ink(grey.size(), CV_8UC4, cv::Scalar(0, 0, 0, 0));
  cv::insertChannel(coverage, ink, 3);
  pictures.push_back(ink);
  // Red on green of the same brightness.
  cv::Mat red(grey.size(), CV_8UC3);
  for (int y = 0; y < grey.rows; ++y) {
    for (int x = 0; x < grey.cols; ++x) {
      const double u = (228.0 - grey.at<unsigned char>(y, x)) / 188.0;
      red.at<cv::Vec3b>(y, x) = {60, cv::saturate_cast<unsigned char>(130 - 80 * u),
                                 cv::saturate_cast<unsigned char>(50 + 157 * u)};
    }
  }
  pictures.push_back(red);
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    const auto found = extract(pictures[i]);
    ASSERT_TRUE(found) << i << ": " << found.error();
    EXPECT_LT(compare(found->contours.front(), drawing.lines_px.front()).rms_px, 0.5) << "picture " << i;
  }
}

}  // namespace
}  // namespace telekerf::vision
