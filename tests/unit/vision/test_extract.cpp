// SPDX-License-Identifier: Apache-2.0
// Drawings with a known truth, seen through blur (1.2 px), noise (sigma 8) and uneven light, at several
// angles and sizes.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/imgproc.hpp>

#include "common/vision/extract.h"
#include "common/vision/modes.h"
#include "common/vision/scaling.h"
#include "common/vision/skeleton.h"
#include "tests/unit/vision/truth.h"

namespace telekerf::vision {
namespace {

drawing::Look hard_look(int round) {
  drawing::Look look;
  look.blur_px = 1.2;
  look.noise = 8.0;
  look.shading = 20.0;
  look.seed = static_cast<std::uint64_t>(round) + 1;
  return look;
}

drawing::Drawing turned(const std::string& name, int round) {
  return drawing::transformed(*drawing::by_name(name), 0.41 * round, 1.0 - 0.06 * round, {319.5, 239.5},
                              {3.3 * round, -2.1 * round});
}

struct Case {
  const char* shape;
  Mode mode;
  Mode used;  ///< what auto chooses
};

class Truth : public testing::TestWithParam<Case> {};

TEST_P(Truth, PointsLieOnTheDrawingInOrder) {
  for (int round = 0; round < 4; ++round) {
    const drawing::Drawing drawing = turned(GetParam().shape, round);
    const auto found = extract(drawing::render(drawing, hard_look(round)), {.mode = GetParam().mode});
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
  std::string out = std::string(info.param.shape) + "_" + std::string(name_of(info.param.mode));
  std::replace(out.begin(), out.end(), '-', '_');
  return out;
}

INSTANTIATE_TEST_SUITE_P(
    Drawings, Truth,
    testing::Values(Case{"line", Mode::kAuto, Mode::kStroke}, Case{"circle", Mode::kAuto, Mode::kStroke},
                    Case{"figure-8", Mode::kAuto, Mode::kStroke}, Case{"spiral", Mode::kAuto, Mode::kStroke},
                    Case{"heart", Mode::kAuto, Mode::kStroke}, Case{"letter-s", Mode::kAuto, Mode::kStroke},
                    Case{"script-e", Mode::kAuto, Mode::kStroke}, Case{"gear", Mode::kAuto, Mode::kOutline},
                    Case{"cam", Mode::kAuto, Mode::kOutline}, Case{"octagon", Mode::kAuto, Mode::kOutline},
                    Case{"letter-e", Mode::kAuto, Mode::kOutline}, Case{"blob", Mode::kAuto, Mode::kOutline},
                    Case{"line", Mode::kThesis, Mode::kThesis}, Case{"circle", Mode::kThesis, Mode::kThesis},
                    Case{"figure-8", Mode::kThesis, Mode::kThesis},
                    Case{"spiral", Mode::kThesis, Mode::kThesis},
                    Case{"script-e", Mode::kThesis, Mode::kThesis},
                    Case{"letter-s", Mode::kThesis, Mode::kThesis}, Case{"cam", Mode::kThesis, Mode::kThesis},
                    Case{"octagon", Mode::kThesis, Mode::kThesis}, Case{"gear", Mode::kThesis, Mode::kThesis},
                    Case{"blob", Mode::kThesis, Mode::kThesis}),
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
      for (const Mode mode : {Mode::kStroke, Mode::kThesis}) {
        const auto found = extract(drawing::render(drawing, hard_look(2)), {.mode = mode});
        ASSERT_TRUE(found) << found.error();
        const PixelContour& contour = found->contours.front();
        EXPECT_EQ(contour.closed, drawing.lines_px.front().closed);
        const Comparison c = compare(contour, drawing.lines_px.front());
        const auto what = testing::Message() << name_of(mode) << ", pen " << pen << ", "
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
      const auto found = extract(drawing::render(drawing, hard_look(round)));
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
    const auto found = extract(drawing::render(drawing, hard_look(1)));
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
    const auto found = extract(drawing::render(drawing, hard_look(1)), {.mode = Mode::kOutline});
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
      const auto found = extract(drawing::render(drawing, hard_look(3)));
      ASSERT_TRUE(found) << found.error();
      EXPECT_EQ(found->mode, Mode::kStroke);
      const Comparison c = compare(found->contours.front(), drawing.lines_px.front());
      EXPECT_LT(c.rms_px, 0.5) << shape << " pen " << pen;
      EXPECT_LT(c.missed_px, 2.0) << shape << " pen " << pen;
    }
  }
}

TEST(Extract, FaintDrawingsShadowsAndUnevenLight) {
  const drawing::Drawing circle = turned("circle", 1);
  const geometry::Polyline& truth = circle.lines_px.front();
  drawing::Look faint = hard_look(1);
  faint.paper = 140.0;
  faint.ink = 118.0;
  faint.shading = 0.0;
  const cv::Mat clean = drawing::render(circle, {.blur_px = 1.0, .noise = 0.0});
  cv::Mat shadow(clean.size(), CV_8U);
  cv::Mat lamp(clean.size(), CV_8U);
  cv::Mat noise(clean.size(), CV_32F);
  cv::RNG(3).fill(noise, cv::RNG::NORMAL, 0.0, 6.0);
  for (int y = 0; y < clean.rows; ++y) {
    for (int x = 0; x < clean.cols; ++x) {
      const double across = 1.0 / (1.0 + std::exp((400.0 - x - 0.3 * y) / 8.0));
      const double far = std::hypot(x - 100, y - 80) / 700.0;
      const double value = clean.at<unsigned char>(y, x);
      shadow.at<unsigned char>(y, x) =
          cv::saturate_cast<unsigned char>(value * (1.0 - 0.4 * across) + noise.at<float>(y, x));
      lamp.at<unsigned char>(y, x) =
          cv::saturate_cast<unsigned char>(value * (1.0 - 0.6 * far) + noise.at<float>(y, x));
    }
  }
  for (const cv::Mat& picture : {drawing::render(circle, faint), shadow, lamp}) {
    const auto found = extract(picture);
    ASSERT_TRUE(found) << found.error();
    EXPECT_EQ(found->mode, Mode::kStroke);
    const Comparison c = compare(found->contours.front(), truth);
    EXPECT_LT(c.rms_px, 0.5);
    EXPECT_LT(c.max_px, 2.0);
    EXPECT_LT(c.missed_px, 2.0);
  }
}

/// The picture where a shadow of soft edge lies over the part on one side of a line through the middle.
cv::Mat in_half_shadow(const cv::Mat& picture, double angle_rad, double darker, double edge_px) {
  cv::Mat out(picture.size(), CV_8U);
  for (int y = 0; y < picture.rows; ++y) {
    for (int x = 0; x < picture.cols; ++x) {
      const double beyond =
          (x - 0.5 * picture.cols) * std::cos(angle_rad) + (y - 0.5 * picture.rows) * std::sin(angle_rad);
      const double light = 1.0 - darker / (1.0 + std::exp(-beyond / edge_px));
      out.at<unsigned char>(y, x) = cv::saturate_cast<unsigned char>(light * picture.at<unsigned char>(y, x));
    }
  }
  return out;
}

TEST(Extract, AShadowsEdgeIsNoPartOfADrawing) {
  struct Expected {
    const char* shape;
    Mode mode;
  };
  for (const Expected& c : {Expected{"figure-8", Mode::kStroke}, Expected{"spiral", Mode::kStroke},
                            Expected{"letter-s", Mode::kStroke}, Expected{"circle", Mode::kStroke},
                            Expected{"blob", Mode::kOutline}, Expected{"gear", Mode::kOutline}}) {
    const drawing::Drawing drawing = turned(c.shape, 1);
    for (const double angle : {0.4, 2.0, 3.9}) {
      const cv::Mat lit =
          drawing::render(drawing, {.paper = 205.0, .ink = 60.0, .blur_px = 1.5, .noise = 3.0});
      const auto found = extract(in_half_shadow(lit, angle, 0.3, 12.0));
      ASSERT_TRUE(found) << c.shape << ": " << found.error();
      EXPECT_EQ(found->mode, c.mode) << c.shape << " " << found->why;
      const Comparison off = compare(found->contours.front(), drawing.lines_px.front());
      EXPECT_LT(off.rms_px, 0.35) << c.shape << " " << angle;
      EXPECT_LT(off.max_px, 2.0) << c.shape << " " << angle;
      EXPECT_LT(off.missed_px, 2.0) << c.shape << " " << angle;
    }
  }
}

TEST(Extract, ThinLinesOnUnevenPaperAndFaintRegionsAreFound) {
  const auto smaller = [](const char* shape, double scale) {
    return drawing::transformed(*drawing::by_name(shape), 0.7, scale, {319.5, 239.5}, {40.0, -10.0});
  };
  const drawing::Look grainy{.paper = 200.0, .ink = 10.0, .noise = 2.0, .grain = 6.0, .seed = 3};
  for (const char* shape : {"circle", "heart", "letter-s", "figure-8", "spiral"}) {
    const drawing::Drawing drawing = smaller(shape, 0.3);
    const auto found = extract(drawing::render(drawing, grainy));
    ASSERT_TRUE(found) << shape << ": " << found.error();
    EXPECT_LT(compare(found->contours.front(), drawing.lines_px.front()).rms_px, 0.5) << shape;
  }
  for (const double noise : {2.0, 8.0}) {
    const drawing::Look faint{.paper = 200.0, .ink = 182.0, .noise = noise, .seed = 3};
    for (const char* shape : {"gear", "blob", "letter-e"}) {
      const drawing::Drawing drawing = smaller(shape, 1.0);
      const auto found = extract(drawing::render(drawing, faint));
      ASSERT_TRUE(found) << shape << ": " << found.error();
      EXPECT_EQ(found->mode, Mode::kOutline) << shape << ", noise " << noise;
      EXPECT_LT(compare(found->contours.front(), drawing.lines_px.front()).rms_px, 0.8)
          << shape << ", noise " << noise;
    }
  }
}

TEST(Extract, LightOnDarkIsTheSameDrawing) {
  const drawing::Drawing drawing = turned("script-e", 1);
  const cv::Mat picture = drawing::render(drawing, hard_look(1));
  const auto found = extract(255 - picture);
  ASSERT_TRUE(found) << found.error();
  EXPECT_LT(compare(found->contours.front(), drawing.lines_px.front()).rms_px, 0.5);
}

TEST(Extract, HolesAreContoursOfTheirOwn) {
  const drawing::Drawing drawing = turned("flange", 1);
  const auto found = extract(drawing::render(drawing, hard_look(1)));
  ASSERT_TRUE(found) << found.error();
  ASSERT_EQ(found->contours.size(), 7u);
  EXPECT_FALSE(found->contours[0].hole);
  for (std::size_t i = 1; i < 7; ++i) EXPECT_TRUE(found->contours[i].hole);
}

TEST(Extract, EndsCanBeGivenAndCutThePath) {
  const drawing::Drawing drawing = *drawing::by_name("letter-s");
  const cv::Mat picture = drawing::render(drawing, hard_look(1));
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
      extract(drawing::render(*drawing::by_name("circle"), hard_look(1)), {.start_px = Vec2(500, 240)});
  ASSERT_TRUE(ring);
  EXPECT_LT((ring->contours.front().points_px.front() - Vec2(501, 240)).norm(), 3.0);
}

TEST(Extract, DepthsAlphaAndPalettesAreTheSamePicture) {
  const drawing::Drawing drawing = turned("cam", 1);
  const cv::Mat grey = drawing::render(drawing, hard_look(1));
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

std::string complaint(const cv::Mat& picture, Mode mode = Mode::kAuto) {
  const auto found = extract(picture, {.mode = mode});
  if (found) {
    EXPECT_FALSE(found->contours.empty());
    return "";
  }
  return found.error();
}

TEST(Extract, WhatIsNoDrawingIsRefusedWithAReason) {
  EXPECT_NE(complaint(cv::Mat()).find("empty"), std::string::npos);
  EXPECT_NE(complaint(cv::Mat(1, 1, CV_8U, cv::Scalar(7))).find("1 x 1"), std::string::npos);
  EXPECT_NE(complaint(cv::Mat(400, 600, CV_8UC3, cv::Scalar(90, 90, 90))).find("uniform"), std::string::npos);
  EXPECT_NE(complaint(cv::Mat(400, 600, CV_8UC2, cv::Scalar(90, 90))).find("channels"), std::string::npos);
  cv::RNG rng(1);
  for (const double sigma : {4.0, 20.0, 60.0}) {
    cv::Mat noise(480, 640, CV_8U);
    rng.fill(noise, cv::RNG::NORMAL, 128.0, sigma);
    EXPECT_NE(complaint(noise), "") << sigma;
    EXPECT_NE(complaint(noise, Mode::kThesis), "") << sigma;
    EXPECT_NE(complaint(noise, Mode::kStroke), "") << sigma;
  }
  cv::Mat uniform_noise(480, 640, CV_8U);
  rng.fill(uniform_noise, cv::RNG::UNIFORM, 0, 256);
  EXPECT_NE(complaint(uniform_noise), "");
  cv::Mat blurred = uniform_noise.clone();
  cv::GaussianBlur(blurred, blurred, {}, 1.0);
  EXPECT_NE(complaint(blurred).find("specks"), std::string::npos);
  cv::Mat ramp(480, 640, CV_8U);
  for (int x = 0; x < 640; ++x) {
    const int grey = x * 255 / 640;
    ramp.col(x) = grey;
  }
  EXPECT_NE(complaint(ramp), "");
  cv::Mat cut(480, 640, CV_8U, cv::Scalar(220));
  cv::circle(cut, {600, 240}, 150, cv::Scalar(40), -1);
  EXPECT_NE(complaint(cut).find("border"), std::string::npos);
  cv::Mat nan(100, 100, CV_32F, cv::Scalar(NAN));
  EXPECT_NE(complaint(nan), "");
}

TEST(Extract, NoiseOfAnyGrainIsNoDrawing) {
  int pictures = 0;
  int taken = 0;
  std::string which;
  for (const cv::Size size : {cv::Size(160, 120), cv::Size(320, 240), cv::Size(640, 480)}) {
    for (const double blur : {0.7, 1.0, 1.5, 2.5, 4.0, 7.0}) {
      for (const double share : {0.02, 0.1, 0.5}) {
        for (const bool in_alpha : {false, true}) {
          cv::RNG rng(static_cast<std::uint64_t>(size.width + 10.0 * blur + 1000.0 * share));
          cv::Mat noise(size, CV_8U);
          rng.fill(noise, cv::RNG::UNIFORM, 0, 256);
          noise = noise < 256.0 * share;
          cv::GaussianBlur(noise, noise, {}, blur);
          cv::Mat picture = noise;
          if (in_alpha) {
            picture = cv::Mat(size, CV_8UC4, cv::Scalar(0, 0, 0, 0));
            cv::insertChannel(noise, picture, 3);
          }
          ++pictures;
          if (!extract(picture)) continue;
          ++taken;
          which += fmt::format("{} px, blur {}, share {}\n", size.width, blur, share);
        }
      }
    }
  }
  EXPECT_LE(taken, pictures / 50) << which;
}

TEST(Extract, StrokesThatRunOffThePictureAreRefused) {
  cv::Mat cut(480, 640, CV_8U, cv::Scalar(220));
  cv::line(cut, {-10, 200}, {660, 260}, cv::Scalar(40), 6, cv::LINE_AA);
  EXPECT_NE(complaint(cut).find("border"), std::string::npos);
  EXPECT_NE(complaint(cut, Mode::kStroke).find("border"), std::string::npos);
  // A loop whose tail runs off the picture: its inside is no contour of its own.
  cv::Mat loop(480, 640, CV_8U, cv::Scalar(220));
  cv::circle(loop, {300, 240}, 120, cv::Scalar(40), 6, cv::LINE_AA);
  cv::line(loop, {420, 240}, {660, 240}, cv::Scalar(40), 6, cv::LINE_AA);
  for (const Mode mode : {Mode::kAuto, Mode::kOutline, Mode::kStroke, Mode::kThesis}) {
    EXPECT_NE(complaint(loop, mode).find("border"), std::string::npos) << name_of(mode);
  }
}

/// Guo and Hall as their paper states it, pixel by pixel, over the whole picture until nothing goes.
cv::Mat thinned_slowly(const cv::Mat& drawn) {
  cv::Mat image = drawn.clone();
  const auto at = [&](int x, int y) {
    return x >= 0 && y >= 0 && x < image.cols && y < image.rows && image.at<unsigned char>(y, x) != 0;
  };
  for (int idle = 0, step = 0; idle < 2; ++step) {
    std::vector<cv::Point> gone;
    for (int y = 0; y < image.rows; ++y) {
      for (int x = 0; x < image.cols; ++x) {
        if (!at(x, y)) continue;
        const bool p2 = at(x, y - 1), p3 = at(x + 1, y - 1), p4 = at(x + 1, y), p5 = at(x + 1, y + 1);
        const bool p6 = at(x, y + 1), p7 = at(x - 1, y + 1), p8 = at(x - 1, y), p9 = at(x - 1, y - 1);
        const int c = (!p2 && (p3 || p4)) + (!p4 && (p5 || p6)) + (!p6 && (p7 || p8)) + (!p8 && (p9 || p2));
        const int n = std::min((p9 || p2) + (p3 || p4) + (p5 || p6) + (p7 || p8),
                               (p2 || p3) + (p4 || p5) + (p6 || p7) + (p8 || p9));
        const bool side = step % 2 == 0 ? (p6 || p7 || !p9) && p8 : (p2 || p3 || !p5) && p4;
        if (c == 1 && (n == 2 || n == 3) && !side) gone.emplace_back(x, y);
      }
    }
    for (const cv::Point& p : gone) image.at<unsigned char>(p) = 0;
    idle = gone.empty() ? idle + 1 : 0;
  }
  return image;
}

TEST(Thinning, IsGuoAndHallsOnAnyPicture) {
  cv::RNG rng(7);
  for (const cv::Size size : {cv::Size(8, 9), cv::Size(63, 40), cv::Size(64, 40), cv::Size(131, 97)}) {
    for (const double blur : {0.5, 1.5, 3.0, 6.0}) {
      cv::Mat noise(size, CV_8U);
      rng.fill(noise, cv::RNG::UNIFORM, 0, 256);
      cv::GaussianBlur(noise, noise, {}, blur);
      const cv::Mat drawn = noise > cv::mean(noise)[0];
      EXPECT_EQ(cv::countNonZero(thinned(drawn) != thinned_slowly(drawn)), 0) << size << ", blur " << blur;
    }
  }
}

TEST(Scaling, CirclesStayRoundAndLettersReadable) {
  PixelContour ring;
  for (int i = 0; i < 360; ++i)
    ring.points_px.emplace_back(301.3 + 77.7 * std::cos(i * M_PI / 180),
                                99.1 + 77.7 * std::sin(i * M_PI / 180));
  for (const AnchorMode anchor :
       {AnchorMode::kBoundingBox, AnchorMode::kFirstPoint, AnchorMode::kImageCentre}) {
    const Scale scale = scale_for(ring, 640, 480, {.picture_width_m = 0.0317, .anchor = anchor});
    const auto line = to_workpiece(ring, scale);
    const auto box = geometry::bounding_box(line.points_m);
    EXPECT_NEAR(box.size().x() / box.size().y(), 1.0, 1e-12);
    EXPECT_NEAR(box.size().x(), 2 * 77.7 * 0.0317 / 640, 1e-15);
    EXPECT_LT(scale.to_workpiece(scale.anchor_px).norm(), 1e-18);
    EXPECT_LT((scale.to_picture(scale.to_workpiece({12, 34})) - Vec2(12, 34)).norm(), 1e-10);
  }
  const Scale scale = scale_for(ring, 640, 480, {.picture_width_m = 0.064});
  EXPECT_GT(scale.to_workpiece({400, 0}).y(), scale.to_workpiece({400, 100}).y());  // up stays up
  EXPECT_GT(scale.to_workpiece({400, 0}).x(), scale.to_workpiece({300, 0}).x());    // right stays right
  EXPECT_NEAR(scale.to_workpiece({639.5, 0}).x() - scale.to_workpiece({-0.5, 0}).x(), 0.064, 1e-15);
}

TEST(Scaling, PixelsThatAreNotSquareHaveTwoScales) {
  PixelContour ring;
  for (int i = 0; i < 360; ++i)
    ring.points_px.emplace_back(320 + 100 * std::cos(i * M_PI / 180), 240 + 50 * std::sin(i * M_PI / 180));
  const Scale scale = scale_for(ring, 640, 480, {.picture_width_m = 0.064, .picture_height_m = 0.096});
  const Vec2 size = geometry::bounding_box(to_workpiece(ring, scale).points_m).size();
  EXPECT_NEAR(size.x(), 0.02, 1e-15);
  EXPECT_NEAR(size.x() / size.y(), 1.0, 1e-12);
  EXPECT_LT((scale.to_picture(scale.to_workpiece({12, 34})) - Vec2(12, 34)).norm(), 1e-10);
}

TEST(Scaling, WithoutAWidthTheContourFillsSixtyPerCent) {
  PixelContour shape;
  shape.points_px = {{10, 10}, {210, 20}, {200, 110}, {20, 100}};
  const auto line = to_workpiece(shape, scale_for(shape, 640, 480, {.workspace_radius_m = 0.05}));
  EXPECT_NEAR(geometry::bounding_circle(line.points_m).radius_m, 0.03, 1e-12);
  EXPECT_LT(geometry::bounding_box(line.points_m).centre().norm(), 1e-12);
}

}  // namespace
}  // namespace telekerf::vision
