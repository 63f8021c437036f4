// SPDX-License-Identifier: Apache-2.0
#include "common/vision/thesis_tracker.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "common/vision/strokes.h"

namespace telekerf::vision {
namespace {

constexpr double kStep = 1.0;
constexpr double kCoherent = 0.25;  ///< of the structure tensor, 0 isotropic .. 1 one direction
constexpr float kFaint = 0.08F;     ///< weights below this share of the largest are background

class Window {
 public:
  Window(const cv::Mat& band, double width, bool is_stroke)
      : band_(band),
        passed_(band.size(), CV_8U, cv::Scalar(0)),
        width_(width),
        radius_(is_stroke ? std::max(3.0, 0.9 * width + 1.0) : 3.5),
        is_stroke_(is_stroke) {}

  struct Track {
    std::vector<Vec2> points;
    std::vector<bool> crossing;  ///< within a crossing, where the band's middle says nothing
    bool closed = false;
  };

  /// Tangent of the band at p, without a sign, and how well it is defined.
  Vec2 tangent(const Vec2& p, double& coherence) const {
    double xx = 0.0;
    double xy = 0.0;
    double yy = 0.0;
    const double reach = radius_ + 1.0;
    const int x0 = static_cast<int>(std::lround(p.x()));
    const int y0 = static_cast<int>(std::lround(p.y()));
    const int r = static_cast<int>(std::ceil(reach));
    for (int y = std::max(1, y0 - r); y <= std::min(band_.rows - 2, y0 + r); ++y) {
      const auto* up = band_.ptr<float>(y - 1);
      const auto* row = band_.ptr<float>(y);
      const auto* down = band_.ptr<float>(y + 1);
      for (int x = std::max(1, x0 - r); x <= std::min(band_.cols - 2, x0 + r); ++x) {
        const double d2 = (Vec2(x, y) - p).squaredNorm();
        if (d2 > reach * reach) continue;
        const double w = std::exp(-d2 / (0.5 * reach * reach));
        const double gx = row[x + 1] - row[x - 1];
        const double gy = down[x] - up[x];
        xx += w * gx * gx;
        xy += w * gx * gy;
        yy += w * gy * gy;
      }
    }
    const double sum = xx + yy;
    const double difference = std::hypot(xx - yy, 2.0 * xy);
    coherence = sum > 0.0 ? difference / sum : 0.0;
    const double across = 0.5 * std::atan2(2.0 * xy, xx - yy);  // eigenvector of the largest eigenvalue
    return {-std::sin(across), std::cos(across)};
  }

  /// Middle of the band on the line across at q; nothing where there is no band, `wide` where it is more than
  /// one.
  std::optional<double> centre_across(const Vec2& q, const Vec2& normal, bool& wide) const {
    constexpr double kFine = 0.5;
    const auto at = [&](double u) { return weight(q + u * normal); };
    double first = 0.0;
    while (at(first) <= 0.0F) {  // the nearest band to either side
      first = first > 0.0 ? -first : -first + kFine;
      if (std::abs(first) > radius_) return std::nullopt;
    }
    double low = first;
    double high = first;
    const double most = 1.6 * radius_ + 2.0;
    while (high - first < most && at(high + kFine) > 0.0F) high += kFine;
    while (first - low < most && at(low - kFine) > 0.0F) low -= kFine;
    double sum = 0.0;
    double moment = 0.0;
    for (double u = low; u <= high + 1e-9; u += kFine) {
      sum += at(u);
      moment += u * at(u);
    }
    wide = high - low > 1.5 * width_ + 2.0;
    return moment / sum;
  }

