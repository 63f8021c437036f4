// SPDX-License-Identifier: Apache-2.0
#include "slave/vision/cameras/cameras.h"

#include <fmt/format.h>

#include <filesystem>
#include <string_view>

#include "slave/vision/cameras/file_camera.h"
#include "slave/vision/cameras/file_kind.h"
#include "slave/vision/cameras/folder_camera.h"
#include "slave/vision/cameras/v4l2_camera.h"
#include "slave/vision/cameras/video_camera.h"

namespace telekerf::vision_process {
namespace {

// A camera of your own: its header above, and one row.
constexpr CameraKind kKinds[] = {
    kV4l2Camera,
    kFileCamera,
    kFolderCamera,
    kVideoCamera,
};
constexpr CameraRegistry kCameras("camera", kKinds);

/// A number alone is that of a /dev/video device.
std::string spelt_out(const std::string& camera) {
  const bool number = !camera.empty() && camera.find_first_not_of("0123456789") == std::string::npos;
  return number ? "v4l2:" + camera : camera;
}

/// Looks once, so that what is not there is refused at the start.
std::unique_ptr<Camera> proven(const std::string& camera, ErrorKind kind, std::string_view remedy) {
  if (const auto first = kCameras.open(camera)->next(); !first)
    throw StartupError(kind, fmt::format("{}; {}", first.error(), remedy));
  return kCameras.open(camera);
}

}  // namespace

std::string camera_forms() { return kCameras.forms(); }

std::string validate_camera(const std::string& camera) { return kCameras.validate(spelt_out(camera)); }

std::unique_ptr<Camera> open_camera(const std::string& camera) {
  return proven(spelt_out(camera), ErrorKind::kHardware,
                fmt::format("--camera takes {}, or the N of v4l2 alone", camera_forms()));
}

std::unique_ptr<Camera> open_image(const std::string& path) {
  const char* kind = std::filesystem::is_directory(path) ? "folder" : is_video(path) ? "video" : "file";
  return proven(fmt::format("{}:{}", kind, path), ErrorKind::kInput,
                "--image takes a picture, an SVG or DXF file, a folder of them, or a video");
}

}  // namespace telekerf::vision_process
