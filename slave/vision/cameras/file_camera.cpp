// SPDX-License-Identifier: Apache-2.0
#include "slave/vision/cameras/file_camera.h"

#include <fmt/format.h>

namespace telekerf::vision_process {

Camera::Result FileCamera::next() {
  const auto stamp = stamp_of(file_);
  if (!stamp) return tl::unexpected(fmt::format("{}: cannot be read", file_.string()));
  if (stamp == seen_) return std::nullopt;
  seen_ = stamp;
  return Frame{file_.filename().string(), file_.string()};
}

std::unique_ptr<Camera> open_file_camera(std::string_view path) { return std::make_unique<FileCamera>(path); }

}  // namespace telekerf::vision_process
