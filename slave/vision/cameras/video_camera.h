// SPDX-License-Identifier: Apache-2.0
// A video file as a camera, at its own pace: shown once, and again each time it is written anew.
#pragma once

#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>
#include <string_view>

#include "slave/vision/cameras/camera.h"
#include "slave/vision/cameras/file_stamp.h"

namespace cv {
class VideoCapture;
}

namespace telekerf::vision_process {

class VideoCamera : public Camera {
 public:
  explicit VideoCamera(std::filesystem::path file);
  ~VideoCamera() override;

  Result next() override;

 private:
  void keep_pace();

  std::filesystem::path file_;
  std::unique_ptr<cv::VideoCapture> capture_;
  std::optional<FileStamp> opened_;
  std::optional<FileStamp> finished_;
  int shown_ = 0;
  std::chrono::steady_clock::time_point due_;
};

std::unique_ptr<Camera> open_video_camera(std::string_view path);

inline constexpr CameraKind kVideoCamera{"video", "video:PATH", validate_path, open_video_camera};

}  // namespace telekerf::vision_process
