// SPDX-License-Identifier: Apache-2.0
#include "common/vision/segmentation/things.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "common/vision/segmentation/rating.h"

namespace telekerf::vision {
namespace {

struct Candidate {
  std::vector<cv::Point> outline;
  Rating rating;
  double score = 0.0;
  double level = 0.0;
};

/// Takes out what touches the picture's border: a frame round it would hide all that lies within.
void clear_border(cv::Mat& mask) {
  const auto clear = [&](int x, int y) {
    if (mask.at<unsigned char>(y, x) != 0) cv::floodFill(mask, {x, y}, cv::Scalar(0));
  };
  for (int x = 0; x < mask.cols; ++x) {
    clear(x, 0);
    clear(x, mask.rows - 1);
  }
  for (int y = 0; y < mask.rows; ++y) {
    clear(0, y);
    clear(mask.cols - 1, y);
  }
}

/// The regions that lie further off the background than each of several levels.
std::vector<Candidate> candidates_in(const Scene& scene, const Backdrop& backdrop) {
  constexpr double kMinArea = 6e-4;  // of the picture
  constexpr double kStep = 1.15;     // from level to level
  const double min_area = kMinArea * static_cast<double>(scene.lab.total());
  double largest = 0.0;
  cv::minMaxLoc(backdrop.distance, nullptr, &largest);
  const cv::Mat three = cv::getStructuringElement(cv::MORPH_ELLIPSE, {3, 3});
  const cv::Mat five = cv::getStructuringElement(cv::MORPH_ELLIPSE, {5, 5});
  std::vector<Candidate> out;
  for (double level = std::max(3.0, backdrop.spread + 2.0); level < largest; level *= kStep) {
    cv::Mat mask = backdrop.distance > level;
    cv::morphologyEx(mask, mask, cv::MORPH_CLOSE, five);
    cv::morphologyEx(mask, mask, cv::MORPH_OPEN, three);
    clear_border(mask);
    for (auto& outline : outlines_of_mask(mask, min_area)) {
      Candidate next{std::move(outline), {}, 0.0, level};
      next.rating = rating_of(scene, next.outline);
      next.score = next.rating.touching > 0.0 ? 0.0 : next.rating.score();
      out.push_back(std::move(next));
    }
  }
  return out;
}

cv::Mat mask_of(const Candidate& c, const cv::Size& size) {
  cv::Mat mask(size, CV_8U, cv::Scalar(0));
  cv::drawContours(mask, std::vector<std::vector<cv::Point>>{c.outline}, 0, cv::Scalar(255), cv::FILLED);
  return mask;
}

bool overlap(const cv::Mat& a, const cv::Mat& b) {
  cv::Mat both;
  cv::bitwise_and(a, b, both);
  return cv::countNonZero(both) > 0;
}

/// Two or more things that touch, or whose shadows do: nearly all of a region is as good regions of its own.
/// `all`: best first.
bool falls_apart(const Candidate& whole, const std::vector<Candidate>& all, const cv::Size& size) {
  constexpr double kAsGood = 0.75;
  constexpr double kCovered = 0.65;
  const cv::Mat outside = ~mask_of(whole, size);
  cv::Mat taken(size, CV_8U, cv::Scalar(0));
  const cv::Rect box = cv::boundingRect(whole.outline);
  double covered = 0.0;
  int parts = 0;
  for (const Candidate& c : all) {
    if (c.score < kAsGood * whole.score) break;
    if (c.rating.area > 0.8 * whole.rating.area || c.rating.area < 0.1 * whole.rating.area) continue;
    if (!box.contains(c.outline.front())) continue;
    const cv::Mat mask = mask_of(c, size);
    if (overlap(mask, outside) || overlap(mask, taken)) continue;
    cv::bitwise_or(taken, mask, taken);
    covered += c.rating.area;
    ++parts;
  }
  return parts >= 2 && covered > kCovered * whole.rating.area;
}

/// The best ones, none of which lies within another.
std::vector<Candidate> chosen_of(std::vector<Candidate> all, const cv::Size& size) {
  std::stable_sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.score > b.score; });
  std::vector<Candidate> out;
  cv::Mat taken(size, CV_8U, cv::Scalar(0));
  for (const Candidate& next : all) {
    if (!out.empty() &&
        (next.score < 0.35 * out.front().score || next.rating.weak < 0.3 * out.front().rating.weak))
      continue;
    if (next.score <= 0.0) break;
    const cv::Mat mask = mask_of(next, size);
    if (overlap(mask, taken)) continue;
    if (falls_apart(next, all, size)) continue;
    cv::bitwise_or(mask, taken, taken);
    out.push_back(next);
  }
  return out;
}

}  // namespace

