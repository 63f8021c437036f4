// SPDX-License-Identifier: Apache-2.0
#include "common/vision/segmentation/pointed.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <optional>

#include "common/vision/segmentation/judging.h"
#include "common/vision/segmentation/rating.h"

namespace telekerf::vision {
namespace {

using Points = std::vector<cv::Point>;

struct PointedCandidate {
  cv::Mat mask;
  double score = 0.0;
};

Points in_scene(const Scene& scene, const std::vector<Vec2>& points) {
  Points out;
  for (const Vec2& p : points) {
    const Vec2 q = scene.to_scene(p);
    out.emplace_back(std::clamp(static_cast<int>(std::lround(q.x())), 0, scene.lab.cols - 1),
                     std::clamp(static_cast<int>(std::lround(q.y())), 0, scene.lab.rows - 1));
  }
  return out;
}

class Search {
 public:
  Search(const Scene& scene, Points at, Points away)
      : scene_(scene), at_(std::move(at)), away_(std::move(away)), backdrop_(backdrop_of(scene)) {}

  /// The best region that holds the points, found in several ways.
  PointedCandidate best() {
    by_level(backdrop_.distance, false);
    by_level(distance_from_seeds(), true);
    const PointedCandidate first = best_;
    if (first.score > 0.0) consider(refined(first.mask));
    for (const double share : {0.22, 0.4, 0.65, 0.95}) {
      const cv::Rect box = around_points(share);
      consider(cut_out(box), box);
    }
    if (best_.score > 0.0) consider(grown(best_.mask), room_round(best_.mask));
    if (best_.score > 0.0) consider(refined(best_.mask));
    return best_;
  }

  PointedCandidate in_box(const cv::Rect& box) {
    cv::Mat labels(scene_.lab.size(), CV_8U, cv::Scalar(cv::GC_BGD));
    labels(box).setTo(cv::GC_PR_FGD);
    const cv::Mat cut = grab_cut(labels, 5);
    // All parts of a fair size are the thing, or things.
    const auto parts = outlines_of_mask(cut, 0.02 * box.area());
    PointedCandidate out{cv::Mat(cut.size(), CV_8U, cv::Scalar(0)), 0.0};
    for (std::size_t i = 0; i < parts.size(); ++i) {
      cv::drawContours(out.mask, parts, static_cast<int>(i), cv::Scalar(255), cv::FILLED);
    }
    out.score = score_of(out.mask);
    return out;
  }

 private:
  double score_of(const cv::Mat& mask) const {
    double sum = 0.0;
    double total = 0.0;
    for (const auto& outline : outlines_of_mask(mask, 12.0)) {
      const Rating rating = rating_of(scene_, outline);
      const double weight = std::sqrt(rating.area);
      sum += weight * rating.score();
      total += weight;
    }
    return total > 0.0 ? sum / total : 0.0;
  }

  /// Ends where the search did: along the sides of the box that it was looked for in.
  bool is_cut_by(const cv::Rect& box, const cv::Mat& mask) const {
    constexpr double kAlong = 0.25;  // of the outline
    constexpr int kRim = 4;          // of the picture: there the thing may end
    const cv::Rect own(kRim, kRim, mask.cols - 2 * kRim, mask.rows - 2 * kRim);
    std::size_t along = 0;
    std::size_t all = 0;
    for (const auto& outline : outlines_of_mask(mask, 12.0)) {
      for (const cv::Point& p : outline) {
        const bool at_side = p.x <= box.x + 1 || p.y <= box.y + 1 || p.x >= box.x + box.width - 2 ||
                             p.y >= box.y + box.height - 2;
        along += at_side && own.contains(p);
      }
      all += outline.size();
    }
    return static_cast<double>(along) > kAlong * static_cast<double>(all);
  }

