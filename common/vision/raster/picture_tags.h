// SPDX-License-Identifier: Apache-2.0
// What a picture file says beside its pixels: which way is up, and how many pixels an inch has.
#pragma once

#include <fstream>
#include <optional>

namespace telekerf::vision {

struct PictureTags {
  int orientation = 1;        ///< as EXIF counts, 1 to 8
  std::optional<double> dpi;  ///< of a scan; screens' 72 and 96, and what cameras write, say nothing
};

/// Of JPEG, PNG, TIFF and WebP; damaged tags say nothing.
PictureTags tags_of(std::ifstream& file);

}  // namespace telekerf::vision
