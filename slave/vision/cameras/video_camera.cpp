// SPDX-License-Identifier: Apache-2.0
#include "slave/vision/cameras/video_camera.h"

#include <fmt/format.h>

#include <algorithm>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/videoio.hpp>
#include <thread>
#include <utility>

namespace telekerf::vision_process {

VideoCamera::VideoCamera(std::filesystem::path file)
    : file_(std::move(file)), capture_(std::make_unique<cv::VideoCapture>()) {}

VideoCamera::~VideoCamera() = default;

Camera::Result VideoCamera::next() {
  const std::string name = file_.filename().string();
  if (!capture_->isOpened()) {
    const auto stamp = stamp_of(file_);
    if (stamp && stamp == finished_) return std::nullopt;  // shown to its end
    // A file that is not there yet is no news; what can be said is said once, in a sentence of ours.
    cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
    if (!capture_->open(file_.string(), cv::CAP_FFMPEG))
      return tl::unexpected(fmt::format("{}: cannot be opened", name));
    opened_ = stamp;
    shown_ = 0;
  }
  cv::Mat image;
  if (!capture_->read(image) || image.empty()) {
    capture_->release();
    if (shown_ == 0) return tl::unexpected(fmt::format("{}: gives no picture", name));
    finished_ = opened_;
    return std::nullopt;
  }
  keep_pace();
  ++shown_;
  return Frame{name, "", std::move(image), true};
}

void VideoCamera::keep_pace() {
  const double rate = capture_->get(cv::CAP_PROP_FPS);
  const auto now = std::chrono::steady_clock::now();
  if (shown_ == 0 || !(rate > 1.0)) {
    due_ = now;
    return;
  }
  due_ = std::max(due_ + std::chrono::microseconds(static_cast<long>(1e6 / rate)),
                  now - std::chrono::seconds(1));
  std::this_thread::sleep_until(due_);
}

std::unique_ptr<Camera> open_video_camera(std::string_view path) {
  return std::make_unique<VideoCamera>(path);
}

}  // namespace telekerf::vision_process
