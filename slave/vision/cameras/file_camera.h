// SPDX-License-Identifier: Apache-2.0
// A picture or drawing as a camera: each time it is written it is a new frame.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string_view>
#include <utility>

#include "slave/vision/cameras/camera.h"
#include "slave/vision/cameras/file_stamp.h"

namespace telekerf::vision_process {

class FileCamera : public Camera {
 public:
  explicit FileCamera(std::filesystem::path file) : file_(std::move(file)) {}

  Result next() override;

 private:
  std::filesystem::path file_;
  std::optional<FileStamp> seen_;
};

std::unique_ptr<Camera> open_file_camera(std::string_view path);

inline constexpr CameraKind kFileCamera{"file", "file:PATH", validate_path, open_file_camera};

}  // namespace telekerf::vision_process
