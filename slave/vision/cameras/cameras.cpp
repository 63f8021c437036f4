// SPDX-License-Identifier: Apache-2.0
#include "slave/vision/cameras/cameras.h"

#include <fmt/format.h>

#include <charconv>
#include <optional>
#include <string_view>

#include "common/runtime/device_registry.h"
#include "slave/vision/cameras/file_camera.h"
#include "slave/vision/cameras/file_kind.h"
#include "slave/vision/cameras/folder_camera.h"
#include "slave/vision/cameras/v4l2_camera.h"
#include "slave/vision/cameras/video_camera.h"

namespace telekerf::vision_process {
namespace {

std::string complaint_about_path(std::string_view path) {
  return path.empty() ? "needs a path behind the colon" : "";
}

/// Of /dev/videoN.
std::optional<int> number_of(std::string_view text) {
  int number = -1;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc{} || end != text.data() + text.size() || number < 0 || number > 255)
    return std::nullopt;
  return number;
}

std::string complaint_about_number(std::string_view text) {
  return number_of(text) ? "" : "the number of a /dev/video device must be from 0 to 255";
}

template <typename PathCamera>
std::unique_ptr<Camera> at_path(std::string_view path) {
  return std::make_unique<PathCamera>(std::filesystem::path(path));
}

std::unique_ptr<Camera> v4l2(std::string_view text) { return std::make_unique<V4l2Camera>(*number_of(text)); }

using Table = DeviceRegistry<std::unique_ptr<Camera>>;
constexpr Table::Kind kKinds[] = {
    {"v4l2", "v4l2:N", complaint_about_number, v4l2},
    {"file", "file:PATH", complaint_about_path, at_path<FileCamera>},
    {"folder", "folder:PATH", complaint_about_path, at_path<FolderCamera>},
    {"video", "video:PATH", complaint_about_path, at_path<VideoCamera>},
};
constexpr Table kCameras("camera", kKinds);

/// A number alone is that of a /dev/video device.
std::string spelt_out(const std::string& camera) {
  const bool number = !camera.empty() && camera.find_first_not_of("0123456789") == std::string::npos;
  return number ? "v4l2:" + camera : camera;
}

/// Looks once, so that what is not there is refused at the start.
std::unique_ptr<Camera> proven(const std::string& camera, ErrorKind kind, std::string_view remedy) {
  if (const auto first = kCameras.attach(camera)->next(); !first)
    throw StartupError(kind, fmt::format("{}; {}", first.error(), remedy));
  return kCameras.attach(camera);
}

}  // namespace

std::string camera_forms() { return kCameras.forms(); }

std::string complaint_about_camera(const std::string& camera) {
  return kCameras.complaint(spelt_out(camera));
}

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
