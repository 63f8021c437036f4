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

/// The largest of all rounds, as it is, with OpenCV 4.6 or 4.10.
struct Reached {
  double rms_px, max_px, missed_px;
  double least_mean_px, most_mean_px;
  double length_error;  ///< as a fraction
};

struct Case {
  const char* shape;
  ExtractionMode mode;
  ExtractionMode used;  ///< what auto chooses
  Reached reached;
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
    const Reached& reached = GetParam().reached;
    EXPECT_LT(c.rms_px, 1.15 * reached.rms_px) << "round " << round;
    EXPECT_LT(c.max_px, 1.15 * reached.max_px) << "round " << round;
    EXPECT_LT(c.missed_px, 1.15 * reached.missed_px) << "round " << round;
    EXPECT_GT(c.mean_px, reached.least_mean_px - 0.01) << "round " << round;
    EXPECT_LT(c.mean_px, reached.most_mean_px + 0.01) << "round " << round;
    EXPECT_NEAR(c.length_ratio, 1.0, 1.15 * reached.length_error + 1e-4) << "round " << round;
    EXPECT_LT(c.backwards, 0.004) << "round " << round;
    EXPECT_NEAR(c.once, 1.0, 0.001) << "round " << round;  // every branch once, the crossing twice
  }
}

std::string name_of_case(const testing::TestParamInfo<Case>& info) {
  std::string out = std::string(info.param.shape) + "_" + std::string(kExtractionModes.word(info.param.mode));
  std::replace(out.begin(), out.end(), '-', '_');
  return out;
}

