// SPDX-License-Identifier: Apache-2.0
#include "experiments/machining/drawn_pictures.h"

#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <random>
#include <string_view>
#include <vector>

namespace telekerf::experiments {
namespace {

constexpr int kSide = 480;

/// -1 to 1, the same with every library.
class Spread {
 public:
  explicit Spread(std::uint64_t seed) : random_(seed) {}
  double operator()() { return 2.0 * static_cast<double>(random_() >> 11) * 0x1p-53 - 1.0; }

 private:
  std::mt19937_64 random_;
};

std::vector<cv::Point> polygon(const std::function<double(double)>& radius_px, int shift) {
  constexpr int kPoints = 1440;
  std::vector<cv::Point> points;
  for (int i = 0; i < kPoints; ++i) {
    const double t = 2.0 * std::numbers::pi * i / kPoints;
    const double r = radius_px(t);
    points.emplace_back(static_cast<int>((0.5 * kSide + r * std::cos(t)) * (1 << shift)),
                        static_cast<int>((0.5 * kSide + r * std::sin(t)) * (1 << shift)));
  }
  return points;
}

/// A circle with eleven harmonics, falling as k^-1.3.
std::function<double(double)> ragged(Spread& spread, double radius_px, double most) {
  std::array<double, 12> even{}, odd{};
  for (std::size_t k = 2; k < even.size(); ++k) {
    even[k] = most * spread() / std::pow(static_cast<double>(k), 1.3);
    odd[k] = most * spread() / std::pow(static_cast<double>(k), 1.3);
  }
  return [=](double t) {
    double r = 1.0;
    for (std::size_t k = 2; k < even.size(); ++k)
      r += even[k] * std::cos(static_cast<double>(k) * t) + odd[k] * std::sin(static_cast<double>(k) * t);
    return radius_px * std::max(r, 0.3);
  };
}

constexpr int kShift = 8;

cv::Mat filled(const std::vector<cv::Point>& outline) {
  cv::Mat mask(kSide, kSide, CV_8UC1, cv::Scalar(0));
  cv::fillPoly(mask, std::vector<std::vector<cv::Point>>{outline}, cv::Scalar(255), cv::LINE_AA, kShift);
  return mask;
}

void add_noise(cv::Mat& image, Spread& spread, double grey_levels) {
  for (int row = 0; row < image.rows; ++row) {
    auto* values = image.ptr<std::uint8_t>(row);
    for (int i = 0; i < image.cols * image.channels(); ++i)
      values[i] = cv::saturate_cast<std::uint8_t>(values[i] + grey_levels * spread());
  }
}

/// Slow mottling, -1 to 1.
cv::Mat mottled(Spread& spread, double size_px) {
  cv::Mat out(kSide, kSide, CV_32F);
  for (int row = 0; row < kSide; ++row)
    for (int column = 0; column < kSide; ++column) out.at<float>(row, column) = static_cast<float>(spread());
  cv::GaussianBlur(out, out, {}, size_px);
  cv::normalize(out, out, -1.0, 1.0, cv::NORM_MINMAX);
  return out;
}

/// `inside` where the mask is full, `outside` where it is empty, each brighter or darker by its mottling.
cv::Mat coloured(const cv::Mat& mask, const cv::Vec3d& inside, double inside_mottling,
                 const cv::Vec3d& outside, double outside_mottling, const cv::Mat& mottling) {
  cv::Mat out(kSide, kSide, CV_8UC3);
  for (int row = 0; row < kSide; ++row) {
    for (int column = 0; column < kSide; ++column) {
      const double share = mask.at<std::uint8_t>(row, column) / 255.0;
      const double tint = mottling.at<float>(row, column);
      for (int k = 0; k < 3; ++k)
        out.at<cv::Vec3b>(row, column)[k] =
            cv::saturate_cast<std::uint8_t>(share * (inside[k] + inside_mottling * tint) +
                                            (1.0 - share) * (outside[k] + outside_mottling * tint));
    }
  }
  return out;
}

cv::Mat irregular_outline(std::uint64_t seed) {
  Spread spread(seed);
  const auto radius = ragged(spread, 130.0, 0.35);
  cv::Mat image(kSide, kSide, CV_8UC1, cv::Scalar(205));
  cv::fillPoly(image, std::vector<std::vector<cv::Point>>{polygon(radius, kShift)}, cv::Scalar(60),
               cv::LINE_AA, kShift);
  cv::GaussianBlur(image, image, {}, 0.8);
  add_noise(image, spread, 3.0);
  return image;
}

/// Eight rounded legs about a disc.
cv::Mat eight_leg_cam() {
  const auto radius = [](double t) { return 150.0 * (1.0 + 0.2 * std::tanh(2.2 * std::cos(8.0 * t))); };
  cv::Mat image(kSide, kSide, CV_8UC1, cv::Scalar(255));
  image.setTo(20, filled(polygon(radius, kShift)) > 127);
  cv::GaussianBlur(image, image, {}, 0.7);
  return image;
}

cv::Mat melanoma_like() {
  Spread spread(85);
  const auto radius = ragged(spread, 135.0, 0.3);
  cv::Mat mask = filled(polygon(radius, kShift));
  cv::GaussianBlur(mask, mask, {}, 3.0);  // the border is soft
  cv::Mat image = coloured(mask, {42, 52, 78}, 22.0, {168, 188, 226}, 7.0, mottled(spread, 9.0));
  add_noise(image, spread, 4.0);
  return image;
}

cv::Mat tissue_like() {
  Spread spread(86);
  const auto radius = ragged(spread, 140.0, 0.2);
  cv::Mat mask = filled(polygon(radius, kShift));
  cv::GaussianBlur(mask, mask, {}, 2.0);
  cv::Mat image = coloured(mask, {52, 44, 138}, 16.0, {158, 162, 222}, 8.0, mottled(spread, 14.0));
  // Wet: a gloss well inside.
  cv::Mat gloss(kSide, kSide, CV_8UC3, cv::Scalar::all(0));
  cv::ellipse(gloss, {215, 205}, {26, 10}, -35.0, 0.0, 360.0, cv::Scalar(60, 60, 60), cv::FILLED,
              cv::LINE_AA);
  cv::GaussianBlur(gloss, gloss, {}, 7.0);
  image += gloss;
  add_noise(image, spread, 4.0);
  return image;
}

/// A pen whose pressure varies, on paper that is lit from one side.
cv::Mat hand_drawn() {
  Spread spread(87);
  const std::vector<cv::Point> line = polygon(ragged(spread, 140.0, 0.3), kShift);
  cv::Mat image(kSide, kSide, CV_8UC1);
  for (int row = 0; row < kSide; ++row)
    for (int column = 0; column < kSide; ++column)
      image.at<std::uint8_t>(row, column) = static_cast<std::uint8_t>(232 - 0.05 * column - 0.03 * row);
  for (std::size_t i = 0; i < line.size(); ++i) {
    const int width = 9 + static_cast<int>(std::lround(2.0 * std::sin(0.02 * static_cast<double>(i))));
    cv::line(image, line[i], line[(i + 1) % line.size()], cv::Scalar(52), width, cv::LINE_AA, kShift);
  }
  cv::GaussianBlur(image, image, {}, 1.0);
  add_noise(image, spread, 3.0);
  return image;
}

}  // namespace

cv::Mat drawn_picture(const std::string& name) {
  constexpr std::string_view kOutline = "outline-";
  if (name.starts_with(kOutline) && name.size() > kOutline.size() && name.size() < 25 &&
      name.find_first_not_of("0123456789", kOutline.size()) == name.npos)
    return irregular_outline(std::stoull(name.substr(kOutline.size())));
  if (name == "eight-leg-cam") return eight_leg_cam();
  if (name == "melanoma-like") return melanoma_like();
  if (name == "tissue-like") return tissue_like();
  if (name == "hand-drawn") return hand_drawn();
  return {};
}

}  // namespace telekerf::experiments
