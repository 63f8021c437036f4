// SPDX-License-Identifier: Apache-2.0
// What the camera shows, small and compressed, for whoever looks on from afar.
#pragma once

#include <opencv2/core/mat.hpp>
#include <optional>

#include "common/protocol/preview.h"
#include "common/vision/scaling.h"

namespace telekerf::vision_process {

inline constexpr int kPreviewSide_px = 800;  ///< of the longer side, at most

/// `picture`: any depth, 1, 3 or 4 channels; `scale`: from its pixels to the workpiece. Nothing: it cannot be
/// shown.
std::optional<PreviewMessage> preview_of(const cv::Mat& picture, const vision::Scale& scale);

}  // namespace telekerf::vision_process