namespace {

/// What lies off the background and is none of the things, as fractions of their area.
struct Rest {
  double whole = 0.0;
  double cut_off = 0.0;    ///< runs over the picture's border
  int cut_offs = 0;        ///< how many do
  bool cuts_into = false;  ///< things are but parts of what runs over the border
};

Rest rest_of(const Backdrop& backdrop, const cv::Mat& things) {
  constexpr double kPart = 0.3;          // of a thing
  constexpr double kWorthAWord = 0.004;  // of all things
  cv::Mat off = backdrop.distance > backdrop.tolerance;
  cv::morphologyEx(off, off, cv::MORPH_OPEN, cv::getStructuringElement(cv::MORPH_ELLIPSE, {3, 3}));
  cv::Mat near;
  cv::dilate(things, near, cv::getStructuringElement(cv::MORPH_ELLIPSE, {11, 11}));
  cv::Mat labels;
  cv::Mat stats;
  cv::Mat centres;
  const int count = cv::connectedComponentsWithStats(off, labels, stats, centres, 8, CV_32S);
  std::vector<double> held(static_cast<std::size_t>(count), 0.0);
  std::vector<double> beyond(held);
  for (int y = 0; y < off.rows; ++y) {
    for (int x = 0; x < off.cols; ++x) {
      const auto i = static_cast<std::size_t>(labels.at<int>(y, x));
      held[i] += things.at<unsigned char>(y, x) != 0;
      beyond[i] += near.at<unsigned char>(y, x) == 0;
    }
  }
  const double area = std::max(1.0, static_cast<double>(cv::countNonZero(things)));
  Rest out;
  double in_parts = 0.0;
  for (int i = 1; i < count; ++i) {
    const auto at = [&](int what) { return stats.at<int>(i, what); };
    const bool touches = at(cv::CC_STAT_LEFT) == 0 || at(cv::CC_STAT_TOP) == 0 ||
                         at(cv::CC_STAT_LEFT) + at(cv::CC_STAT_WIDTH) == off.cols ||
                         at(cv::CC_STAT_TOP) + at(cv::CC_STAT_HEIGHT) == off.rows;
    const auto k = static_cast<std::size_t>(i);
    (touches ? out.cut_off : out.whole) += beyond[k] / area;
    if (touches && beyond[k] > 0.15 * held[k]) in_parts += held[k];
    out.cut_offs += touches && beyond[k] > kWorthAWord * area;
  }
  out.cuts_into = in_parts > kPart * area;
  return out;
}

/// Takes out of a thing the holes that the background is seen through: of its colour, and with as clear an
/// outline as the thing's own.
void cut_holes(const Scene& scene, const Backdrop& backdrop, const Candidate& thing, cv::Mat& mask) {
  constexpr double kOfThing = 0.01;  // area
  constexpr double kClear = 0.6;     // contrast
  constexpr double kLike = 0.6;      // of what counts as background
  constexpr double kRound = 0.3;
  const cv::Mat own = mask_of(thing, mask.size());
  // Half way, as the outline itself.
  const double level = std::max(backdrop.tolerance, 0.5 * thing.rating.median);
  cv::Mat through = (backdrop.distance < level) & own;
  cv::morphologyEx(through, through, cv::MORPH_OPEN, cv::getStructuringElement(cv::MORPH_ELLIPSE, {3, 3}));
  const double min_area = std::max(12.0, kOfThing * cv::contourArea(thing.outline));
  const auto holes = outlines_of_mask(through, min_area);
  for (std::size_t i = 0; i < holes.size(); ++i) {
    const Rating rating = rating_of(scene, holes[i]);
    if (rating.weak < kClear * thing.rating.median || rating.round < kRound) continue;
    cv::Mat hole(mask.size(), CV_8U, cv::Scalar(0));
    cv::drawContours(hole, holes, static_cast<int>(i), cv::Scalar(255), cv::FILLED);
    cv::Mat middle;
    cv::erode(hole, middle, cv::getStructuringElement(cv::MORPH_ELLIPSE, {5, 5}));
    if (cv::countNonZero(middle) == 0 || cv::mean(backdrop.distance, middle)[0] >
                                             kLike * std::max(backdrop.tolerance, 0.2 * thing.rating.median))
      continue;
    mask.setTo(0, hole);
  }
}

/// Words, pebbles, leaves: many small ones of any form.
bool is_texture(const std::vector<Candidate>& things) {
  constexpr std::size_t kFew = 10;
  constexpr std::size_t kMost = 60;
  if (things.size() <= kFew) return false;
  std::vector<double> round;
  for (const Candidate& c : things) round.push_back(c.rating.round);
  std::nth_element(round.begin(), round.begin() + static_cast<std::ptrdiff_t>(round.size() / 2), round.end());
  return things.size() > kMost || round[round.size() / 2] < 0.6;
}

}  // namespace

