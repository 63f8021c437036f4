// SPDX-License-Identifier: Apache-2.0
#include "slave/vision/cameras/folder_camera.h"

#include <fmt/format.h>

#include <system_error>

#include "slave/vision/cameras/file_kind.h"

namespace telekerf::vision_process {

Camera::Result FolderCamera::next() {
  namespace fs = std::filesystem;
  std::error_code error;
  std::map<fs::path, FileStamp> files;
  for (fs::directory_iterator at(folder_, error), end; !error && at != end; at.increment(error)) {
    if (!is_picture(at->path())) continue;
    if (const auto stamp = stamp_of(at->path())) files.emplace(at->path(), *stamp);
  }
  if (error) return tl::unexpected(fmt::format("{}: cannot be read", folder_.string()));
  if (files.empty()) return tl::unexpected(fmt::format("{}: there is no picture in it", folder_.string()));
  for (const auto& [file, stamp] : files) {
    const auto seen = seen_.find(file);
    if (seen != seen_.end() && seen->second == stamp) continue;
    seen_[file] = stamp;
    return Frame{file.filename().string(), file.string()};
  }
  return std::nullopt;
}

std::unique_ptr<Camera> open_folder_camera(std::string_view path) {
  return std::make_unique<FolderCamera>(path);
}

}  // namespace telekerf::vision_process
