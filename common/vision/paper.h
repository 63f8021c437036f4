// SPDX-License-Identifier: Apache-2.0
// A sheet of known size in the picture: its perspective is taken out, and it says how large everything is.
#pragma once

#include <opencv2/core/mat.hpp>
#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "common/runtime/enum_table.h"
#include "common/runtime/vectors.h"

namespace telekerf::vision {

enum class Paper { kNone, kA4, kA5, kLetter };
inline constexpr EnumRow<Paper> kPaperRows[] = {
    {"none", Paper::kNone, "nothing in the picture says how large it is"},
    {"a4", Paper::kA4, "210 x 297 mm"},
    {"a5", Paper::kA5, "148 x 210 mm"},
    {"letter", Paper::kLetter, "215.9 x 279.4 mm"},
};
inline constexpr EnumTable<Paper> kPapers(kPaperRows);

/// The sheet as if seen straight from above.
struct FlatSheet {
  cv::Mat picture;  ///< of the same kind as the picture
  double metres_per_pixel = 0.0;
  cv::Matx33d from_picture;  ///< projective: the picture's pixels to those of the sheet

  Vec2 to_sheet(const Vec2& px) const;
};

/// Finds the sheet, upright or lying. The error is one sentence: no light sheet whose four corners are seen.
tl::expected<FlatSheet, std::string> flat_sheet(const cv::Mat& picture, Paper paper);

}  // namespace telekerf::vision
