// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <opencv2/imgcodecs.hpp>
#include <optional>
#include <utility>

#include "slave/vision/cameras/imaging_camera.h"
#include "slave/vision/imaging/imaging_file.h"
#include "slave/vision/imaging/targets.h"
#include "slave/vision/vision_node.h"

namespace telekerf::vision_process {
namespace {

using namespace imaging;

cv::Mat relief() {
  cv::Mat picture;
  draw_target(Target::kRelief, 900, 2.0, 3).convertTo(picture, CV_8U);
  return picture;
}

/// The simulated unit, stepped by hand: a picture is fifty control steps.
class ImagingCameraTest : public ::testing::Test {
 protected:
  void open(const cv::Mat& picture, const ImagingCameraSettings& settings) {
    const ImagingFile file = default_imaging();
    runner_ = std::make_shared<AxesRunner>(open_axes("simulated", {.model = file.axes, .period_s = 1e-3}),
                                           file.axes);
    camera_.emplace(settings, runner_, simulated_source(file.model, picture, 0.03), [this] {
      for (int i = 0; i < 50; ++i) runner_->step();
    });
  }
  static ImagingCameraSettings settings(FocusLaw law = FocusLaw::kSearch, double zoom = 0.2) {
    return {.model = default_imaging().model, .law = law, .magnification = zoom, .region = 0.3};
  }
  /// The next picture that may be used; none within `most` frames.
  std::optional<Frame> usable(int most = 400) {
    for (int i = 0; i < most; ++i) {
      auto seen = camera_->next();
      EXPECT_TRUE(seen) << seen.error();
      if (seen && *seen) return **seen;
    }
    return std::nullopt;
  }
  double value(const std::string& name) {
    for (const auto& [key, number] : camera_->values()) {
      if (key == name) return number;
    }
    ADD_FAILURE() << name;
    return 0.0;
  }