INSTANTIATE_TEST_SUITE_P(Drawings, Truth,
                         testing::Values(Case{"line",
                                              ExtractionMode::kAuto,
                                              ExtractionMode::kStroke,
                                              {0.064, 0.50, 0.51, 0.002, 0.012, 0.0011}},
                                         Case{"circle",
                                              ExtractionMode::kAuto,
                                              ExtractionMode::kStroke,
                                              {0.037, 0.13, 0.13, -0.014, -0.006, 0.0001}},
                                         Case{"figure-8",
                                              ExtractionMode::kAuto,
                                              ExtractionMode::kStroke,
                                              {0.038, 0.14, 0.14, -0.001, 0.001, 0.0001}},
                                         Case{"spiral",
                                              ExtractionMode::kAuto,
                                              ExtractionMode::kStroke,
                                              {0.039, 0.28, 0.23, -0.016, -0.012, 0.0001}},
                                         Case{"heart",
                                              ExtractionMode::kAuto,
                                              ExtractionMode::kStroke,
                                              {0.080, 0.84, 0.94, 0.003, 0.008, 0.0027}},
                                         Case{"letter-s",
                                              ExtractionMode::kAuto,
                                              ExtractionMode::kStroke,
                                              {0.045, 0.39, 0.42, 0.001, 0.003, 0.0004}},
                                         Case{"script-e",
                                              ExtractionMode::kAuto,
                                              ExtractionMode::kStroke,
                                              {0.053, 0.33, 0.33, -0.007, 0.003, 0.0004}},
                                         Case{"gear",
                                              ExtractionMode::kAuto,
                                              ExtractionMode::kOutline,
                                              {0.180, 0.98, 1.21, 0.077, 0.095, 0.0043}},
                                         Case{"cam",
                                              ExtractionMode::kAuto,
                                              ExtractionMode::kOutline,
                                              {0.083, 0.24, 0.23, 0.061, 0.067, 0.0009}},
                                         Case{"octagon",
                                              ExtractionMode::kAuto,
                                              ExtractionMode::kOutline,
                                              {0.111, 0.52, 0.64, 0.033, 0.085, 0.0017}},
                                         Case{"letter-e",
                                              ExtractionMode::kAuto,
                                              ExtractionMode::kOutline,
                                              {0.103, 0.48, 0.44, 0.078, 0.079, 0.0012}},
                                         Case{"blob",
                                              ExtractionMode::kAuto,
                                              ExtractionMode::kOutline,
                                              {0.093, 0.32, 0.32, 0.062, 0.075, 0.0006}},
                                         Case{"line",
                                              ExtractionMode::kThesis,
                                              ExtractionMode::kThesis,
                                              {0.058, 0.38, 0.40, 0.001, 0.013, 0.0009}},
                                         Case{"circle",
                                              ExtractionMode::kThesis,
                                              ExtractionMode::kThesis,
                                              {0.037, 0.13, 0.13, -0.014, -0.006, 0.0001}},
                                         Case{"figure-8",
                                              ExtractionMode::kThesis,
                                              ExtractionMode::kThesis,
                                              {0.038, 0.14, 0.14, -0.003, 0.003, 0.0001}},
                                         Case{"spiral",
                                              ExtractionMode::kThesis,
                                              ExtractionMode::kThesis,
                                              {0.039, 0.26, 0.26, -0.016, -0.012, 0.0001}},
                                         Case{"script-e",
                                              ExtractionMode::kThesis,
                                              ExtractionMode::kThesis,
                                              {0.055, 0.36, 0.35, -0.008, 0.001, 0.0003}},
                                         Case{"letter-s",
                                              ExtractionMode::kThesis,
                                              ExtractionMode::kThesis,
                                              {0.042, 0.27, 0.28, 0.000, 0.002, 0.0003}},
                                         Case{"cam",
                                              ExtractionMode::kThesis,
                                              ExtractionMode::kThesis,
                                              {0.095, 0.25, 0.25, 0.051, 0.059, 0.0007}},
                                         Case{"octagon",
                                              ExtractionMode::kThesis,
                                              ExtractionMode::kThesis,
                                              {0.122, 0.62, 0.63, -0.000, 0.049, 0.0020}},
                                         Case{"gear",
                                              ExtractionMode::kThesis,
                                              ExtractionMode::kThesis,
                                              {0.182, 0.97, 1.35, 0.044, 0.067, 0.0067}},
                                         Case{"blob",
                                              ExtractionMode::kThesis,
                                              ExtractionMode::kThesis,
                                              {0.089, 0.28, 0.28, 0.024, 0.038, 0.0003}}),
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

/// Thin by area and rim, as a stroke is, and no pen's line.
TEST(Extract, SquaresThatTouchInTheirCornersAreNoStroke) {
  for (const int side : {40, 73}) {
    cv::Mat board(7 * side + 80, 9 * side + 80, CV_8U, cv::Scalar(235));
    for (int row = 0; row < 7; ++row) {
      for (int column = row % 2; column < 9; column += 2)
        board({40 + column * side, 40 + row * side, side, side}).setTo(90);
    }
    const auto found = extract(board, {});
    ASSERT_TRUE(found) << found.error();
    EXPECT_EQ(found->mode, ExtractionMode::kOutline) << side;
    EXPECT_GT(found->contours.size(), 1U) << side;
  }
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
        EXPECT_LT(c.rms_px, 0.17) << what;
        EXPECT_LT(c.max_px, 1.8) << what;
        EXPECT_NEAR(c.length_ratio, 1.0, 0.018) << what;
        EXPECT_NEAR(c.once, 1.0, 0.002) << what;
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
      const Comparison c = compare(contour, drawing.lines_px.front());
      EXPECT_LT(c.rms_px, 0.105) << "pen " << pen << ", round " << round;
      EXPECT_NEAR(c.mean_px, 0.0, 0.012) << "pen " << pen << ", round " << round;
      EXPECT_LT(c.max_px, 1.05) << "pen " << pen << ", round " << round;
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
    EXPECT_LT(c.rms_px, 0.145) << pen;
    EXPECT_NEAR(c.length_ratio, 1.0, 0.001) << pen;
    EXPECT_LT(c.missed_px, 0.75) << pen;
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
    EXPECT_LT(c.rms_px, 0.19);
    EXPECT_LT(c.max_px, 0.73);
    EXPECT_LT(c.missed_px, 0.78);
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
      EXPECT_LT(c.rms_px, 0.135) << shape << " pen " << pen;
      EXPECT_NEAR(c.mean_px, 0.0, 0.018) << shape << " pen " << pen;
      EXPECT_LT(c.missed_px, 1.65) << shape << " pen " << pen;
    }
  }
}

TEST(Extract, LightOnDarkIsTheSameDrawing) {
  const drawing::Drawing drawing = turned("script-e", 1);
  const cv::Mat picture = drawing::render(drawing, hard_appearance(1));
  const auto found = extract(255 - picture);
  ASSERT_TRUE(found) << found.error();
  EXPECT_LT(compare(found->contours.front(), drawing.lines_px.front()).rms_px, 0.052);
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
    EXPECT_LT((p.front() - (swap ? last : first)).norm(), 0.2);
    EXPECT_LT((p.back() - (swap ? first : last)).norm(), 0.2);
  }
  const auto part = extract(picture, {.start_px = quarter, .end_px = last});
  ASSERT_TRUE(part);
  const auto& p = part->contours.front().points_px;
  EXPECT_LT((p.front() - quarter).norm(), 0.6);
  EXPECT_NEAR(geometry::length_m({p, false}), 0.75 * geometry::length_m(truth), 1.5);
  const auto ring =
      extract(drawing::render(*drawing::by_name("circle"), hard_appearance(1)), {.start_px = Vec2(500, 240)});
  ASSERT_TRUE(ring);
  EXPECT_LT((ring->contours.front().points_px.front() - Vec2(501, 240)).norm(), 0.6);
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
    EXPECT_LT(compare(found->contours.front(), drawing.lines_px.front()).rms_px, 0.1) << "picture " << i;
  }
}

}  // namespace
}  // namespace telekerf::vision
