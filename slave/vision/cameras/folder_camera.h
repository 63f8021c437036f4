// SPDX-License-Identifier: Apache-2.0
// A folder of pictures and drawings as a camera: in the order of their names; what is changed or added later
// is a new frame.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <string_view>
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

std::unique_ptr<Camera> open_folder_camera(std::string_view path);

inline constexpr CameraKind kFolderCamera{"folder", "folder:PATH", validate_path, open_folder_camera};

}  // namespace telekerf::vision_process
