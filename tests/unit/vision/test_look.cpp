// SPDX-License-Identifier: Apache-2.0
// What somebody points at while vision runs, and the small picture that is shown meanwhile.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <map>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "common/geometry/polyline.h"
#include "slave/vision/vision_node.h"
#include "tests/unit/vision/scenes.h"

namespace telekerf::vision_process {
namespace {

/// Three discs, 20 um a pixel: 200 px at (200, 200), 120 px at (480, 160), 60 px at (450, 380), the picture's
/// centre on the origin.
cv::Mat discs() {
  cv::Mat picture(480, 640, CV_8UC1, cv::Scalar(230));
  for (const auto& [x, y, radius] : {std::tuple{200, 200, 100}, {480, 160, 60}, {450, 380, 30}})
    cv::circle(picture, {x, y}, radius, cv::Scalar(40), cv::FILLED, cv::LINE_AA);
  return picture;
}
ContourRequest at_20_um() {
  ContourRequest request;
  request.width_m = 640 * 20e-6;
  request.anchor = vision::AnchorMode::kImageCentre;
  return request;
}
std::string at(double x_px, double y_px) {
  return "at " + std::to_string(20e-6 * (x_px - 319.5)) + "," + std::to_string(20e-6 * (239.5 - y_px));
}
double diameter_px(const ContourMessage& contour) {
  return geometry::bounding_box(contour.points_m).size().x() / 20e-6;
}

class Looking : public ::testing::Test {
 protected:
  void SetUp() override {
    cv::imwrite(folder.file("discs.png"), discs());
    const auto outcome = node.step(Frame{"discs.png", folder.file("discs.png")});
    ASSERT_TRUE(outcome.publish) << outcome.remark;
    ASSERT_NEAR(diameter_px(*outcome.publish), 201.0, 1.0);
  }
  /// Of what is published then; 0: refused.
  double looked(const std::string& words) {
    const auto outcome = node.look(words);
    refusal = outcome ? "" : outcome.error();
    return outcome && outcome->publish ? diameter_px(*outcome->publish) : 0.0;
  }
  Folder folder{"look"};
  VisionNode node{at_20_um()};
  std::string refusal;
};

TEST_F(Looking, WhatIsPointedAtIsCut) {
  EXPECT_NEAR(looked(at(480, 160)), 121.0, 1.0);
  EXPECT_NEAR(looked(at(450, 380)), 61.0, 1.0) << "the numbers are those of --select again";
  EXPECT_NEAR(looked(at(480, 160 + 58)), 121.0, 1.0) << "beside its line";
  EXPECT_NEAR(looked(at(200, 250)), 201.0, 1.0);
  EXPECT_NEAR(looked("anew"), 201.0, 1.0);
}

TEST_F(Looking, WhereTheContourBeginsCanBeSaid) {
  const auto outcome = node.look("start " + at(300, 200).substr(3));
  ASSERT_TRUE(outcome) << outcome.error();
  ASSERT_TRUE(outcome->publish);
  EXPECT_LT((outcome->publish->points_m.front() - 20e-6 * Vec2(300 - 319.5, 239.5 - 200)).norm(), 3 * 20e-6);
  const auto opposite = node.look("start " + at(100, 200).substr(3));
  ASSERT_TRUE(opposite && opposite->publish);
  EXPECT_LT((opposite->publish->points_m.front() - 20e-6 * Vec2(100 - 319.5, 239.5 - 200)).norm(), 3 * 20e-6);
}

TEST_F(Looking, AnotherModeFindsOtherLines) {
  ASSERT_TRUE(node.look("mode outline"));
  EXPECT_EQ(node.look("mode sideways").error(),
            "no mode of the name 'sideways' (telekerf-vision --help has the names at --mode)");
}

TEST_F(Looking, ALevelMovesTheBordersThroughTheirBlur) {
  // A disc out of focus: at the share q of its contrast its border lies sigma probit(q) further in.
  cv::Mat blurred(480, 640, CV_8UC1, cv::Scalar(230));
  cv::circle(blurred, {320, 240}, 100, cv::Scalar(40), cv::FILLED, cv::LINE_AA);
  cv::GaussianBlur(blurred, blurred, {}, 4.0);
  cv::imwrite(folder.file("blurred.png"), blurred);
  ASSERT_TRUE(node.step(Frame{"blurred.png", folder.file("blurred.png")}).publish);
  const double whole = looked("mode outline");
  ASSERT_NEAR(whole, 201.0, 1.5);
  const double sigma = std::hypot(4.0, 1.0);  // and of the filter
  for (const auto& [share, probit] : {std::pair{0.1, -1.2816}, {0.3, -0.5244}, {0.5, 0.0}, {0.8, 0.8416}}) {
    const double expected = whole - 2.0 * sigma * probit;
    EXPECT_NEAR(looked("level " + std::to_string(share)), expected, 1.0) << share;
  }
  EXPECT_NEAR(looked("mode auto"), whole - 2.0 * sigma * 0.8416, 1.0) << "it stays in another mode";
  EXPECT_NEAR(looked("level"), whole, 0.5) << "found by itself again";
}

TEST_F(Looking, ALevelSaysWhatOfAFaintDrawingCounts) {
  cv::Mat tones(480, 640, CV_8UC1, cv::Scalar(230));
  cv::circle(tones, {200, 240}, 100, cv::Scalar(40), cv::FILLED, cv::LINE_AA);
  cv::circle(tones, {470, 240}, 120, cv::Scalar(170), cv::FILLED, cv::LINE_AA);  // fainter and larger
  cv::imwrite(folder.file("tones.png"), tones);
  ASSERT_TRUE(node.step(Frame{"tones.png", folder.file("tones.png")}).publish);
  EXPECT_NEAR(looked("level 0.2"), 241.0, 2.0);
  EXPECT_NEAR(looked("level 0.7"), 201.0, 2.0);
  const auto values = node.record().values;
  EXPECT_EQ((std::map<std::string, double>(values.begin(), values.end()).at("level")), 0.7) << "and all are told";
}

TEST_F(Looking, WhatIsNoLookIsRefusedAndChangesNothing) {
  ASSERT_NEAR(looked(at(480, 160)), 121.0, 1.0);
  for (const char* const words :
       {"", "at", "at 1", "at 1,", "at 1,2,3", "at x,y", "at nan,0", "at inf,0", "anew 1", "start", "look",
        "at  0,0", "mode", "level 0", "level 1.5", "level nan", "level x", "level  0.5"}) {
    EXPECT_EQ(looked(words), 0.0) << words;
    EXPECT_FALSE(refusal.empty()) << words;
  }
  EXPECT_EQ(looked("level 0.99"), 0.0);
  EXPECT_EQ(refusal, "level = 0.99: must lie within [0.02, 0.98]");
  EXPECT_EQ(looked("at 0.5,0.5"), 0.0) << "beyond the picture";
  EXPECT_NE(refusal.find("lies beyond the picture"), std::string::npos) << refusal;
  const auto again = node.look("mode auto");
  ASSERT_TRUE(again);
}

TEST_F(Looking, WhatIsDrawnOverThePictureIsAContour) {
  // A circle of 4 mm with a hand's tremor, said in pieces.
  ASSERT_TRUE(node.look("draw"));
  std::string words = "draw";
  for (int n = 0; n < 400; ++n) {
    const double angle = 2.0 * M_PI * n / 400, radius_m = 4e-3 + 5e-5 * std::sin(97.0 * angle);
    words +=
        " " + std::to_string(radius_m * std::cos(angle)) + "," + std::to_string(radius_m * std::sin(angle));
    if (n % 10 == 9) {
      const auto piece = node.look(words);
      ASSERT_TRUE(piece) << piece.error();
      EXPECT_FALSE(piece->publish);
      words = "draw";
    }
  }
  const auto outcome = node.look("draw closed");
  ASSERT_TRUE(outcome && outcome->publish);
  EXPECT_TRUE(outcome->publish->closed);
  EXPECT_EQ(outcome->publish->mode, "drawn");
  for (const Vec2& p : outcome->publish->points_m) EXPECT_NEAR(p.norm(), 4e-3, 5e-6) << "the tremor is gone";
  EXPECT_NEAR(geometry::length_m({outcome->publish->points_m, true}), 2.0 * M_PI * 4e-3, 1e-5);
  EXPECT_FALSE(node.confirms()) << "no picture shows it";
  EXPECT_EQ(node.look("draw open").error(), "what was drawn is 0.00 mm long; a contour takes at least 1 mm");
  ASSERT_TRUE(node.look("draw 0,0 0.001,0 0.05,0"));
  EXPECT_NE(node.look("draw open").error().find("reaches 50.0 mm"), std::string::npos);
  ASSERT_TRUE(node.look("draw 0,0 0.001,0 0.005,0"));
  const auto line = node.look("draw open");
  ASSERT_TRUE(line && line->publish);
  EXPECT_FALSE(line->publish->closed);
  EXPECT_NEAR(line->publish->points_m.back().x(), 5e-3, 1e-6);
  EXPECT_NEAR(looked("anew"), 201.0, 1.0);
  for (const char* const words_of_none : {"draw 1", "draw a,b", "draw 0,0  1,1", "draw nan,0", "draw shut"})
    EXPECT_FALSE(node.look(words_of_none)) << words_of_none;
}

TEST(Look, ADrawnContourStandsWhileALiveCameraGoesOn) {
  VisionNode node(at_20_um());
  const auto show = [&] { return node.step(Frame{"camera 7", "", discs(), true}); };
  for (int n = 0; n < 5; ++n) (void)show();
  ASSERT_TRUE(node.look("draw 0,0 0.003,0 0.003,0.003"));
  ASSERT_TRUE(node.look("draw open"));
  for (int n = 0; n < 10; ++n) EXPECT_FALSE(show().publish);
  EXPECT_FALSE(node.confirms());
  EXPECT_TRUE(node.preview());
}

TEST(Look, BeforeThereIsAContourThereIsNothingToPointAt) {
  VisionNode node({});
  EXPECT_EQ(node.look("anew").error(), "there is no contour yet from which to go on");
  EXPECT_FALSE(node.preview());
}

TEST(Look, LinesOfADrawingAreChosenAndItHasNoPixels) {
  const Folder folder("look_drawing");
  std::ofstream(folder.file("part.svg")) << "<svg width='40mm' height='20mm' viewBox='0 0 40 20' fill='none' "
                                            "stroke='#000'><circle cx='10' cy='10' "
                                            "r='8'/><circle cx='30' cy='10' r='4'/></svg>";
  ContourRequest request;
  request.anchor = vision::AnchorMode::kImageCentre;
  request.workspace_radius_m = 0.1;
  VisionNode node(request);
  const auto first = node.step(Frame{"part.svg", folder.file("part.svg")});
  ASSERT_TRUE(first.publish) << first.remark;
  EXPECT_FALSE(node.preview());
  const auto small = node.look("at 0.010,0.0");
  ASSERT_TRUE(small) << small.error();
  EXPECT_NEAR(geometry::bounding_box(small->publish->points_m).size().x(), 8e-3, 1e-5);
  EXPECT_EQ(node.look("at 0.018,0.009").error(), "no line of the drawing is there");
  EXPECT_EQ(node.look("mode stroke").error(), "a drawing says its lines itself; it has no mode");
}

TEST_F(Looking, ThePictureLiesWhereItsContoursLie) {
  const auto preview = node.preview();
  ASSERT_TRUE(preview);
  EXPECT_NE(preview->contour_id, 0u);
  EXPECT_NEAR(preview->left_m, -320 * 20e-6, 1e-9);
  EXPECT_NEAR(preview->top_m, 240 * 20e-6, 1e-9);
  EXPECT_NEAR(preview->width_m, 640 * 20e-6, 1e-9);
  EXPECT_NEAR(preview->height_m, 480 * 20e-6, 1e-9);
  const cv::Mat shown = cv::imdecode(preview->jpeg, cv::IMREAD_GRAYSCALE);
  ASSERT_EQ(shown.size(), cv::Size(640, 480));
  EXPECT_LT(cv::mean(cv::abs(shown - discs()))[0], 2.0);
}

TEST(Preview, OfALargePictureOfAnyKindIsSmallAndInItsPlace) {
  vision::Scale scale;
  scale.metres_per_pixel = 1e-5;
  scale.anchor_px = Vec2(100.0, 50.0);
  for (const int type : {CV_8UC1, CV_8UC3, CV_8UC4, CV_16UC1}) {
    const auto preview = preview_of(cv::Mat(1500, 3000, type, cv::Scalar::all(120)), scale);
    ASSERT_TRUE(preview) << type;
    EXPECT_EQ(cv::imdecode(preview->jpeg, cv::IMREAD_COLOR).size(), cv::Size(800, 400)) << type;
    EXPECT_NEAR(preview->left_m, -100.5e-5, 1e-12);
    EXPECT_NEAR(preview->top_m, 50.5e-5, 1e-12);
    EXPECT_NEAR(preview->width_m, 3000e-5, 1e-12);
    EXPECT_NEAR(preview->height_m, 1500e-5, 1e-12);
  }
  EXPECT_FALSE(preview_of(cv::Mat(), scale));
}

}  // namespace
}  // namespace telekerf::vision_process
