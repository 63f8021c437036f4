// SPDX-License-Identifier: Apache-2.0
// A picture becomes a file, or somebody hears why not.
#pragma once

#include <filesystem>
#include <opencv2/core.hpp>

namespace telekerf::reporting {

/// The extension says in which format; the folder must exist. Throws StartupError.
void write_picture(const std::filesystem::path& file, const cv::Mat& picture);

}  // namespace telekerf::reporting