  /// `box`: where it was looked for, if not everywhere.
  void consider(const cv::Mat& mask, const std::optional<cv::Rect>& box = std::nullopt) {
    if (mask.empty()) return;
    const cv::Mat parts = parts_holding(mask, at_);
    if (box && is_cut_by(*box, parts)) return;
    for (const cv::Point& p : at_) {
      if (parts.at<unsigned char>(p) == 0) return;
    }
    for (const cv::Point& p : away_) {
      if (parts.at<unsigned char>(p) != 0) return;
    }
    if (cv::countNonZero(parts) > 0.85 * static_cast<double>(parts.total())) return;
    const double score = score_of(parts);
    if (score > best_.score) best_ = {parts, score};
  }

  /// Regions that lie further off the background than each of several levels; or nearer to the seeds'
  /// colours.
  void by_level(const cv::Mat& distance, bool below) {
    constexpr double kStep = 1.2;
    double largest = 0.0;
    cv::minMaxLoc(distance, nullptr, &largest);
    const cv::Mat three = cv::getStructuringElement(cv::MORPH_ELLIPSE, {3, 3});
    const cv::Mat five = cv::getStructuringElement(cv::MORPH_ELLIPSE, {5, 5});
    for (double level = 3.0; level < largest; level *= kStep) {
      cv::Mat mask = below ? distance < level : distance > level;
      cv::morphologyEx(mask, mask, cv::MORPH_OPEN, three);
      cv::morphologyEx(mask, mask, cv::MORPH_CLOSE, five);
      consider(mask);
    }
  }

  cv::Mat distance_from_seeds() const {
    constexpr int kPatch = 3;
    cv::Mat out(scene_.lab.size(), CV_32F, cv::Scalar(1e3));
    for (const cv::Point& p : at_) {
      const cv::Rect patch = cv::Rect(p.x - kPatch, p.y - kPatch, 2 * kPatch + 1, 2 * kPatch + 1) &
                             cv::Rect({}, scene_.lab.size());
      const cv::Scalar colour = cv::mean(scene_.lab(patch));
      for (int y = 0; y < out.rows; ++y) {
        for (int x = 0; x < out.cols; ++x) {
          const auto& c = scene_.lab.at<cv::Vec3f>(y, x);
          // Brightness changes over a thing more than its colour does.
          const double d = std::hypot(0.6 * (c[0] - colour[0]), c[1] - colour[1], c[2] - colour[2]);
          out.at<float>(y, x) = std::min(out.at<float>(y, x), static_cast<float>(d));
        }
      }
    }
    return out;
  }

  cv::Rect around_points(double share) const {
    const cv::Rect held = cv::boundingRect(at_);
    const int wide = held.width + static_cast<int>(share * scene_.lab.cols);
    const int high = held.height + static_cast<int>(share * scene_.lab.rows);
    const cv::Point middle = held.tl() + cv::Point(held.width / 2, held.height / 2);
    return cv::Rect(middle.x - wide / 2, middle.y - high / 2, wide, high) &
           cv::Rect(2, 2, scene_.lab.cols - 4, scene_.lab.rows - 4);
  }

  cv::Mat cut_out(const cv::Rect& box) {
    if (box.area() < 64) return {};
    cv::Mat labels(scene_.lab.size(), CV_8U, cv::Scalar(cv::GC_BGD));
    labels(box).setTo(cv::GC_PR_FGD);
    return grab_cut(labels, 4);
  }

  static cv::Rect room_round(const cv::Mat& mask) {
    const cv::Rect held = cv::boundingRect(mask);
    return cv::Rect(held.x - held.width / 2, held.y - held.height / 2, 2 * held.width, 2 * held.height) &
           cv::Rect({}, mask.size());
  }

  /// What belongs to a known region's colours round it: a tail, a handle.
  cv::Mat grown(const cv::Mat& mask) {
    const cv::Rect held = cv::boundingRect(mask);
    const cv::Rect box = room_round(mask);
    const int rim = std::max(2, std::min(held.width, held.height) / 15);
    cv::Mat inner;
    cv::erode(mask, inner, cv::getStructuringElement(cv::MORPH_ELLIPSE, {2 * rim + 1, 2 * rim + 1}));
    cv::Mat labels(mask.size(), CV_8U, cv::Scalar(cv::GC_BGD));
    labels(box).setTo(cv::GC_PR_BGD);
    labels.setTo(cv::GC_PR_FGD, mask);
    labels.setTo(cv::GC_FGD, inner);
    return grab_cut(labels, 3);
  }

