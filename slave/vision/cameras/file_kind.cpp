// SPDX-License-Identifier: Apache-2.0
#include "slave/vision/cameras/file_kind.h"

#include <algorithm>
#include <cctype>
#include <initializer_list>
#include <string>
#include <string_view>

namespace telekerf::vision_process {
namespace {

bool is_one_of(const std::filesystem::path& file, std::initializer_list<std::string_view> kinds) {
  std::string kind = file.extension().string();
  std::transform(kind.begin(), kind.end(), kind.begin(), [](unsigned char c) { return std::tolower(c); });
  return std::find(kinds.begin(), kinds.end(), kind) != kinds.end();
}

}  // namespace

bool is_video(const std::filesystem::path& file) {
  return is_one_of(file, {".avi", ".mp4", ".m4v", ".mkv", ".mov", ".webm", ".mpg", ".mpeg", ".ogv"});
}

bool is_picture(const std::filesystem::path& file) {
  return is_one_of(file, {".png", ".jpg", ".jpeg", ".bmp", ".tif", ".tiff", ".webp", ".pgm", ".ppm", ".pbm",
                          ".pnm", ".jp2", ".svg", ".dxf"});
}

}  // namespace telekerf::vision_process