tl::expected<Things, std::string> things_in(const Scene& scene) {
  constexpr double kUneven = 6.0;
  constexpr double kRagged = 0.25;     // an outline like this is none on an uneven background
  constexpr double kMaxSpread = 9.0;   // of the background, units of L*a*b*
  constexpr double kMinUniform = 0.8;  // fraction of the border that is background
  constexpr double kMinScore = 11.0;
  constexpr double kMinArea = 0.008;  // of the picture, all things together
  constexpr double kMinLargest = 0.008;
  constexpr double kMaxWhole = 0.4;
  constexpr double kDust = 0.03;  // of the largest thing
  constexpr double kMaxCutOff = 4.0;
  const Backdrop backdrop = backdrop_of(scene);
  const auto refused = [](std::string why) { return tl::unexpected(std::move(why)); };
  if (backdrop.spread > kMaxSpread || backdrop.uniform < kMinUniform)
    return refused("its border shows more than one background");
  auto chosen = chosen_of(candidates_in(scene, backdrop), scene.lab.size());
  double largest = 0.0;
  for (const Candidate& c : chosen) largest = std::max(largest, c.rating.area);
  Things out;
  out.small = static_cast<int>(
      std::erase_if(chosen, [&](const Candidate& c) { return c.rating.area < kDust * largest; }));
  if (chosen.empty()) return refused("nothing whole stands out from the background");
  cv::Mat mask(scene.lab.size(), CV_8U, cv::Scalar(0));
  double area = 0.0;
  for (const Candidate& c : chosen) {
    cv::bitwise_or(mask, mask_of(c, mask.size()), mask);
    area += c.rating.area;
  }
  const Rest rest = rest_of(backdrop, mask);
  const bool ragged = chosen.front().rating.round < kRagged && backdrop.spread > kUneven;
  if (chosen.front().score < kMinScore || ragged)
    return refused("no outline in it is clear all the way round");
  if (rest.cuts_into) return refused("what stands out runs over the picture's border");
  if (is_texture(chosen) || area < kMinArea || largest < kMinLargest || rest.whole > kMaxWhole ||
      rest.cut_off > kMaxCutOff)
    return refused("many things stand out, none of them alone");
  for (const Candidate& c : chosen) cut_holes(scene, backdrop, c, mask);
  out.mask = mask;
  out.cut_off = rest.cut_offs;
  return out;
}

bool are_solid(const Scene& scene, const cv::Mat& things) {
  constexpr double kSolid = 0.6;  // of what an outline encloses: a drawn loop encloses background
  const Backdrop backdrop = backdrop_of(scene);
  const Rest rest = rest_of(backdrop, things);
  const cv::Mat off = backdrop.distance > backdrop.tolerance;
  return backdrop.spread < 1.5 && backdrop.uniform > 0.85 && rest.whole + rest.cut_off < 0.15 &&
         cv::countNonZero(off & things) > kSolid * cv::countNonZero(things);
}

}  // namespace telekerf::vision