  /// A known region, its rim free to move.
  cv::Mat refined(const cv::Mat& mask) {
    const int reach = std::max(3, static_cast<int>(0.12 * std::sqrt(cv::countNonZero(mask))));
    const cv::Mat kernel = cv::getStructuringElement(cv::MORPH_ELLIPSE, {2 * reach + 1, 2 * reach + 1});
    cv::Mat inner;
    cv::Mat outer;
    cv::erode(mask, inner, kernel);
    cv::dilate(mask, outer, kernel);
    cv::Mat labels(mask.size(), CV_8U, cv::Scalar(cv::GC_BGD));
    labels.setTo(cv::GC_PR_BGD, outer);
    labels.setTo(cv::GC_PR_FGD, mask);
    labels.setTo(cv::GC_FGD, inner);
    return grab_cut(labels, 2);
  }

  cv::Mat grab_cut(cv::Mat& labels, int rounds) {
    constexpr int kSeed = 2;
    for (const cv::Point& p : at_) cv::circle(labels, p, kSeed, cv::Scalar(cv::GC_FGD), cv::FILLED);
    for (const cv::Point& p : away_) cv::circle(labels, p, kSeed, cv::Scalar(cv::GC_BGD), cv::FILLED);
    const auto count = [&](int a, int b) {
      return cv::countNonZero(labels == a) + cv::countNonZero(labels == b);
    };
    if (count(cv::GC_BGD, cv::GC_PR_BGD) < 16 || count(cv::GC_FGD, cv::GC_PR_FGD) < 16) return {};
    cv::Mat background;
    cv::Mat foreground;
    cv::theRNG().state = 1;  // the same picture gives the same cut
    cv::grabCut(scene_.bgr, labels, {}, background, foreground, rounds, cv::GC_INIT_WITH_MASK);
    cv::Mat out = (labels & 1) * 255;
    cv::morphologyEx(out, out, cv::MORPH_OPEN, cv::getStructuringElement(cv::MORPH_ELLIPSE, {3, 3}));
    return out;
  }

  const Scene& scene_;
  Points at_;
  Points away_;
  Backdrop backdrop_;
  PointedCandidate best_;
};

}  // namespace

tl::expected<cv::Mat, std::string> pointed_at(const Scene& scene, const Pointing& pointing) {
  constexpr double kMinScore = 2.4;
  const auto refused = [](const char* why) {
    return tl::unexpected(
        fmt::format("{}; give --box X,Y,WIDTH,HEIGHT around the thing, more points of it (--at), or points "
                    "beside it (--not)",
                    why));
  };
  Search search(scene, in_scene(scene, pointing.at), in_scene(scene, pointing.away));
  PointedCandidate found;
  if (pointing.box) {
    const Vec2 first = scene.to_scene(pointing.box->head<2>());
    const Vec2 last = scene.to_scene(pointing.box->head<2>() + pointing.box->tail<2>());
    const cv::Rect box =
        cv::Rect(
            cv::Point(static_cast<int>(std::lround(first.x())), static_cast<int>(std::lround(first.y()))),
            cv::Point(static_cast<int>(std::lround(last.x())), static_cast<int>(std::lround(last.y())))) &
        cv::Rect({}, scene.lab.size());
    if (box.width < 6 || box.height < 6)
      return tl::unexpected<std::string>(
          "--box holds next to nothing of the picture; give X,Y,WIDTH,HEIGHT in pixels");
    found = search.in_box(box);
  } else {
    found = search.best();
  }
  if (found.score < kMinScore)
    return refused("no region with an outline of its own is found where --at or --box points");
  if (const char* why = why_no_thing(scene, found.mask)) return refused(why);
  return found.mask;
}

}  // namespace telekerf::vision
