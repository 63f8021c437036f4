// SPDX-License-Identifier: Apache-2.0
#include "slave/vision/cameras/file_stamp.h"

#include <system_error>

namespace telekerf::vision_process {

std::optional<FileStamp> stamp_of(const std::filesystem::path& file) {
  std::error_code error;
  const FileStamp stamp{std::filesystem::last_write_time(file, error),
                        std::filesystem::file_size(file, error)};
  return error ? std::nullopt : std::optional(stamp);
}

}  // namespace telekerf::vision_process
