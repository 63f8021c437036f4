// SPDX-License-Identifier: Apache-2.0
// Still pictures as files.
#pragma once

#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>
#include <tl/expected.hpp>

namespace telekerf::vision {

struct Picture {
  cv::Mat image;
  double reduction = 1.0;     ///< original pixels per pixel of `image`
  std::optional<double> dpi;  ///< original pixels an inch, where a scanner has written them
};

/// Reads a still picture of any format OpenCV knows, at most 128 Mpx; larger than 24 Mpx comes back reduced,
/// with the factor in `reduction`, and turned as its EXIF orientation says. The error is one sentence that
/// begins with the file's name.
tl::expected<Picture, std::string> read_picture(const std::string& file);

}  // namespace telekerf::vision