  std::shared_ptr<AxesRunner> runner_;
  std::optional<ImagingCamera> camera_;
};

TEST_F(ImagingCameraTest, GivesPicturesInFocusOnlyAndSaysTheirScale) {
  open(relief(), settings());
  const auto frame = usable();
  ASSERT_TRUE(frame);
  EXPECT_EQ(camera_->remark(), "in focus");
  EXPECT_EQ(camera_->remark(), "");
  EXPECT_EQ(frame->source, "microscope");
  EXPECT_TRUE(frame->settles);
  EXPECT_EQ(frame->image.size(), cv::Size(640, 480));
  ASSERT_TRUE(frame->metres_per_pixel);
  const ImagingModel model = default_imaging().model;
  EXPECT_NEAR(*frame->metres_per_pixel, model.metres_per_pixel({0.016, model.best_focus_m(0.016)}), 2e-8);
  EXPECT_EQ(value("imaging_state"), 1.0);
  EXPECT_EQ(value("focus_verdict"), 0.0);
  EXPECT_EQ(value("focus_locks"), 1.0);
  EXPECT_EQ(value("focus_pictures"), 24.0);
  EXPECT_NEAR(value("zoom"), 0.2, 1e-3);
  EXPECT_NEAR(value("pixel_um"), 1e6 * *frame->metres_per_pixel, 1e-9);
  EXPECT_NEAR(value("magnification"), 6.0 / value("pixel_um"), 1e-9);
  EXPECT_NEAR(value("focus_mm"), 1e3 * model.best_focus_m(0.016), 1.0);
  EXPECT_GT(value("sharpness_tenengrad"), 0.0);
  EXPECT_GT(value("sharpness_variance"), 0.0);
}

TEST_F(ImagingCameraTest, AZoomIsFollowedByFocusAndScale) {
  open(relief(), settings());
  const auto before = usable();
  ASSERT_TRUE(before);
  camera_->zoom(0.6);
  EXPECT_FALSE(*camera_->next());  // not while it moves
  const auto after = usable();
  ASSERT_TRUE(after);
  EXPECT_NEAR(value("zoom"), 0.6, 1e-3);
  EXPECT_NEAR(*after->metres_per_pixel / *before->metres_per_pixel, std::exp(-0.9163 * 0.4), 1e-3);
  EXPECT_EQ(value("focus_locks"), 2.0);
  camera_->zoom(7.0);
  ASSERT_TRUE(usable()) << camera_->remark();
  EXPECT_NEAR(value("zoom"), 1.0, 0.01);  // a share of the travel, less what is kept from its end
}

TEST_F(ImagingCameraTest, RefocusSearchesAnew) {
  open(relief(), settings());
  ASSERT_TRUE(usable());
  camera_->refocus();
  EXPECT_EQ(value("imaging_state"), 0.0);
  ASSERT_TRUE(usable());
  EXPECT_EQ(value("focus_locks"), 2.0);
}

TEST_F(ImagingCameraTest, WithoutAFocusThereAreNoPicturesAndAReason) {
  open(cv::Mat(600, 600, CV_8U, cv::Scalar(180)), settings());
  EXPECT_FALSE(usable());
  EXPECT_EQ(camera_->remark(),
            "no focus found: blank: nothing stands out from the noise anywhere in the range: a blank object, or one "
            "far out of focus");
  EXPECT_EQ(value("imaging_state"), 2.0);
  EXPECT_EQ(value("focus_verdict"), static_cast<double>(FocusVerdict::kBlank));
}

TEST_F(ImagingCameraTest, AxesThatStopAnsweringAreACameraThatIsGone) {
  const ImagingFile file = default_imaging();
  class Silent final : public Axes {
    AxesReading read() noexcept override { return {}; }
    void write(const PerAxis&) noexcept override {}
  };
  runner_ = std::make_shared<AxesRunner>(AxesDevice{std::make_unique<Silent>(), nullptr}, file.axes);
  camera_.emplace(settings(), runner_, simulated_source(file.model, relief(), 0.03), [this] {
    for (int i = 0; i < 60; ++i) runner_->step();
  });
  const auto seen = camera_->next();
  ASSERT_FALSE(seen);
  EXPECT_NE(seen.error().find("axes do not answer"), std::string::npos);
  EXPECT_EQ(camera_->refusal(), seen.error());
}

/// What the camera above the axes gives is decided picture by picture.
class ImagedSourceTest : public ImagingCameraTest {
 protected:
  void open_source(const ImagingCamera::Source& source, FocusLaw law = FocusLaw::kSearch) {
    const ImagingFile file = default_imaging();
    runner_ = std::make_shared<AxesRunner>(open_axes("simulated", {.model = file.axes, .period_s = 1e-3}),
                                           file.axes);
    camera_.emplace(settings(law), runner_, source, [this] {
      for (int i = 0; i < 50; ++i) runner_->step();
    });
  }
  void home() {
    for (int i = 0; i < 400 && runner_->state() == AxesControl::State::kHoming; ++i) (void)camera_->next();
    ASSERT_EQ(runner_->state(), AxesControl::State::kReady);
  }
};

TEST_F(ImagedSourceTest, APrintedLawWithoutPicturesStandsStill) {
  const ImagingCamera::Source microscope = simulated_source(default_imaging().model, relief(), 0.03);
  bool gone = false;
  open_source(
      [&](const AxisPositions& axes, double time_s) -> Camera::Result {
        if (gone) return tl::unexpected<std::string>("the camera is gone");
        return microscope(axes, time_s);
      },
      FocusLaw::kThesis);
  home();
  for (int i = 0; i < 6; ++i) (void)camera_->next();  // it is on its way
  gone = true;
  EXPECT_EQ(camera_->next().error(), "the camera is gone");
  for (int i = 0; i < 4; ++i) (void)camera_->next();  // it brakes
  const double here = value("focus_mm");
  for (int i = 0; i < 20; ++i) EXPECT_FALSE(camera_->next());
  EXPECT_NEAR(value("focus_mm"), here, 0.02);
  gone = false;
  EXPECT_TRUE(camera_->next());
}

TEST_F(ImagedSourceTest, PicturesOfAnotherSizeAreFocusedAnew) {
  const ImagingCamera::Source microscope = simulated_source(default_imaging().model, relief(), 0.03);
  bool small = false;
  open_source([&](const AxisPositions& axes, double time_s) -> Camera::Result {
    auto seen = microscope(axes, time_s);
    if (small) (*seen)->image = (*seen)->image(cv::Rect(80, 60, 480, 360)).clone();
    return seen;
  });
  home();
  for (int i = 0; i < 30; ++i) (void)camera_->next();
  EXPECT_EQ(value("focus_locks"), 0.0);
  small = true;  // in the middle of a search
  const auto frame = usable();
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->image.size(), cv::Size(480, 360));
  small = false;
  ASSERT_TRUE(usable());
  EXPECT_EQ(value("focus_locks"), 2.0);
}

TEST_F(ImagedSourceTest, WhatCannotBeFocusedIsRefusedInWords) {
  Frame frame{.source = "camera", .file = "picture.png", .image = {}};
  open_source([&](const AxisPositions&, double) -> Camera::Result { return frame; });
  for (int i = 0; i < 400 && runner_->state() == AxesControl::State::kHoming; ++i) (void)camera_->next();
  (void)camera_->next();
  EXPECT_NE(camera_->next().error().find("it must be a live one, v4l2:N or video:PATH"), std::string::npos);
  frame.image = cv::Mat(7, 640, CV_8U, cv::Scalar(100));
  EXPECT_EQ(camera_->next().error(),
            "imaging: the camera's pictures must have at least 8 x 8 pixels; they have 640 x 7");
  frame.image = cv::Mat(480, 640, CV_32F, cv::Scalar(100));
  EXPECT_EQ(camera_->next().error(),
            "imaging: the camera's pictures must have 8 or 16 bits and 1, 3 or 4 channels; they have 32 bits "
            "and 1");
  frame.image = cv::Mat(480, 640, CV_8UC2, cv::Scalar(100, 100));
  EXPECT_NE(camera_->next().error().find("8 bits and 2"), std::string::npos);
  frame.image = cv::Mat(480, 640, CV_8UC3, cv::Scalar(100, 100, 100));
  EXPECT_TRUE(camera_->next());
}

TEST(FocusGrey, IsTheSameForEveryDepthAndChannel) {
  EXPECT_EQ(focus_grey(cv::Mat(8, 8, CV_16U, cv::Scalar(257 * 77))).at<std::uint8_t>(3, 3), 77);
  EXPECT_EQ(focus_grey(cv::Mat(8, 8, CV_8UC3, cv::Scalar::all(55))).at<std::uint8_t>(3, 3), 55);
  EXPECT_EQ(focus_grey(cv::Mat(8, 8, CV_16UC4, cv::Scalar::all(257 * 90))).at<std::uint8_t>(3, 3), 90);
  EXPECT_EQ(focus_grey(cv::Mat(8, 8, CV_8UC3, cv::Scalar(0, 0, 100))).at<std::uint8_t>(0, 0), 30);  // red
}

TEST_F(ImagingCameraTest, AxesThatAnswerAgainHomeAnewAndAreFocusedAnew) {
  const ImagingFile file = default_imaging();
  class Silenced final : public Axes {
   public:
    Silenced(std::unique_ptr<SimulatedAxes> axes, const bool& silent) : axes_(std::move(axes)), silent_(silent) {}
    AxesReading read() noexcept override {
      axes_->advance(1e-3);
      return silent_ ? AxesReading{} : axes_->read();
    }
    void write(const PerAxis& currents_a) noexcept override { axes_->write(currents_a); }

   private:
    std::unique_ptr<SimulatedAxes> axes_;
    const bool& silent_;
  };
  bool silent = false;
  auto axes =
      std::make_unique<Silenced>(std::make_unique<SimulatedAxes>(file.axes, PerAxis{5e-3, 5e-3}, 0.0, 1), silent);
  runner_ = std::make_shared<AxesRunner>(AxesDevice{std::move(axes), nullptr}, file.axes);
  camera_.emplace(settings(), runner_, simulated_source(file.model, relief(), 0.03), [this] {
    for (int i = 0; i < 60; ++i) runner_->step();
  });
  ASSERT_TRUE(usable());
  EXPECT_EQ(camera_->remark(), "in focus");
  EXPECT_EQ(camera_->refusal(), "");
  silent = true;
  EXPECT_FALSE(camera_->next());
  EXPECT_NE(camera_->refusal().find("they home anew once they answer"), std::string::npos);
  silent = false;
  EXPECT_FALSE(*camera_->next());
  EXPECT_EQ(camera_->refusal(), "");
  EXPECT_EQ(camera_->remark(), "the axes answer again after they had stopped; they home anew");
  camera_->zoom(0.3);  // is taken up, and carried out once they have homed
  ASSERT_TRUE(usable());
  EXPECT_EQ(camera_->remark(), "in focus");
  EXPECT_NEAR(value("zoom"), 0.3, 1e-3);
  EXPECT_EQ(value("focus_locks"), 2.0);
}

TEST_F(ImagingCameraTest, AxesThatDoNotArriveAreSaid) {
  const ImagingFile file = default_imaging();
  /// Held from outside once it is told to.
  class Held final : public Axes {
   public:
    Held(std::unique_ptr<SimulatedAxes> axes, const bool& held) : axes_(std::move(axes)), held_(held) {}
    AxesReading read() noexcept override {
      if (!held_) axes_->advance(1e-3);
      return axes_->read();
    }
    void write(const PerAxis& currents_a) noexcept override { axes_->write(currents_a); }

   private:
    std::unique_ptr<SimulatedAxes> axes_;
    const bool& held_;
  };
  bool held = false;
  auto held_axes =
      std::make_unique<Held>(std::make_unique<SimulatedAxes>(file.axes, PerAxis{5e-3, 5e-3}, 0.0, 1), held);
  runner_ = std::make_shared<AxesRunner>(AxesDevice{std::move(held_axes), nullptr}, file.axes);
  camera_.emplace(settings(), runner_, simulated_source(file.model, relief(), 0.03), [this] {
    for (int i = 0; i < 50; ++i) runner_->step();
  });
  ASSERT_TRUE(usable());
  EXPECT_EQ(camera_->remark(), "in focus");
  held = true;
  camera_->zoom(0.6);
  // A second less than the longest way takes, and two more.
  const int pictures = static_cast<int>(runner_->longest_way_s() / 0.05);
  for (int i = 0; i < pictures - 20; ++i) EXPECT_FALSE(*camera_->next());
  EXPECT_EQ(camera_->remark(), "");
  for (int i = 0; i < 40; ++i) (void)camera_->next();
  EXPECT_EQ(
      camera_->remark(),
      "the axes do not arrive where they are sent; see what holds them, or whether the imaging file is of "
      "this unit");
}

TEST_F(ImagingCameraTest, RefocusingWhileItRefocusesBeginsAnewOnceMore) {
  open(relief(), settings());
  ASSERT_TRUE(usable());
  for (int i = 0; i < 12; ++i) {
    camera_->refocus();
    for (int k = 0; k < i; ++k) (void)camera_->next();
    if (i % 5 == 0) camera_->zoom(0.2 + 0.02 * i);
  }
  ASSERT_TRUE(usable());
  EXPECT_EQ(value("imaging_state"), 1.0);
  EXPECT_NEAR(value("zoom"), 0.4, 1e-3);
  EXPECT_LE(value("focus_pictures"), 24.0);  // of the newest search
}

TEST_F(ImagingCameraTest, ThePrintedLawNeedsItsExcitationAndThenClimbs) {
  open(relief(), settings(FocusLaw::kThesis));
  while (runner_->state() == AxesControl::State::kHoming) ASSERT_TRUE(camera_->next());
  for (int i = 0; i < 20; ++i) ASSERT_TRUE(camera_->next());
  const double first = value("focus_mm");
  EXPECT_GT(first, 1.0);  // it has left the lower end
  EXPECT_EQ(value("imaging_state"), 3.0);
  EXPECT_EQ(camera_->remark(), "the printed law moves the focus, and cannot say whether it has arrived");
  EXPECT_EQ(camera_->remark(), "");  // once
  EXPECT_GT(value("sharpness_tenengrad"), 0.0);
  EXPECT_GT(value("sharpness_variance"), 0.0);
  camera_->refocus();
  ASSERT_TRUE(camera_->next());
  ASSERT_TRUE(camera_->next());
  EXPECT_EQ(value("focus_locks"), 0.0);  // it never says that it has found one
}

/// The contour of the node follows the zoom.
TEST_F(ImagingCameraTest, TheContoursScaleFollowsTheZoom) {
  const cv::Mat heart = cv::imread(std::string(TELEKERF_PICTURES) + "/gear.png");
  ASSERT_FALSE(heart.empty());
  ImagingCameraSettings wide = settings(FocusLaw::kSearch, 0.05);
  wide.region = 1.0;
  open(heart, wide);
  ContourRequest request;
  request.workspace_radius_m = 0.05;
  VisionNode node(request);
  std::vector<ContourMessage> published;
  for (int i = 0; i < 700 && published.size() < 2; ++i) {
    auto outcome = node.step(camera_->next());
    if (!outcome.publish) continue;
    published.push_back(*outcome.publish);
    camera_->zoom(0.25);
  }
  ASSERT_EQ(published.size(), 2U) << camera_->remark();
  const double ratio = published[1].metres_per_pixel / published[0].metres_per_pixel;
  EXPECT_NEAR(ratio, std::exp(-0.9163 * 0.2), 2e-3);
  // The same thing, as large as before: the lens' distortion, which nobody has calibrated, is all that
  // differs.
  const auto size = [](const ContourMessage& contour) {
    return geometry::bounding_box(contour.points_m).size().x();
  };
  EXPECT_NEAR(size(published[1]) / size(published[0]), 1.0, 0.01);
}

}  // namespace
}  // namespace telekerf::vision_process
