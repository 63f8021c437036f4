// SPDX-License-Identifier: Apache-2.0
// Tells a file that was written anew from one that was not.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

namespace telekerf::vision_process {

struct FileStamp {
  std::filesystem::file_time_type written;
  std::uintmax_t size = 0;
  bool operator==(const FileStamp&) const = default;
};

/// Nothing where there is no such file.
std::optional<FileStamp> stamp_of(const std::filesystem::path& file);

}  // namespace telekerf::vision_process
