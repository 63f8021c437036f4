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
  EXPECT_EQ(camera_->remark(), "no focus found: blank");
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
  EXPECT_NE(seen.error().find("stopped answering"), std::string::npos);
}

TEST_F(ImagingCameraTest, ThePrintedLawNeedsItsExcitationAndThenClimbs) {
  open(relief(), settings(FocusLaw::kThesis));
  for (int i = 0; i < 30; ++i) ASSERT_TRUE(camera_->next());
  const double first = value("focus_mm");
  EXPECT_GT(first, 1.0);  // it has left the lower end
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
