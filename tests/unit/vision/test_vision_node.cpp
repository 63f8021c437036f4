// SPDX-License-Identifier: Apache-2.0
// The vision process without its bus: what it publishes of what cameras show, and when.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <map>
#include <opencv2/imgproc.hpp>

#include "slave/vision/vision_node.h"
#include "tests/unit/vision/scenes.h"

namespace telekerf::vision_process {
namespace {

Camera::Result live(const cv::Mat& image) { return Frame{"camera 7", "", image, true}; }

TEST(VisionNode, SaysWhatOfADrawingItDoesNotFollow) {
  const Folder folder("drawing");
  std::ofstream(folder.file("part.svg")) << "<svg width='20mm' height='20mm' viewBox='0 0 20 20'><circle "
                                            "cx='10' cy='10' r='5'/><text>A</text></svg>";
  VisionNode node({});
  const auto outcome = node.step(Frame{"part.svg", folder.file("part.svg"), {}, false});
  ASSERT_TRUE(outcome.publish) << outcome.remark;
  EXPECT_EQ(outcome.remark, "part.svg: not followed: 1 text");
}

TEST(VisionNode, SaysWhatOfAPictureIsNotCut) {
  cv::Mat picture(400, 400, CV_8U, cv::Scalar(230));
  cv::circle(picture, {200, 200}, 120, cv::Scalar(40), cv::FILLED, cv::LINE_AA);
  VisionNode node({});
  EXPECT_EQ(node.step(Frame{"a.png", "", picture, false}).remark, "");
  cv::circle(picture, {40, 40}, 3, cv::Scalar(40), cv::FILLED, cv::LINE_AA);
  cv::circle(picture, {0, 200}, 20, cv::Scalar(40), cv::FILLED, cv::LINE_AA);
  VisionNode other({});
  const auto outcome = other.step(Frame{"a.png", "", picture, false});
  ASSERT_TRUE(outcome.publish) << outcome.remark;
  EXPECT_TRUE(outcome.publish->further.empty());
  EXPECT_EQ(outcome.remark.find("a.png: 1 shape that touches the picture's border left out"), 0u)
      << outcome.remark;
  EXPECT_NE(outcome.remark.find("; 1 small contour of at most"), std::string::npos) << outcome.remark;
  EXPECT_NE(outcome.remark.find("--smallest-mm"), std::string::npos) << outcome.remark;
}

TEST(VisionNode, TheLowerLeftCornerIsThatOfAllLinesOfAPicture) {
  cv::Mat picture(400, 600, CV_8U, cv::Scalar(230));
  cv::circle(picture, {400, 150}, 100, cv::Scalar(40), cv::FILLED, cv::LINE_AA);
  cv::circle(picture, {80, 330}, 40, cv::Scalar(40), cv::FILLED, cv::LINE_AA);
  for (const bool all : {false, true}) {
    ContourRequest request;
    request.anchor = vision::AnchorMode::kLowerLeft;
    request.width_m = 0.06;
    request.workspace_radius_m = 0.1;
    request.fit_all = all;
    VisionNode node(request);
    const auto outcome = node.step(Frame{"two.png", "", picture, false});
    ASSERT_TRUE(outcome.publish) << outcome.remark;
    ASSERT_EQ(outcome.publish->further.size(), 1u);
    std::vector<Vec2> points = outcome.publish->points_m;
    EXPECT_GT(geometry::bounding_box(points).min.x(), 0.02);
    const auto& other = outcome.publish->further[0].points_m;
    points.insert(points.end(), other.begin(), other.end());
    EXPECT_LT(geometry::bounding_box(points).min.norm(), 1e-12) << all;
  }
}

TEST(VisionNode, SaysHowManyLinesOfADrawingNoMessageHolds) {
  const Folder folder("many");
  const auto remark_on = [&](int holes) {
    std::ofstream out(folder.file("plate.svg"));
    out << "<svg width='30mm' height='30mm' viewBox='0 0 30 30'><rect width='28' height='28'/>";
    for (int i = 0; i < holes; ++i)
      out << "<rect x='" << 1 + 0.5 * (i % 50) << "' y='" << 1 + 0.5 * (i / 50)
          << "' width='.2' height='.2'/>";
    out << "</svg>";
    out.close();
    ContourRequest request;
    request.workspace_radius_m = 0.03;
    VisionNode node(request);
    const auto outcome = node.step(Frame{"plate.svg", folder.file("plate.svg"), {}, false});
    EXPECT_EQ(outcome.publish->further.size(), 1000u);
    return outcome.remark;
  };
  EXPECT_EQ(remark_on(1000), "");
  EXPECT_EQ(remark_on(1003),
            "plate.svg: of 1004 contours the smallest 3 are left out: a message holds 1000 further lines and "
            "100000 points of them (--layers or --colours of a drawing, --smallest-mm of a picture choose what "
            "is cut)");
}

TEST(VisionNode, ALiveContourIsPublishedOnceWhenFramesAgree) {
  VisionNode node(at_true_size());
  int published = 0;
  for (int i = 0; i < 12; ++i) {
    const auto outcome = node.step(live(picture_of("heart", 10 + i)));
    published += outcome.publish.has_value();
    EXPECT_EQ(published, i + 1 < VisionNode::kAgreeing ? 0 : 1);
  }
  EXPECT_EQ(published, 1);
  EXPECT_EQ(node.frames(), 12);
  const auto values = node.record().values;
  const std::map<std::string, double> record(values.begin(), values.end());
  EXPECT_EQ(record.at("frames"), 12.0);
  EXPECT_NEAR(record.at("picture_noise"), 6.0, 1.0);
  EXPECT_EQ(record.at("level"), 0.0) << "found";
  EXPECT_GT(record.at("contrast"), 100.0);  // ink 40 on paper 228, a thin pen, blurred
  EXPECT_LT(record.at("contrast"), 190.0);
  EXPECT_GT(record.at("width_mm"), 10.0);
  EXPECT_LT(record.at("deviation_mm"), 0.01);
}

TEST(VisionNode, ACameraThatKnowsItsScaleIsBelievedAndAnotherScaleIsAnotherContour) {
  ContourRequest request = at_true_size();
  request.workspace_radius_m = 1.0;
  VisionNode node(request);
  std::vector<ContourMessage> published;
  const auto show = [&](double metres_per_pixel) {
    for (int i = 0; i < 6; ++i) {
      Frame frame{"microscope", "", picture_of("heart", 10 + i), true, metres_per_pixel};
      const auto outcome = node.step(frame);
      if (outcome.publish) published.push_back(*outcome.publish);
    }
  };
  show(20e-6);
  ASSERT_EQ(published.size(), 1U);
  EXPECT_EQ(published[0].metres_per_pixel, 20e-6);
  show(20.1e-6);  // half a per cent: not worth an interruption
  EXPECT_EQ(published.size(), 1U);
  show(20.5e-6);
  ASSERT_EQ(published.size(), 2U);
  EXPECT_EQ(published[1].metres_per_pixel, 20.5e-6);
}

TEST(VisionNode, ItsRecordHasTheSizesOfWhatIsPublished) {
  const Folder folder("sizes");
  std::ofstream(folder.file("part.svg")) << "<svg width='20mm' height='20mm' viewBox='0 0 20 20'><rect x='4' "
                                            "y='7' width='12' height='6'/></svg>";
  VisionNode node({});
  EXPECT_EQ(node.record().values.size(), 7u) << "nothing is published yet";
  EXPECT_EQ(node.record().role, "vision");
  EXPECT_EQ(node.record().tick, 0u);
  const auto outcome = node.step(Frame{"part.svg", folder.file("part.svg"), {}, false});
  ASSERT_TRUE(outcome.publish) << outcome.remark;
  const auto values = node.record().values;
  const std::map<std::string, double> record(values.begin(), values.end());
  EXPECT_EQ(record.at("contour_id"), static_cast<double>(outcome.publish->id));
  EXPECT_EQ(record.at("published"), 1.0);
  EXPECT_EQ(record.at("camera_gone"), 0.0);
  EXPECT_NEAR(record.at("length_mm"), 36.0, 0.01);
  EXPECT_NEAR(record.at("width_mm"), 12.0, 1e-6);
  EXPECT_NEAR(record.at("height_mm"), 6.0, 1e-6);
  EXPECT_NEAR(record.at("deviation_mm"), 1e3 * outcome.publish->deviation_m, 1e-12);
}

TEST(SameContour, ItsToleranceIsTheLastDistanceWithin) {
  const double tolerance_m = std::ldexp(1.0, -10);
  const auto line = [](double y_m, double length_m, bool closed = false) {
    ContourMessage out;
    out.points_m = {{0.0, y_m}, {0.5 * length_m, y_m}, {length_m, y_m}};
    out.closed = closed;
    return out;
  };
  const auto base = line(0.0, 1.0);
  EXPECT_TRUE(same_contour(base, line(tolerance_m, 1.0), tolerance_m));
  EXPECT_FALSE(same_contour(base, line(std::nextafter(tolerance_m, 1.0), 1.0), tolerance_m));
  EXPECT_FALSE(same_contour(base, line(0.0, 1.0, true), tolerance_m));
  // Each is looked for in the other: a part of a line is not the line.
  EXPECT_TRUE(same_contour(base, line(0.0, 1.0 + tolerance_m), tolerance_m));
  EXPECT_FALSE(same_contour(base, line(0.0, 1.0 + 1.5 * tolerance_m), tolerance_m));
  EXPECT_FALSE(same_contour(line(0.0, 1.0 + 1.5 * tolerance_m), base, tolerance_m));
}

TEST(VisionNode, WhatPassesIsIgnoredAndWhatStaysIsPublished) {
  VisionNode node(at_true_size());
  const auto show = [&](const std::string& name, int frames, const Vec2& shift = Vec2::Zero()) {
    std::vector<ContourMessage> out;
    for (int i = 0; i < frames; ++i) {
      if (const auto o = node.step(live(picture_of(name, 1 + i, shift))); o.publish)
        out.push_back(*o.publish);
    }
    return out;
  };
  const auto first = show("heart", 4);
  ASSERT_EQ(first.size(), 1u);
  EXPECT_EQ(show("cam", VisionNode::kAgreeing - 1).size(), 0u);
  EXPECT_EQ(show("heart", 4).size(), 0u);
  EXPECT_EQ(show("heart", 6, {0.7, 0.5}).size(), 0u);  // less than what counts as a change
  const auto moved = show("heart", 6, {12.0, 5.0});
  ASSERT_EQ(moved.size(), 1u);
  EXPECT_NE(moved[0].id, first[0].id);
  const double pixel = 0.03 / 640;
  const Vec2 by =
      geometry::bounding_box(moved[0].points_m).centre() - geometry::bounding_box(first[0].points_m).centre();
  EXPECT_NEAR(by.x(), 12.0 * pixel, 0.5 * pixel);
  EXPECT_NEAR(by.y(), -5.0 * pixel, 0.5 * pixel);
}

TEST(VisionNode, AnInterruptionBeginsTheCountOfAgreeingFramesAnew) {
  const auto shown = [](VisionNode& node, int frames) {
    int published = 0;
    for (int i = 0; i < frames; ++i)
      published += node.step(live(picture_of("heart", 1 + i))).publish.has_value();
    return published;
  };
  for (const bool gone : {true, false}) {
    VisionNode node(at_true_size());
    EXPECT_EQ(shown(node, VisionNode::kAgreeing - 1), 0);
    if (gone) (void)node.step(tl::unexpected(std::string("camera 7: gives no picture")));
    if (!gone) (void)node.step(live(cv::Mat(480, 640, CV_8U, cv::Scalar(90))));
    EXPECT_EQ(shown(node, VisionNode::kAgreeing - 1), 0) << gone;
    EXPECT_EQ(shown(node, 1), 1) << gone;
    // Nor does what was published count for what comes next.
    for (int i = 0; i < VisionNode::kAgreeing - 1; ++i)
      EXPECT_FALSE(node.step(live(picture_of("cam", 1 + i))).publish);
    EXPECT_TRUE(node.step(live(picture_of("cam", 9))).publish);
  }
}

TEST(VisionNode, AChangeInAnotherLineIsAnotherContour) {
  VisionNode node(at_true_size());
  const auto with_hole = [&](double radius) {
    cv::Mat image(480, 640, CV_8UC1, cv::Scalar(228));
    cv::rectangle(image, {120, 80, 400, 320}, cv::Scalar(40), cv::FILLED, cv::LINE_AA);
    cv::circle(image, {320, 240}, cvRound(radius), cv::Scalar(228), cv::FILLED, cv::LINE_AA);
    std::vector<ContourMessage> out;
    for (int i = 0; i < 6; ++i) {
      if (const auto o = node.step(live(image)); o.publish) out.push_back(*o.publish);
    }
    return out;
  };
  const auto first = with_hole(60);
  ASSERT_EQ(first.size(), 1u);
  ASSERT_EQ(first[0].further.size(), 1u);
  EXPECT_EQ(with_hole(60).size(), 0u);
  EXPECT_EQ(with_hole(61).size(), 0u);  // less than what counts as a change
  const auto wider = with_hole(90);
  ASSERT_EQ(wider.size(), 1u);
  ASSERT_EQ(wider[0].points_m.size(), first[0].points_m.size());
  for (std::size_t i = 0; i < first[0].points_m.size(); ++i) {
    EXPECT_LT((wider[0].points_m[i] - first[0].points_m[i]).norm(), 0.1e-6) << "the outer line stays";
  }
  EXPECT_NE(wider[0].id, first[0].id);
}

TEST(VisionNode, SaysOnceThatTheCameraIsGoneAndKeepsTheContour) {
  VisionNode node(at_true_size());
  for (int i = 0; i < 4; ++i) (void)node.step(live(picture_of("heart")));
  const Camera::Result gone = tl::unexpected(std::string("camera 7: gives no picture"));
  const auto loss = node.step(gone);
  EXPECT_NE(loss.remark.find("camera 7: gives no picture; the published contour stands"), std::string::npos);
  for (int i = 0; i < 5; ++i) EXPECT_EQ(node.step(gone).remark, "");
  EXPECT_EQ(node.state(), VisionNode::State::kGone);
  EXPECT_EQ(node.losses(), 1);
  const auto back = node.step(live(picture_of("heart", 5)));
  EXPECT_NE(back.remark, "");
  EXPECT_FALSE(back.publish);  // nothing has changed
  EXPECT_EQ(node.state(), VisionNode::State::kSeeing);
}

TEST(VisionNode, APictureWithoutAContourKeepsTheOldOne) {
  VisionNode node(at_true_size());
  for (int i = 0; i < 4; ++i) (void)node.step(live(picture_of("heart")));
  const auto covered = node.step(live(cv::Mat(480, 640, CV_8U, cv::Scalar(90))));
  EXPECT_FALSE(covered.publish);
  EXPECT_NE(covered.remark.find("uniform"), std::string::npos);
  EXPECT_EQ(node.state(), VisionNode::State::kNoContour);
  EXPECT_EQ(node.published(), 1);
}

TEST(VisionNode, AContourBeyondTheWorkspaceIsNotPublished) {
  ContourRequest request = at_true_size();
  request.width_m = 0.3;
  VisionNode node(request);
  const auto outcome = node.step(Frame{"wide.png", "", picture_of("heart"), false});
  EXPECT_FALSE(outcome.publish);
  EXPECT_NE(outcome.remark.find("--width-mm"), std::string::npos);
}

TEST(ContourSource, WhatIsFittedFitsTheOperatorsHandToo) {
  ContourRequest request;
  request.image = TELEKERF_PICTURES "/heart.png";
  request.workspace_radius_m = 0.03;
  const auto reach_m = [&] {
    double farthest_m = 0.0;
    for (const Vec2& point : find_contour(request).points_m) farthest_m = std::max(farthest_m, point.norm());
    return farthest_m;
  };
  const double alone_m = reach_m();
  EXPECT_NEAR(alone_m, 1.093 * 0.6 * 0.03, 1e-5) << "its bounding circle takes 60 %";
  request.hand_radius_m = 0.5 * 0.0425;
  EXPECT_EQ(reach_m(), alone_m) << "a hand that reaches further changes nothing";
  request.hand_radius_m = 0.1 * 0.0425;
  EXPECT_NEAR(reach_m() / alone_m, 0.85 * 0.00425 / (0.6 * 0.03), 1e-6) << "85 % of what the hand reaches";
  request.width_m = 0.02;
  const double asked_m = reach_m();
  request.hand_radius_m.reset();
  EXPECT_EQ(reach_m(), asked_m) << "a size that is asked for is taken";
}

TEST(Contour, TheIdIsTheContoursOwn) {
  ContourRequest request;
  request.image = TELEKERF_PICTURES "/heart.png";
  const ContourMessage heart = find_contour(request);
  EXPECT_EQ(find_contour(request).id, heart.id);
  EXPECT_NE(heart.id, 0u);
  request.image = TELEKERF_PICTURES "/cam.png";
  EXPECT_NE(find_contour(request).id, heart.id);
}

}  // namespace
}  // namespace telekerf::vision_process
