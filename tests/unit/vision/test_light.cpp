// SPDX-License-Identifier: Apache-2.0
// The same drawings in bad light: faint, uneven, half in a shadow, on grainy paper.
#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/core.hpp>

#include "common/vision/extraction/contour_extraction.h"
#include "common/vision/picture_contours.h"
#include "tests/unit/vision/truth.h"

namespace telekerf::vision {
namespace {

TEST(Extract, FaintDrawingsShadowsAndUnevenLight) {
  const drawing::Drawing circle = turned("circle", 1);
  const geometry::Polyline& truth = circle.lines_px.front();
  drawing::Appearance faint = hard_appearance(1);
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
    EXPECT_EQ(found->mode, ExtractionMode::kStroke);
    const Comparison c = compare(found->contours.front(), truth);
    EXPECT_LT(c.rms_px, 0.24);
    EXPECT_LT(c.max_px, 0.65);
    EXPECT_LT(c.missed_px, 0.65);
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
    ExtractionMode mode;
  };
  for (const Expected& c :
       {Expected{"figure-8", ExtractionMode::kStroke}, Expected{"spiral", ExtractionMode::kStroke},
        Expected{"letter-s", ExtractionMode::kStroke}, Expected{"circle", ExtractionMode::kStroke},
        Expected{"blob", ExtractionMode::kOutline}, Expected{"gear", ExtractionMode::kOutline}}) {
    const drawing::Drawing drawing = turned(c.shape, 1);
    for (const double angle : {0.4, 2.0, 3.9}) {
      const cv::Mat lit =
          drawing::render(drawing, {.paper = 205.0, .ink = 60.0, .blur_px = 1.5, .noise = 3.0});
      const auto found = extract(in_half_shadow(lit, angle, 0.3, 12.0));
      ASSERT_TRUE(found) << c.shape << ": " << found.error();
      EXPECT_EQ(found->mode, c.mode) << c.shape << " " << found->why;
      const Comparison off = compare(found->contours.front(), drawing.lines_px.front());
      EXPECT_LT(off.rms_px, 0.23) << c.shape << " " << angle;
      EXPECT_LT(off.max_px, 1.1) << c.shape << " " << angle;
      EXPECT_LT(off.missed_px, 1.45) << c.shape << " " << angle;
    }
  }
}

TEST(Extract, TheLitHalfOfAShapeUnderADeepShadowIsNoDrawing) {
  for (const char* shape : {"circle", "heart", "figure-8"}) {
    const drawing::Drawing drawing = turned(shape, 1);
    const cv::Mat lit = drawing::render(drawing, {.paper = 240.0, .ink = 40.0, .blur_px = 1.0, .noise = 2.0});
    for (const double darker : {0.5, 0.58, 0.65}) {
      for (const double angle : {0.4, 1.57, 3.9}) {
        for (const double edge_px : {2.0, 4.0}) {
          SCOPED_TRACE(testing::Message() << shape << ", " << 100.0 * darker << " % darker beyond an edge of "
                                          << edge_px << " px at " << angle << " rad");
          const auto found = extract(in_half_shadow(lit, angle, darker, edge_px));
          ASSERT_TRUE(found) << found.error();
          EXPECT_EQ(found->mode, ExtractionMode::kStroke) << found->why;
          ASSERT_EQ(found->contours.size(), 1u) << found->why;
          const Comparison off = compare(found->contours.front(), drawing.lines_px.front());
          EXPECT_LT(off.rms_px, 0.6);
          EXPECT_LT(off.missed_px, 4.5);  // at the shadow's edge
        }
      }
    }
  }
}

TEST(Extract, UnderAShadowAsSharpAsTheLinesTheyAreFoundOrThePictureIsRefused) {
  for (const char* shape : {"circle", "heart"}) {
    const drawing::Drawing drawing = turned(shape, 1);
    const cv::Mat lit = drawing::render(drawing, {.paper = 240.0, .ink = 40.0, .blur_px = 1.0, .noise = 2.0});
    for (const double darker : {0.5, 0.6, 0.7}) {
      const auto found = contours_in(in_half_shadow(lit, 3.9, darker, 0.7), {});
      if (!found) {
        EXPECT_NE(found.error().find("--at X,Y"), std::string::npos) << found.error();
      } else {
        EXPECT_LT(compare(found->contours.front(), drawing.lines_px.front()).missed_px, 4.5) << found->why;
      }
    }
  }
}

TEST(Extract, ThinLinesOnUnevenPaperAndFaintRegionsAreFound) {
  const auto smaller = [](const char* shape, double scale) {
    return drawing::transformed(*drawing::by_name(shape), 0.7, scale, {319.5, 239.5}, {40.0, -10.0});
  };
  const drawing::Appearance grainy{.paper = 200.0, .ink = 10.0, .noise = 2.0, .grain = 6.0, .seed = 3};
  for (const char* shape : {"circle", "heart", "letter-s", "figure-8", "spiral"}) {
    const drawing::Drawing drawing = smaller(shape, 0.3);
    const auto found = extract(drawing::render(drawing, grainy));
    ASSERT_TRUE(found) << shape << ": " << found.error();
    EXPECT_LT(compare(found->contours.front(), drawing.lines_px.front()).rms_px, 0.3) << shape;
  }
  for (const double noise : {2.0, 8.0}) {
    const drawing::Appearance faint{.paper = 200.0, .ink = 182.0, .noise = noise, .seed = 3};
    for (const char* shape : {"gear", "blob", "letter-e"}) {
      const drawing::Drawing drawing = smaller(shape, 1.0);
      const auto found = extract(drawing::render(drawing, faint));
      ASSERT_TRUE(found) << shape << ": " << found.error();
      EXPECT_EQ(found->mode, ExtractionMode::kOutline) << shape << ", noise " << noise;
      EXPECT_LT(compare(found->contours.front(), drawing.lines_px.front()).rms_px, 0.58)
          << shape << ", noise " << noise;
    }
  }
}

}  // namespace
}  // namespace telekerf::vision
