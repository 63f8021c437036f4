// SPDX-License-Identifier: Apache-2.0
#include "common/reporting/picture_file.h"

#include <opencv2/imgcodecs.hpp>

#include "common/runtime/startup_error.h"

namespace telekerf::reporting {

void write_picture(const std::filesystem::path& file, const cv::Mat& picture) {
  if (picture.empty() || !cv::imwrite(file.string(), picture))
    throw environment_error(file.string() + ": cannot be written");
}

}  // namespace telekerf::reporting
