// SPDX-License-Identifier: Apache-2.0
// Cameras that show, change, disappear and come back, and the words that users choose them by.
#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <opencv2/core.hpp>
#include <opencv2/videoio.hpp>
#include <string>
#include <thread>
#include <vector>

#include "common/runtime/startup_error.h"
#include "slave/vision/cameras/cameras.h"
#include "slave/vision/vision_node.h"
#include "tests/unit/vision/scenes.h"

namespace telekerf::vision_process {
namespace {

namespace fs = std::filesystem;

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

TEST(Cameras, AVideoIsShownAtItsPaceAndWhoIsLateCatchesUpByASecondAtMost) {
  const Folder folder("pace");
  cv::VideoWriter writer(folder.file("a.avi"), cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), 20.0, {64, 48});
  if (!writer.isOpened()) GTEST_SKIP() << "OpenCV cannot write a video here";
  for (int i = 0; i < 36; ++i) writer.write(cv::Mat(48, 64, CV_8UC3, cv::Scalar::all(7 * i)));
  writer.release();
  const auto camera = open_image(folder.file("a.avi"));
  const auto seconds_for = [&](int frames) {
    const auto begun = std::chrono::steady_clock::now();
    for (int i = 0; i < frames; ++i) {
      const auto next = camera->next();
      EXPECT_TRUE(next && *next) << i;
    }
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
  };
  const double eleven_s = seconds_for(11);
  EXPECT_GE(eleven_s, 0.499) << "ten periods of 50 ms";
  EXPECT_LT(eleven_s, 5.0) << "and not a second each";
  std::this_thread::sleep_for(std::chrono::milliseconds(1200));
  // A second behind, the first is late at once and 20 more are; the last four wait for theirs.
  EXPECT_GE(seconds_for(25), 0.199);
}

TEST(Cameras, ADeviceThatIsNotThereIsRefused) {
  try {
    open_camera("251");
    FAIL() << "there is a camera 251";
  } catch (const StartupError& refusal) {
    EXPECT_NE(std::string(refusal.what()).find("camera 251: cannot be opened; --camera"), std::string::npos);
  }
}

TEST(Cameras, AreChosenByAWord) {
  const Folder folder("words");
  folder.put("heart.png", picture_of("heart"));
  for (const std::string& camera : {"file:" + folder.file("heart.png"), "folder:" + folder.path()}) {
    EXPECT_EQ(validate_camera(camera), "");
    const auto frame = open_camera(camera)->next();
    ASSERT_TRUE(frame && *frame) << camera;
    EXPECT_EQ((*frame)->source, "heart.png") << camera;
  }
  EXPECT_EQ(validate_camera("video:" + folder.file("none.avi")), "");
  EXPECT_THROW(open_camera("video:" + folder.file("none.avi")), StartupError);
  for (const char* camera : {"0", "v4l2:0", "255"}) EXPECT_EQ(validate_camera(camera), "") << camera;
  for (const char* camera : {"", "-1", "256", "v4l2", "v4l2:x", "v4l2:1x", "file", "file:", "microscope:3"})
    EXPECT_NE(validate_camera(camera), "") << camera;
  EXPECT_NE(validate_camera("microscope:3").find(camera_forms()), std::string::npos);
}

}  // namespace
}  // namespace telekerf::vision_process