  /// Walks from p along t until the band ends or comes back to its start.
  Track walk(Vec2 p, Vec2 t) {
    Track track;
    const Vec2 start = p;
    const Vec2 start_tangent = t;
    double travelled = 0.0;
    double on_passed = 0.0;  // how far only removed pixels were met
    double in_crossing = 0.0;
    const auto most = static_cast<std::size_t>(4 * cv::countNonZero(band_) + 1000);
    while (track.points.size() < most) {
      track.points.push_back(p);
      track.crossing.push_back(in_crossing > 0.0);
      remove_behind(track.points);
      double coherence = 0.0;
      Vec2 next = tangent(p, coherence);
      if (next.dot(t) < 0.0) next = -next;
      const bool turns = next.dot(t) < 0.3;  // a direction that jumps belongs to another branch
      if (coherence > kCoherent && !turns && in_crossing <= 0.0)
        t = (t + 0.5 * coherence * (next - t)).normalized();
      const Vec2 q = p + kStep * t;
      bool wide = false;
      const auto middle = centre_across(q, Vec2(-t.y(), t.x()), wide);
      if (!middle) {
        const auto corner = turn_towards_rest(track.points, t);
        if (!corner) break;
        t = *corner;
        p += kStep * t;
        travelled += kStep;
        continue;
      }
      wide = wide && is_stroke_;
      if (wide && in_crossing <= 0.0) {
        t = direction_before(track.points, t);
        const auto pulled = std::min(track.crossing.size(), static_cast<std::size_t>(radius_));
        std::fill(track.crossing.end() - static_cast<std::ptrdiff_t>(pulled), track.crossing.end(), true);
      }
      in_crossing = wide ? 1.4 * width_ : in_crossing - kStep;
      p = wide ? q : Vec2(q + std::clamp(*middle, -0.7, 0.7) * Vec2(-t.y(), t.x()));
      travelled += kStep;
      if (travelled > 4.0 * radius_ && (p - start).norm() < 1.2 * kStep && t.dot(start_tangent) > 0.3) {
        track.closed = true;
        break;
      }
      on_passed = passed_at(p) && !wide ? on_passed + kStep : 0.0;
      if (on_passed > 3.0 * width_ + 6.0) {  // back on its own track: that part is no news
        const auto old = static_cast<std::size_t>(on_passed / kStep);
        track.points.resize(track.points.size() - std::min(track.points.size() - 1, old));
        track.crossing.resize(track.points.size());
        break;
      }
    }
    return track;
  }

 private:
  float weight(const Vec2& p) const {
    const int x = static_cast<int>(std::floor(p.x()));
    const int y = static_cast<int>(std::floor(p.y()));
    if (x < 0 || y < 0 || x + 1 >= band_.cols || y + 1 >= band_.rows) return 0.0F;
    const auto u = static_cast<float>(p.x() - x);
    const auto v = static_cast<float>(p.y() - y);
    const auto* a = band_.ptr<float>(y) + x;
    const auto* b = band_.ptr<float>(y + 1) + x;
    const float w = (1 - v) * ((1 - u) * a[0] + u * a[1]) + v * ((1 - u) * b[0] + u * b[1]);
    return w > kFaint ? w : 0.0F;
  }

  bool passed_at(const Vec2& p) const {
    const int x = static_cast<int>(std::lround(p.x()));
    const int y = static_cast<int>(std::lround(p.y()));
    return x >= 0 && y >= 0 && x < passed_.cols && y < passed_.rows && passed_.at<unsigned char>(y, x) != 0;
  }

  /// Removes the window's middle, one window behind the present point (so that it never stands on its own
  /// trace).
  void remove_behind(const std::vector<Vec2>& points) {
    const auto lag = static_cast<std::size_t>(std::ceil(2.0 * radius_));
    if (points.size() <= lag) return;
    const Vec2& p = points[points.size() - 1 - lag];
    const double r = is_stroke_ ? 0.6 * width_ + 1.0 : 2.0;
    cv::circle(passed_, {static_cast<int>(std::lround(p.x())), static_cast<int>(std::lround(p.y()))},
               static_cast<int>(std::lround(r)), cv::Scalar(255), -1);
  }

