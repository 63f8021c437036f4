// SPDX-License-Identifier: Apache-2.0
// A folder of pictures and drawings as a camera: in the order of their names; what is changed or added later
// is a new frame.
#pragma once

#include <filesystem>
#include <map>
#include <utility>

#include "slave/vision/cameras/camera.h"
#include "slave/vision/cameras/file_stamp.h"

namespace telekerf::vision_process {

class FolderCamera : public Camera {
 public:
  explicit FolderCamera(std::filesystem::path folder) : folder_(std::move(folder)) {}

  Result next() override;

 private:
  std::filesystem::path folder_;
  std::map<std::filesystem::path, FileStamp> seen_;
};

}  // namespace telekerf::vision_process
