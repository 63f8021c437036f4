// SPDX-License-Identifier: Apache-2.0
// A camera that Linux knows as /dev/videoN.
#pragma once

#include <memory>

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

}  // namespace telekerf::vision_process
