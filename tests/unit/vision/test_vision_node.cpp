// SPDX-License-Identifier: Apache-2.0
// The vision process without its bus: cameras that show, change, disappear and come back.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>

#include "common/runtime/startup_error.h"
#include "slave/vision/drawing.h"
#include "slave/vision/vision_node.h"

namespace telekerf::vision {
namespace {

namespace fs = std::filesystem;

cv::Mat picture_of(const std::string& name, std::uint64_t seed = 1, const Vec2& shift = Vec2::Zero()) {
  const auto drawing = drawing::transformed(*drawing::by_name(name), 0.0, 0.8, Vec2(319.5, 239.5), shift);
  return drawing::render(drawing, {.noise = 6.0, .seed = seed});
}

Camera::Look live(const cv::Mat& image) { return Frame{"camera 7", "", image, true}; }

ContourRequest at_true_size() {
  ContourRequest request;
  request.width_m = 0.03;
  request.anchor = "image";
  return request;
}

class Folder {
 public:
  explicit Folder(const std::string& name) : path_(fs::path(testing::TempDir()) / ("telekerf_" + name)) {
    fs::remove_all(path_);
    fs::create_directories(path_);
  }
  ~Folder() { fs::remove_all(path_); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;

  std::string file(const std::string& name) const { return (path_ / name).string(); }
  std::string path() const { return path_.string(); }
  void put(const std::string& name, const cv::Mat& image) const {
    ASSERT_TRUE(cv::imwrite(file("new.part.png"), image));
    fs::rename(file("new.part.png"), file(name));
  }

 private:
  fs::path path_;
};

TEST(VisionNode, SaysWhatOfADrawingItDoesNotFollow) {
  const Folder folder("drawing");
  std::ofstream(folder.file("part.svg")) << "<svg width='20mm' height='20mm' viewBox='0 0 20 20'><circle "
                                            "cx='10' cy='10' r='5'/><text>A</text></svg>";
  VisionNode node({});
  const auto outcome = node.step(Frame{"part.svg", folder.file("part.svg"), {}, false});
  ASSERT_TRUE(outcome.publish) << outcome.remark;
  EXPECT_EQ(outcome.remark, "part.svg: not followed: 1 text");
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
  EXPECT_GT(record.at("contrast"), 100.0);  // ink 40 on paper 228, a thin pen, blurred
  EXPECT_LT(record.at("contrast"), 190.0);
  EXPECT_GT(record.at("width_mm"), 10.0);
  EXPECT_LT(record.at("deviation_mm"), 0.01);
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
  const Camera::Look gone = tl::unexpected(std::string("camera 7: gives no picture"));
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

TEST(Cameras, AFileIsANewFrameWhenItIsWrittenAnew) {
  const Folder folder("file");
  EXPECT_THROW(open_image(folder.file("heart.png")), StartupError);
  folder.put("heart.png", picture_of("heart"));
  const auto camera = open_image(folder.file("heart.png"));
  VisionNode node(at_true_size());
  EXPECT_TRUE(node.step(camera->next()).publish);
  EXPECT_FALSE(camera->next()->has_value());
  fs::remove(folder.file("heart.png"));
  EXPECT_FALSE(camera->next());
  folder.put("heart.png", picture_of("cam"));
  fs::last_write_time(folder.file("heart.png"), fs::file_time_type::clock::now() + std::chrono::seconds(2));
  const auto changed = node.step(camera->next());
  ASSERT_TRUE(changed.publish);
  EXPECT_EQ(changed.publish->source, "heart.png");
}

TEST(Cameras, AFolderIsShownInOrderAndWatched) {
  const Folder folder("folder");
  EXPECT_THROW(open_image(folder.path()), StartupError);
  folder.put("b.png", picture_of("cam"));
  folder.put("a.png", picture_of("heart"));
  const auto camera = open_image(folder.path());
  std::vector<std::string> seen;
  const auto look = [&] {
    for (int i = 0; i < 4; ++i) {
      const auto next = camera->next();
      ASSERT_TRUE(next);
      if (*next) seen.push_back((*next)->source);
    }
  };
  look();
  EXPECT_EQ(seen, (std::vector<std::string>{"a.png", "b.png"}));
  folder.put("aa.png", picture_of("gear"));
  look();
  EXPECT_EQ(seen.back(), "aa.png");
  EXPECT_EQ(seen.size(), 3u);
}

TEST(Cameras, AVideoThatDisappearsAndComesBackIsFollowed) {
  const Folder folder("video");
  const auto record = [&](const std::string& name, const std::string& shape) {
    cv::VideoWriter writer(folder.file(name), cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), 200.0, {640, 480});
    for (int i = 0; i < 8; ++i) {
      cv::Mat colour;
      cv::Mat grey = picture_of(shape, 1 + i);
      cv::merge(std::vector<cv::Mat>{grey, grey, grey}, colour);
      writer.write(colour);
    }
    return writer.isOpened();
  };
  if (!record("a.avi", "heart")) GTEST_SKIP() << "OpenCV cannot write a video here";
  const auto camera = open_image(folder.file("a.avi"));
  VisionNode node(at_true_size());
  int published = 0;
  const auto watch = [&] {
    for (int i = 0; i < 12; ++i) published += node.step(camera->next()).publish.has_value();
  };
  watch();
  EXPECT_EQ(published, 1);
  EXPECT_EQ(node.frames(), 8);
  EXPECT_NE(node.state(), VisionNode::State::kGone);  // a video that has ended is not gone
  fs::remove(folder.file("a.avi"));
  watch();
  EXPECT_EQ(node.state(), VisionNode::State::kGone);
  EXPECT_EQ(node.losses(), 1);
  ASSERT_TRUE(record("a.avi", "cam"));
  watch();
  EXPECT_EQ(published, 2);
  EXPECT_EQ(node.state(), VisionNode::State::kSeeing);
}

TEST(Cameras, ADeviceThatIsNotThereIsRefused) {
  try {
    open_device(251);
    FAIL() << "there is a camera 251";
  } catch (const StartupError& refusal) {
    EXPECT_NE(std::string(refusal.what()).find("camera 251: cannot be opened; --camera"), std::string::npos);
  }
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
}  // namespace telekerf::vision
