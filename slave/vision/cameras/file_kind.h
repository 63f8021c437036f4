// SPDX-License-Identifier: Apache-2.0
// What a file shows, by its extension.
#pragma once

#include <filesystem>

namespace telekerf::vision_process {

bool is_video(const std::filesystem::path& file);
/// A still picture or a drawing.
bool is_picture(const std::filesystem::path& file);

}  // namespace telekerf::vision_process
