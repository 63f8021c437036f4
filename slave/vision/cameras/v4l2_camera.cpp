// SPDX-License-Identifier: Apache-2.0
#include "slave/vision/cameras/v4l2_camera.h"

#include <fmt/format.h>

#include <opencv2/core/utils/logger.hpp>
#include <opencv2/videoio.hpp>
#include <utility>

namespace telekerf::vision_process {

V4l2Camera::V4l2Camera(int number) : number_(number), capture_(std::make_unique<cv::VideoCapture>()) {}

V4l2Camera::~V4l2Camera() = default;

Camera::Result V4l2Camera::next() {
  const std::string name = fmt::format("camera {}", number_);
  if (!capture_->isOpened()) {
    // A device that is not there yet is no news; what can be said is said once, in a sentence of ours.
    cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
    // By name: left to choose, OpenCV asks every photo camera on USB for a file that it cannot read.
    if (!capture_->open(number_, cv::CAP_V4L2))
      return tl::unexpected(fmt::format("{}: cannot be opened", name));
  }
  cv::Mat image;
  if (!capture_->read(image) || image.empty()) {
    capture_->release();
    return tl::unexpected(fmt::format("{}: gives no picture", name));
  }
  return Frame{name, "", std::move(image), true};
}

}  // namespace telekerf::vision_process