  /// Where the stroke was heading before the other one began to pull at the window.
  Vec2 direction_before(const std::vector<Vec2>& points, const Vec2& t) const {
    const auto skip = static_cast<std::size_t>(radius_ / kStep);
    const auto span = static_cast<std::size_t>((1.2 * width_ + 2.0) / kStep);
    if (points.size() < skip + span + 1) return t;
    const Vec2 d = points[points.size() - 1 - skip] - points[points.size() - 1 - skip - span];
    return d.norm() > 0.0 ? d.normalized() : t;
  }

  /// A straight way over the band, passed or not: what lies beyond a gap is another stroke.
  bool ink_between(const Vec2& a, const Vec2& b) const {
    const double length = (b - a).norm();
    for (double t = 2.0; t < length; t += 1.0) {
      if (weight(a + t / length * (b - a)) <= 0.0F) return false;
    }
    return true;
  }

  /// Direction to the band that is left around the last point, after a corner; nothing when it is all passed.
  std::optional<Vec2> turn_towards_rest(const std::vector<Vec2>& points, const Vec2& t) const {
    const Vec2& p = points.back();
    const double reach = is_stroke_ ? 3.5 * radius_ + 4.0 : 2.2 * radius_ + 2.0;
    const double beside = is_stroke_ ? 0.6 * width_ + 1.0 : 2.5;  // of its own trace
    const auto trace = std::min(points.size(), static_cast<std::size_t>(4.0 * radius_ + 8.0));
    Vec2 sum = Vec2::Zero();
    const int r = static_cast<int>(std::ceil(reach));
    const int x0 = static_cast<int>(std::lround(p.x()));
    const int y0 = static_cast<int>(std::lround(p.y()));
    double total = 0.0;
    for (int y = std::max(0, y0 - r); y <= std::min(band_.rows - 1, y0 + r); ++y) {
      for (int x = std::max(0, x0 - r); x <= std::min(band_.cols - 1, x0 + r); ++x) {
        const Vec2 d = Vec2(x, y) - p;
        if (d.norm() > reach || d.norm() < 0.9 * radius_ || d.dot(t) < -0.95 * d.norm()) continue;
        if (passed_.at<unsigned char>(y, x) != 0 || band_.at<float>(y, x) <= kFaint) continue;
        bool own = false;
        for (std::size_t k = points.size() - trace; k + 1 < points.size() && !own; ++k) {
          own = (Vec2(x, y) - points[k]).squaredNorm() < beside * beside;
        }
        if (own || !ink_between(p, Vec2(x, y))) continue;
        sum += band_.at<float>(y, x) * d;
        total += band_.at<float>(y, x);
      }
    }
    if (total < 2.0 || sum.norm() < 0.2 * total * radius_) return std::nullopt;
    return sum.normalized();
  }

