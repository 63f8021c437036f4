// SPDX-License-Identifier: Apache-2.0
#include "slave/vision/preview.h"

#include <algorithm>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "common/vision/raster/grey_plane.h"

namespace telekerf::vision_process {
namespace {

constexpr int kQuality = 75;

}  // namespace

std::optional<PreviewMessage> preview_of(const cv::Mat& picture, const vision::Scale& scale) {
  cv::Mat shown = vision::colour_plane(picture);
  if (shown.empty()) return std::nullopt;
  const double gain = std::min(1.0, static_cast<double>(kPreviewSide_px) / std::max(shown.cols, shown.rows));
  if (gain < 1.0) {
    const cv::Size size(std::max(1, cvRound(gain * shown.cols)), std::max(1, cvRound(gain * shown.rows)));
    cv::resize(shown, shown, size, 0, 0, cv::INTER_AREA);
  }
  PreviewMessage message;
  // A pixel's place is its middle.
  const Vec2 first_m = scale.to_workpiece(Vec2(-0.5, -0.5));
  const Vec2 last_m = scale.to_workpiece(Vec2(picture.cols - 0.5, picture.rows - 0.5));
  message.left_m = first_m.x();
  message.top_m = first_m.y();
  message.width_m = last_m.x() - first_m.x();
  message.height_m = first_m.y() - last_m.y();
  if (!cv::imencode(".jpg", shown, message.jpeg, {cv::IMWRITE_JPEG_QUALITY, kQuality}) ||
      message.jpeg.size() > kMaxPreviewBytes)
    return std::nullopt;
  return message;
}

}  // namespace telekerf::vision_process
