// SPDX-License-Identifier: Apache-2.0
#include "slave/vision/cameras/v4l2_camera.h"

#include <fmt/format.h>

#include <charconv>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/videoio.hpp>
#include <optional>
#include <system_error>
#include <utility>

namespace telekerf::vision_process {
namespace {

std::optional<int> device_number(std::string_view text) {
  int number = -1;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  const bool whole = error == std::errc{} && end == text.data() + text.size();
  return whole && number >= 0 && number <= 255 ? std::optional(number) : std::nullopt;
}

}  // namespace

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

std::string validate_device_number(std::string_view text) {
  return device_number(text) ? "" : "the number of a /dev/video device must be from 0 to 255";
}

std::unique_ptr<Camera> open_v4l2_camera(std::string_view number) {
  return std::make_unique<V4l2Camera>(device_number(number).value());
}

}  // namespace telekerf::vision_process
