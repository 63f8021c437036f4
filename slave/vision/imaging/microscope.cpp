// SPDX-License-Identifier: Apache-2.0
#include "slave/vision/imaging/microscope.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <utility>

namespace telekerf::imaging {
namespace {

constexpr double kDarkestSpeck = 0.25;  ///< share of the light that a speck lets through
constexpr double kSpeck_px = 2.0;       ///< its radius on a picture 128 pixels wide

void blur(cv::Mat& image, double deviation_px) {
  // Wider than half the picture there is nothing to be seen any more; beyond three deviations nothing is
  // left.
  deviation_px = std::min(deviation_px, 0.5 * image.cols);
  const int size = 2 * static_cast<int>(std::ceil(3.0 * deviation_px)) + 1;
  cv::GaussianBlur(image, image, {size, size}, deviation_px, deviation_px, cv::BORDER_REFLECT);
}

}  // namespace

ImagingModel simulated_model() {
  ImagingModel model;
  model.distortion = -0.01;
  model.flat_field = {0.0, 0.0, -0.24, 0.03};
  return model;
}

SimulatedMicroscope::SimulatedMicroscope(const MicroscopeSettings& settings, Object object)
    : settings_(settings), object_(std::move(object)), random_(settings.seed * 2654435761U + 1) {
  CV_Assert(object_.texture.type() == CV_32FC1 && object_.metres_per_texel > 0.0);
}

double SimulatedMicroscope::best_focus_m(double magnification_axis_m) const noexcept {
  const double s = magnification_axis_m / settings_.model.magnification_travel_m;
  return settings_.model.best_focus_m(magnification_axis_m) + object_.height_m +
         settings_.ridge_cubic_m * s * (1.0 - s) * (1.0 - 2.0 * s);
}

double SimulatedMicroscope::defocus_dof(const AxisPositions& axes) const noexcept {
  return (axes.focus_m - best_focus_m(axes.magnification_m)) /
         settings_.model.depth_of_field_m(axes.magnification_m);
}

double SimulatedMicroscope::metres_per_pixel(const AxisPositions& axes) const noexcept {
  // Off focus the scale changes; in focus it is the magnification's, wherever the ridge lies.
  const double off_m = axes.focus_m - best_focus_m(axes.magnification_m);
  return settings_.model.metres_per_pixel(
      {axes.magnification_m, settings_.model.best_focus_m(axes.magnification_m) + off_m});
}

const cv::Mat& SimulatedMicroscope::gathered(double texels) {
  // A pixel gathers the light of several texels. In steps of a tenth, each prepared once.
  const int step = std::max(0, static_cast<int>(std::lround(std::log(texels) / std::log(1.1))));
  if (step == 0) return object_.texture;
  cv::Mat& texture = gathered_[step];
  if (texture.empty()) {
    texture = object_.texture.clone();
    blur(texture, 0.4 * std::pow(1.1, step));
  }
  return texture;
}

void SimulatedMicroscope::prepare_places() {
  if (!place_x_.empty()) return;
  cv::Mat_<float> across(settings_.picture);
  cv::Mat_<float> down(settings_.picture);
  const cv::Size size = settings_.picture;
  const double half = 0.5 * size.width;
  for (auto place = across.begin(); place != across.end(); ++place) {
    const cv::Point at = place.pos();
    const double dx = at.x - 0.5 * (size.width - 1);
    const double dy = at.y - 0.5 * (size.height - 1);
    // From where it is seen to where it is: the inverse of r (1 + k r^2), by Newton's iteration.
    const double kr2 = settings_.model.distortion * (dx * dx + dy * dy) / (half * half);
    double shrink = 1.0;
    for (int i = 0; i < 3; ++i) {
      const double bend = kr2 * shrink * shrink;
      shrink -= (shrink * (1.0 + bend) - 1.0) / (1.0 + 3.0 * bend);
    }
    *place = static_cast<float>(shrink * dx);
    down(at) = static_cast<float>(shrink * dy);
  }
  place_x_ = across;
  place_y_ = down;
}

cv::Mat SimulatedMicroscope::sharp(double metres_per_pixel) {
  prepare_places();
  const double texels = metres_per_pixel / object_.metres_per_texel;
  const cv::Mat& texture = gathered(texels);
  const cv::Mat from_x =
      place_x_ * texels + (0.5 * (texture.cols - 1) - object_.x_m / object_.metres_per_texel);
  const cv::Mat from_y =
      place_y_ * texels + (0.5 * (texture.rows - 1) - object_.y_m / object_.metres_per_texel);
  cv::Mat out;
  cv::remap(texture, out, from_x, from_y, cv::INTER_LINEAR, cv::BORDER_REFLECT);
  return out;
}

const cv::Mat& SimulatedMicroscope::light() {
  if (light_.empty()) {
    cv::Mat_<float> all(settings_.picture);
    for (auto light = all.begin(); light != all.end(); ++light)
      *light = static_cast<float>(settings_.model.light(light.pos().x, light.pos().y, settings_.picture));
    light_ = all;
  }
  return light_;
}

const cv::Mat& SimulatedMicroscope::dust() {
  if (dust_.empty()) {
    const cv::Size size = settings_.picture;
    dust_ = cv::Mat(size, CV_32F, cv::Scalar(1.0));
    cv::RNG random(settings_.seed * 40503U + 7);
    const double radius = kSpeck_px * size.width / 128.0;
    for (int i = 0; i < settings_.dust_specks; ++i) {
      cv::circle(dust_, {random.uniform(0, size.width), random.uniform(0, size.height)},
                 static_cast<int>(std::lround(radius)), cv::Scalar(kDarkestSpeck), cv::FILLED);
    }
  }
  return dust_;
}

cv::Mat SimulatedMicroscope::picture(const AxisPositions& axes, double time_s) {
  const double defocus = defocus_dof(axes);
  const double magnification = settings_.model.magnification(axes.magnification_m);
  const Optics& optics = settings_.model.optics;
  cv::Mat image = sharp(metres_per_pixel(axes));
  blur(image, optics.blur_px(defocus, magnification));
  if (settings_.dust_specks > 0) {
    cv::Mat specks = dust().clone();
    blur(specks, optics.blur_px(defocus - settings_.dust_dof, magnification));
    image = image.mul(specks);
  }
  image = image.mul(light(),
                    (1.0 + settings_.exposure_per_dof * defocus) * (1.0 + settings_.exposure_per_s * time_s));
  cv::Mat noise(image.size(), CV_32F);
  random_.fill(noise, cv::RNG::NORMAL, 0.0, 1.0);
  // Shot noise: variance in proportion to the light; read noise beside it.
  cv::Mat deviation = cv::max(image, 0.0) * (settings_.shot_noise * settings_.shot_noise / 255.0) +
                      settings_.read_noise * settings_.read_noise;
  cv::sqrt(deviation, deviation);
  image += noise.mul(deviation);
  cv::Mat grey;
  image.convertTo(grey, CV_8U);
  return grey;
}

}  // namespace telekerf::imaging
