// SPDX-License-Identifier: Apache-2.0
#include "common/vision/extraction/thesis_tracker.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "common/geometry/polyline.h"
#include "common/vision/extraction/edge_band.h"

namespace telekerf::vision {
namespace {

constexpr double kStep_px = 1.0;
constexpr double kCoherent = 0.25;   ///< of the structure tensor, 0 isotropic .. 1 one direction
constexpr double kMaxShared = 10.0;  ///< widths: two strokes may run on each other for so long

class Window {
 public:
  Window(const cv::Mat& band, double width, bool is_stroke)
      : band_(band),
        seen_(band.clone()),
        passed_(band.size(), CV_8U, cv::Scalar(0)),
        width_(width),
        radius_(is_stroke ? std::max(3.0, 0.9 * width + 1.0) : 3.5),
        half_(is_stroke ? 0.6 * width + 1.0 : 2.5),
        ahead_(is_stroke ? 0.5 * width : 1.5),
        is_stroke_(is_stroke) {}

  /// Tangent of the band at p, without a sign, and how well it is defined.
  Vec2 tangent(const Vec2& p, double& coherence) const {
    double xx = 0.0;
    double xy = 0.0;
    double yy = 0.0;
    const double reach = radius_ + 1.0;
    const int x0 = static_cast<int>(std::lround(p.x()));
    const int y0 = static_cast<int>(std::lround(p.y()));
    const int r = static_cast<int>(std::ceil(reach));
    for (int y = std::max(1, y0 - r); y <= std::min(seen_.rows - 2, y0 + r); ++y) {
      const auto* up = seen_.ptr<float>(y - 1);
      const auto* row = seen_.ptr<float>(y);
      const auto* down = seen_.ptr<float>(y + 1);
      for (int x = std::max(1, x0 - r); x <= std::min(seen_.cols - 2, x0 + r); ++x) {
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
    const double reach = 1.6 * radius_ + 2.0;
    while (high - first < reach && at(high + kFine) > 0.0F) high += kFine;
    while (first - low < reach && at(low - kFine) > 0.0F) low -= kFine;
    double sum = 0.0;
    double moment = 0.0;
    for (double u = low; u <= high + 1e-9; u += kFine) {
      sum += at(u);
      moment += u * at(u);
    }
    wide = high - low > 1.5 * width_ + 2.0;
    return moment / sum;
  }

  /// A place near the given one where the band is single and runs on to both sides: corners, crossings and
  /// ends are no places to begin at. The tangent there.
  std::pair<Vec2, Vec2> settled(const Vec2& start) const {
    const int reach = static_cast<int>(8.0 * width_) + 10;
    const int x0 = static_cast<int>(start.x());
    const int y0 = static_cast<int>(start.y());
    std::vector<cv::Point> near;
    cv::findNonZero(band_(cv::Rect(x0 - reach, y0 - reach, 2 * reach, 2 * reach) &
                          cv::Rect(0, 0, band_.cols, band_.rows)) > 0.5F,
                    near);
    const Vec2 corner(std::max(0, x0 - reach), std::max(0, y0 - reach));
    const auto distance = [&](const cv::Point& p) { return (corner + Vec2(p.x, p.y) - start).squaredNorm(); };
    std::sort(near.begin(), near.end(),
              [&](const cv::Point& a, const cv::Point& b) { return distance(a) < distance(b); });
    double coherence = 0.0;
    for (const cv::Point& candidate : near) {
      Vec2 p = corner + Vec2(candidate.x, candidate.y);
      Vec2 t = tangent(p, coherence);
      bool single = true;
      for (int i = 0; i < 2 && single; ++i) {  // from the band's rim to its middle
        bool wide = false;
        const auto middle = centre_across(p, Vec2(-t.y(), t.x()), wide);
        single = middle && !wide;
        if (single) p += *middle * Vec2(-t.y(), t.x());
        t = tangent(p, coherence);
      }
      single = single && coherence > 0.6;
      for (const double side : {-1.0, 1.0}) {
        bool wide = false;
        const auto middle = centre_across(p + side * 1.5 * width_ * t, Vec2(-t.y(), t.x()), wide);
        single = single && middle && !wide && std::abs(*middle) < half_;
      }
      if (single) return {p, t};
    }
    return {start, tangent(start, coherence)};
  }

  /// Walks from p along t until the band ends or comes back to its start. `junction` marks what lies within a
  /// crossing, where the band's middle says nothing.
  Route walk(Vec2 p, Vec2 t) {
    Route track;
    std::vector<Vec2>& points = track.points_px;
    const Vec2 start = p;
    const Vec2 start_tangent = t;
    double travelled = 0.0;
    double on_passed = 0.0;  // how far only removed pixels were met
    double in_crossing = 0.0;
    const auto max_points = static_cast<std::size_t>(2 * cv::countNonZero(band_) + 1000);
    const auto add = [&](const Vec2& point) {
      points.push_back(point);
      track.junction.push_back(in_crossing > 0.0);
      remove_behind(points);
      travelled += kStep_px;
      if (hidden_until_ > 0.0 && travelled > hidden_until_) show_all();
    };
    show_all();
    while (points.size() < max_points) {
      add(p);
      double coherence = 0.0;
      Vec2 next = tangent(p, coherence);
      if (next.dot(t) < 0.0) next = -next;
      const bool turns = next.dot(t) < 0.3;  // a direction that jumps belongs to another branch
      if (coherence > kCoherent && !turns && in_crossing <= 0.0)
        t = (t + 0.5 * coherence * (next - t)).normalized();
      const Vec2 q = p + kStep_px * t;
      bool wide = false;
      const auto middle = centre_across(q, Vec2(-t.y(), t.x()), wide);
      if (!middle || weight(p + ahead_ * t) <= 0.0F) {  // a corner, or the end
        hide(points, start_tangent, travelled);
        const auto rest = nearest_rest(p);
        if (!rest) break;
        in_crossing = 0.0;
        // Two sides that grow together before their corner look like a crossing.
        for (std::size_t i = points.size(); i-- > 0 && track.junction[i];) track.junction[i] = false;
        t = (*rest - p).normalized();
        const double length = (*rest - p).norm();
        const Vec2 tip = p;
        for (double s = kStep_px; s < length; s += kStep_px) add(tip + s * t);
        p = *rest;
        continue;
      }
      wide = wide && is_stroke_;
      if (wide && in_crossing <= 0.0) {
        t = direction_before(points, t);
        const auto pulled = std::min(points.size(), static_cast<std::size_t>(radius_));
        std::fill(track.junction.end() - static_cast<std::ptrdiff_t>(pulled), track.junction.end(), true);
      }
      in_crossing = wide ? 1.4 * width_ : in_crossing - kStep_px;
      p = wide ? q : Vec2(q + std::clamp(*middle, -0.7, 0.7) * Vec2(-t.y(), t.x()));
      const Vec2 back = p - start;
      if (travelled > 4.0 * radius_ && std::abs(back.dot(start_tangent)) < 0.6 * kStep_px &&
          std::abs(geometry::cross(start_tangent, back)) < std::max(1.2, 0.35 * width_) &&
          t.dot(start_tangent) > 0.3) {
        track.closed = true;
        break;
      }
      on_passed = passed_at(p) && !wide ? on_passed + kStep_px : 0.0;
      if (on_passed > kMaxShared * width_ + 6.0) {  // back on its own track: that part is no news
        const auto old = static_cast<std::size_t>(on_passed / kStep_px);
        points.resize(points.size() - std::min(points.size() - 1, old));
        track.junction.resize(points.size());
        break;
      }
    }
    return track;
  }

 private:
  float weight(const Vec2& p) const {
    const int x = static_cast<int>(std::floor(p.x()));
    const int y = static_cast<int>(std::floor(p.y()));
    if (x < 0 || y < 0 || x + 1 >= seen_.cols || y + 1 >= seen_.rows) return 0.0F;
    const auto u = static_cast<float>(p.x() - x);
    const auto v = static_cast<float>(p.y() - y);
    const auto* a = seen_.ptr<float>(y) + x;
    const auto* b = seen_.ptr<float>(y + 1) + x;
    const float w = (1 - v) * ((1 - u) * a[0] + u * a[1]) + v * ((1 - u) * b[0] + u * b[1]);
    return w > kFaintWeight ? w : 0.0F;
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
    const double r = is_stroke_ ? half_ : 2.0;
    cv::circle(passed_, {static_cast<int>(std::lround(p.x())), static_cast<int>(std::lround(p.y()))},
               static_cast<int>(std::lround(r)), cv::Scalar(255), -1);
  }

  /// Where the stroke was heading before the other one began to pull at the window.
  Vec2 direction_before(const std::vector<Vec2>& points, const Vec2& t) const {
    const auto skip = static_cast<std::size_t>(radius_ / kStep_px);
    const auto span = static_cast<std::size_t>((1.2 * width_ + 2.0) / kStep_px);
    if (points.size() < skip + span + 1) return t;
    const Vec2 d = points[points.size() - 1 - skip] - points[points.size() - 1 - skip - span];
    return d.norm() > 0.0 ? d.normalized() : t;
  }

  /// Hides the way to a corner, which has grown together with the way on; a short way is continued beyond its
  /// start.
  void hide(const std::vector<Vec2>& points, const Vec2& start_tangent, double travelled) {
    show_all();
    const auto length = static_cast<std::size_t>(8.0 * width_ + 12.0);
    const int r = static_cast<int>(std::lround(half_));
    for (std::size_t i = 0; i < length; ++i) {
      const Vec2 at = i < points.size()
                          ? points[points.size() - 1 - i]
                          : Vec2(points.front() - kStep_px * double(i - points.size()) * start_tangent);
      const cv::Point p(static_cast<int>(std::lround(at.x())), static_cast<int>(std::lround(at.y())));
      cv::circle(seen_, p, r, cv::Scalar(0), -1);
      const cv::Rect here(p.x - r - 1, p.y - r - 1, 2 * r + 3, 2 * r + 3);
      hidden_ = hidden_.empty() ? here : hidden_ | here;
    }
    hidden_ &= cv::Rect(0, 0, band_.cols, band_.rows);
    hidden_until_ = travelled + 6.0 * width_ + 10.0;
  }

  void show_all() {
    if (!hidden_.empty()) band_(hidden_).copyTo(seen_(hidden_));
    hidden_ = {};
    hidden_until_ = 0.0;
  }

  /// The nearest whole piece of band that is neither hidden nor passed, over band only; nothing at a stroke's
  /// end.
  std::optional<Vec2> nearest_rest(const Vec2& tip) const {
    const int reach = static_cast<int>(std::ceil(is_stroke_ ? 5.0 * width_ + 8.0 : 16.0));
    const int x0 = static_cast<int>(std::lround(tip.x())) - reach;
    const int y0 = static_cast<int>(std::lround(tip.y())) - reach;
    const int side = 2 * reach + 1;
    const auto is_band = [&](int x, int y) {
      return x >= 0 && y >= 0 && x < band_.cols && y < band_.rows && band_.at<float>(y, x) > kFaintWeight;
    };
    const auto is_rest = [&](int x, int y) {
      return is_band(x, y) && seen_.at<float>(y, x) > 0.0F && passed_.at<unsigned char>(y, x) == 0;
    };
    const int core = is_stroke_ ? std::max(1, static_cast<int>(width_ / 4.0)) : 1;
    std::vector<bool> met(static_cast<std::size_t>(side) * side, false);
    std::vector<cv::Point> front;
    const auto meet = [&](int x, int y) {
      if (x < x0 || y < y0 || x >= x0 + side || y >= y0 + side || !is_band(x, y)) return;
      const auto at = static_cast<std::size_t>(y - y0) * side + (x - x0);
      if (met[at]) return;
      met[at] = true;
      front.emplace_back(x, y);
    };
    for (int dy = -2; dy <= 2; ++dy) {
      for (int dx = -2; dx <= 2; ++dx) meet(x0 + reach + dx, y0 + reach + dy);
    }
    for (std::size_t i = 0; i < front.size(); ++i) {
      const cv::Point p = front[i];
      if (is_rest(p.x, p.y) && is_rest(p.x + core, p.y) && is_rest(p.x - core, p.y) &&
          is_rest(p.x, p.y + core) && is_rest(p.x, p.y - core)) {
        return Vec2(p.x, p.y);
      }
      for (int k = 0; k < 4; ++k) meet(p.x + (k == 0) - (k == 1), p.y + (k == 2) - (k == 3));
    }
    return std::nullopt;
  }

  const cv::Mat& band_;
  cv::Mat seen_;    ///< the band without what is hidden
  cv::Mat passed_;  ///< 255 where the window has been
  cv::Rect hidden_;
  double hidden_until_ = 0.0;  ///< distance travelled
  double width_;
  double radius_;
  double half_;   ///< the band lies within this of its middle
  double ahead_;  ///< a band that ends within this has a corner or an end here
  bool is_stroke_;
};

}  // namespace

Route follow_band(const cv::Mat& band, const cv::Point& start, double band_width_px, bool is_stroke) {
  Window window(band, band_width_px, is_stroke);
  const auto [p, t] = window.settled(Vec2(start.x, start.y));
  Route route = window.walk(p, t);
  if (!route.closed) {
    Route before = window.walk(p, -t);
    std::reverse(before.points_px.begin(), before.points_px.end());
    std::reverse(before.junction.begin(), before.junction.end());
    before.points_px.pop_back();
    before.junction.pop_back();
    route.points_px.insert(route.points_px.begin(), before.points_px.begin(), before.points_px.end());
    route.junction.insert(route.junction.begin(), before.junction.begin(), before.junction.end());
    // A window that began in a sharp corner stops beside its start.
    const auto& q = route.points_px;
    route.closed =
        q.size() > 60 && (q.front() - q.back()).norm() < (is_stroke ? 1.5 : 1.0) * band_width_px + 2.0;
  }
  route.from_end = route.to_end = !route.closed;
  return route;
}

}  // namespace telekerf::vision
