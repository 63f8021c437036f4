// SPDX-License-Identifier: Apache-2.0
#include "slave/vision/imaging/imaging_model.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "slave/vision/imaging/sharpness.h"

namespace telekerf::imaging {

double ImagingModel::best_focus_m(double magnification_axis_m) const noexcept {
  const double s = magnification_axis_m / magnification_travel_m;
  return ridge_m[0] + s * (ridge_m[1] + s * ridge_m[2]);
}

double ImagingModel::metres_per_pixel(const AxisPositions& axes) const noexcept {
  const double s = axes.magnification_m / magnification_travel_m;
  const double in_focus = std::exp(log_scale[0] + s * (log_scale[1] + s * (log_scale[2] + s * log_scale[3])));
  return in_focus * (1.0 + focus_scale_per_m * (axes.focus_m - best_focus_m(axes.magnification_m)));
}

double ImagingModel::magnification(double magnification_axis_m) const noexcept {
  return optics.magnification(metres_per_pixel({magnification_axis_m, best_focus_m(magnification_axis_m)}));
}

double ImagingModel::depth_of_field_m(double magnification_axis_m) const noexcept {
  return optics.depth_of_field_m(magnification(magnification_axis_m));
}

double ImagingModel::light(double x_px, double y_px, const cv::Size& picture) const noexcept {
  const double half = 0.5 * picture.width;
  const double x = (x_px - 0.5 * (picture.width - 1)) / half;
  const double y = (y_px - 0.5 * (picture.height - 1)) / half;
  const double r2 = x * x + y * y;
  return 1.0 + flat_field[0] * x + flat_field[1] * y + flat_field[2] * r2 + flat_field[3] * r2 * r2;
}

std::array<double, kTiles> flat_within(const ImagingModel& model, const cv::Size& picture,
                                       const cv::Rect& region) {
  cv::Mat_<double> light(region.size());
  for (auto here = light.begin(); here != light.end(); ++here) {
    const cv::Point at = here.pos() + region.tl();
    *here = model.light(at.x, at.y, picture);
  }
  return flat_of(light);
}

bool PictureCorrection::idle() const noexcept {
  return model_.distortion == 0.0 &&
         std::all_of(model_.flat_field.begin(), model_.flat_field.end(), [](double f) { return f == 0.0; });
}

void PictureCorrection::prepare(const cv::Size& size) {
  if (from_x_.size() == size) return;
  cv::Mat_<float> from_x(size);
  cv::Mat_<float> from_y(size);
  cv::Mat_<float> gains(size);
  const double half = 0.5 * size.width;
  const double middle_x = 0.5 * (size.width - 1);
  const double middle_y = 0.5 * (size.height - 1);
  for (auto gain = gains.begin(); gain != gains.end(); ++gain) {
    const cv::Point at = gain.pos();
    const double dx = at.x - middle_x;
    const double dy = at.y - middle_y;
    const double stretch = 1.0 + model_.distortion * (dx * dx + dy * dy) / (half * half);
    const double seen_x = middle_x + stretch * dx;
    const double seen_y = middle_y + stretch * dy;
    from_x(at) = static_cast<float>(seen_x);
    from_y(at) = static_cast<float>(seen_y);
    *gain = static_cast<float>(1.0 / std::max(0.1, model_.light(seen_x, seen_y, size)));
  }
  from_x_ = from_x;
  from_y_ = from_y;
  gain_ = gains;
}

cv::Mat PictureCorrection::apply(const cv::Mat& picture) {
  if (idle()) return picture;
  prepare(picture.size());
  cv::Mat straight;
  cv::remap(picture, straight, from_x_, from_y_, cv::INTER_LINEAR, cv::BORDER_REPLICATE);
  std::vector<cv::Mat> channels;
  cv::split(straight, channels);
  for (cv::Mat& channel : channels) {
    cv::Mat even;
    channel.convertTo(even, CV_32F);
    even = even.mul(gain_);
    even.convertTo(channel, picture.depth());
  }
  cv::Mat out;
  cv::merge(channels, out);
  return out;
}

}  // namespace telekerf::imaging
