// SPDX-License-Identifier: Apache-2.0
// A camera that Linux knows as /dev/videoN.
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "slave/vision/cameras/camera.h"

namespace cv {
class VideoCapture;
}

namespace telekerf::vision_process {

class V4l2Camera : public Camera {
 public:
  /// `number`: the N.
  explicit V4l2Camera(int number);
  ~V4l2Camera() override;

  Result next() override;

 private:
  int number_;
  std::unique_ptr<cv::VideoCapture> capture_;
};

/// Validates the N of /dev/videoN.
std::string validate_device_number(std::string_view text);
std::unique_ptr<Camera> open_v4l2_camera(std::string_view number);

inline constexpr CameraKind kV4l2Camera{"v4l2", "v4l2:N", validate_device_number, open_v4l2_camera};

}  // namespace telekerf::vision_process