  const cv::Mat& band_;
  cv::Mat passed_;
  double width_;
  double radius_;
  bool is_stroke_;
};

}  // namespace

cv::Mat edge_band(const Field& field, double stroke_width_px, bool is_stroke) {
  // Sobel's gain is 8; a border blurred by sigma s has the slope contrast / (2.5 s).
  const double strong = 8.0 * field.contrast / (2.5 * std::hypot(field.sigma_px, 1.0));
  cv::Mat edges;
  cv::Canny(field.smooth, edges, 0.15 * strong, 0.35 * strong, 3, true);
  int size = 3;
  if (is_stroke) size = 2 * (static_cast<int>(std::ceil(0.5 * stroke_width_px)) + 1) + 1;
  const cv::Mat kernel = cv::getStructuringElement(cv::MORPH_ELLIPSE, {size, size});
  cv::Mat closed;
  cv::copyMakeBorder(edges, closed, size, size, size, size, cv::BORDER_CONSTANT, cv::Scalar(0));
  cv::dilate(closed, closed, kernel);
  cv::erode(closed, closed, kernel);
  closed = closed(cv::Rect(size, size, edges.cols, edges.rows)).clone();

  cv::Mat weights;
  if (is_stroke) {
    field.smooth.convertTo(weights, CV_32F, (field.dark ? -1.0 : 1.0) / (0.5 * field.contrast),
                           (field.dark ? 1.0 : -1.0) * field.level / (0.5 * field.contrast));
    weights = cv::min(cv::max(weights, 0.0), 1.0);
  } else {
    cv::Mat gx;
    cv::Mat gy;
    cv::Sobel(field.smooth, gx, CV_32F, 1, 0);
    cv::Sobel(field.smooth, gy, CV_32F, 0, 1);
    cv::magnitude(gx, gy, weights);
    weights /= strong;
    cv::dilate(closed, closed, cv::Mat());  // the ridge's flanks, for a centroid finer than a pixel
  }
  cv::Mat band(weights.size(), CV_32F, cv::Scalar(0));
  weights.copyTo(band, closed);
  return band;
}

std::optional<cv::Point> first_in_evolving_square(const cv::Mat& band) {
  const int rings = (std::min(band.cols, band.rows) + 1) / 2;
  for (int k = 0; k < rings; ++k) {
    const int right = band.cols - 1 - k;
    const int bottom = band.rows - 1 - k;
    for (int x = k; x <= right; ++x) {
      for (const int y : {k, bottom}) {
        if (band.at<float>(y, x) > kFaint) return cv::Point(x, y);
      }
    }
    for (int y = k; y <= bottom; ++y) {
      for (const int x : {k, right}) {
        if (band.at<float>(y, x) > kFaint) return cv::Point(x, y);
      }
    }
  }
  return std::nullopt;
}

PixelContour follow_band(const cv::Mat& band, const cv::Point& start, double band_width_px, bool is_stroke) {
  PixelContour out;
  out.closed = false;
  out.width_px = is_stroke ? band_width_px : 0.0;
  Window window(band, band_width_px, is_stroke);
  // From the band's rim to its middle.
  Vec2 p(start.x, start.y);
  Vec2 t;
  for (int i = 0; i < 4; ++i) {
    double coherence = 0.0;
    t = window.tangent(p, coherence);
    bool wide = false;
    const Vec2 normal(-t.y(), t.x());
    if (const auto middle = window.centre_across(p, normal, wide)) p += *middle * normal;
  }
  auto forwards = window.walk(p, t);
  out.closed = forwards.closed;
  if (forwards.closed) {
    bridge(forwards.points, forwards.crossing, true);
  } else {
    auto backwards = window.walk(p, -t);
    std::reverse(backwards.points.begin(), backwards.points.end());
    std::reverse(backwards.crossing.begin(), backwards.crossing.end());
    if (!backwards.points.empty()) backwards.points.pop_back();
    backwards.crossing.resize(backwards.points.size());
    backwards.points.insert(backwards.points.end(), forwards.points.begin(), forwards.points.end());
    backwards.crossing.insert(backwards.crossing.end(), forwards.crossing.begin(), forwards.crossing.end());
    forwards = std::move(backwards);
    bridge(forwards.points, forwards.crossing, false);
    // The window runs to the end of the ink, the pen's middle stopped half a width before.
    const auto half = is_stroke ? static_cast<std::size_t>(std::lround(0.45 * band_width_px / kStep)) : 0;
    if (forwards.points.size() > 4 * half + 8) {
      forwards.points.erase(forwards.points.begin(), forwards.points.begin() + half);
      forwards.points.resize(forwards.points.size() - half);
    }
  }
  out.points_px = std::move(forwards.points);
  if (!out.closed && is_stroke && out.points_px.size() > 60) {
    // A window that began in a sharp corner stops beside its start.
    out.closed = (out.points_px.front() - out.points_px.back()).norm() < 1.5 * band_width_px + 2.0;
  }
  return out;
}

}  // namespace telekerf::vision
