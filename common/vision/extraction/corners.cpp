// SPDX-License-Identifier: Apache-2.0
#include "common/vision/extraction/corners.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "common/geometry/circle_fit.h"

namespace telekerf::vision {
namespace {

constexpr double kStraight_px = 0.3;
constexpr double kRightAngle_rad = 1.4;  ///< about

struct Corner {
  std::ptrdiff_t first = 0;  ///< points from here
  std::ptrdiff_t last = 0;   ///< to here give way to
  Vec2 at;
  /// Each side leaves its last good point as it came there and bends to the corner. Unset: straight.
  std::optional<Vec2> control_before = std::nullopt;
  std::optional<Vec2> control_after = std::nullopt;
};

class Sharpener {
 public:
  Sharpener(const std::vector<Vec2>& points, bool closed, const CornerRule& rule)
      : p_(points), closed_(closed), rule_(rule), n_(static_cast<std::ptrdiff_t>(points.size())) {}

  std::vector<Corner> corners() const {
    if (n_ == 0) return {};
    const auto k = static_cast<std::ptrdiff_t>(std::lround(rule_.rounded_px));
    std::vector<double> turns(p_.size(), 0.0);
    for (std::ptrdiff_t i = 0; i < n_; ++i) {
      if (!closed_ && (i < k || i + k >= n_)) continue;
      turns[i] = std::abs(turn(at(i) - at(i - k), at(i + k) - at(i)));
    }
    std::vector<std::ptrdiff_t> peaks;
    for (std::ptrdiff_t i = 0; i < n_; ++i) {
      if (turns[i] < rule_.min_turn_rad) continue;
      bool peak = true;
      for (std::ptrdiff_t j = -k; j <= k && peak; ++j) {
        const double other = turns[wrapped(i + j)];
        peak = other < turns[i] || (other == turns[i] && j >= 0);
      }
      if (peak) peaks.push_back(i);
    }
    std::vector<Corner> out;
    for (std::size_t i = 0; i < peaks.size(); ++i) {
      const std::ptrdiff_t before = i > 0 ? peaks[i] - peaks[i - 1] : gap_round(peaks);
      const std::ptrdiff_t after = i + 1 < peaks.size() ? peaks[i + 1] - peaks[i] : gap_round(peaks);
      if (const auto corner = corner_at(peaks[i], before, after)) {
        if (out.empty() || corner->first > out.back().last) out.push_back(*corner);
      }
    }
    if (out.size() > 1 && out.back().last - n_ >= out.front().first - 1) out.pop_back();
    return out;
  }

 private:
  std::ptrdiff_t wrapped(std::ptrdiff_t i) const {
    return closed_ ? ((i % n_) + n_) % n_ : std::clamp<std::ptrdiff_t>(i, 0, n_ - 1);
  }
  const Vec2& at(std::ptrdiff_t i) const { return p_[wrapped(i)]; }
  static double turn(const Vec2& a, const Vec2& b) { return std::atan2(geometry::cross(a, b), a.dot(b)); }
  std::ptrdiff_t gap_round(const std::vector<std::ptrdiff_t>& peaks) const {
    return closed_ && peaks.size() > 1 ? peaks.front() + n_ - peaks.back() : n_;
  }

  /// The straight line through the side that begins `from` points away and ends before the next corner's
  /// middle.
  std::optional<geometry::CircleOrLine> side(std::ptrdiff_t corner, int direction, std::ptrdiff_t room,
                                             std::ptrdiff_t skip) const {
    auto count = static_cast<std::ptrdiff_t>(std::lround(rule_.side_px));
    count = std::min(count, std::max<std::ptrdiff_t>(room - 2 * skip + 1, 3));
    if (room < skip + 3 || (!closed_ && (corner + direction * (skip + count) < 0 ||
                                         corner + direction * (skip + count) >= n_))) {
      return std::nullopt;
    }
    // Mean and direction; three points and more.
    Vec2 mean = Vec2::Zero();
    for (std::ptrdiff_t i = 0; i < count; ++i)
      mean += at(corner + direction * (skip + i)) / static_cast<double>(count);
    Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();
    for (std::ptrdiff_t i = 0; i < count; ++i) {
      const Vec2 d = at(corner + direction * (skip + i)) - mean;
      spread += d * d.transpose();
    }
    const double angle = 0.5 * std::atan2(2.0 * spread(0, 1), spread(0, 0) - spread(1, 1));
    geometry::CircleOrLine line;
    line.point_m = mean;
    line.direction = Vec2(std::cos(angle), std::sin(angle));
    const Vec2 towards = at(corner + direction * skip) - at(corner + direction * (skip + count - 1));
    if (line.direction.dot(towards) < 0.0) line.direction = -line.direction;  // towards the corner
    double squares = 0.0;
    for (std::ptrdiff_t i = 0; i < count; ++i) {
      squares += std::pow(line.phi(at(corner + direction * (skip + i))), 2) / static_cast<double>(count);
    }
    if (std::sqrt(squares) > kStraight_px) return std::nullopt;
    return line;
  }

  std::optional<Corner> corner_at(std::ptrdiff_t i, std::ptrdiff_t before, std::ptrdiff_t after) const {
    const auto skip = static_cast<std::ptrdiff_t>(std::lround(rule_.rounded_px));
    // Sides of a very sharp corner have grown together; those of a wide one with a bent side only say less.
    const double sharpness = tip_turn(i, before, after, skip);
    const auto crossing = crossing_at(i, before, after, skip);
    return crossing || sharpness < kRightAngle_rad ? crossing : tip_at(i, before, after, skip);
  }

  /// Turn between the sides some way off the corner; 0 where there is no room or no rule for tips.
  double tip_turn(std::ptrdiff_t i, std::ptrdiff_t before, std::ptrdiff_t after, std::ptrdiff_t skip) const {
    if (!rule_.tip || std::min(before, after) <= 2 * skip) return 0.0;
    if (!closed_ && (i <= 2 * skip || i + 2 * skip >= n_)) return 0.0;
    return std::abs(turn(at(i - skip / 2) - at(i - 2 * skip), at(i + 2 * skip) - at(i + skip / 2)));
  }

  std::optional<Corner> tip_at(std::ptrdiff_t i, std::ptrdiff_t before, std::ptrdiff_t after,
                               std::ptrdiff_t skip) const {
    const Vec2 in = at(i - skip / 2) - at(i - 2 * skip);
    const Vec2 out = at(i + 2 * skip) - at(i + skip / 2);
    const auto tip = rule_.tip(at(i), (in.normalized() - out.normalized()).normalized());
    if (!tip || (*tip - at(i)).norm() < 0.3) return std::nullopt;
    const std::ptrdiff_t a = apart(i, -1, before, skip);
    const std::ptrdiff_t b = apart(i, +1, after, skip);
    return Corner{i - a + 1, i + b - 1, *tip, control(i, -a, *tip), control(i, b, *tip)};
  }

  /// How far from a sharp corner the two sides' ink has come apart: between there and the corner, the middle
  /// of the ink is the middle of neither.
  std::ptrdiff_t apart(std::ptrdiff_t i, std::ptrdiff_t direction, std::ptrdiff_t room,
                       std::ptrdiff_t skip) const {
    constexpr std::ptrdiff_t kSure = 3;
    const std::ptrdiff_t nearest = skip / 2 + 1;
    std::ptrdiff_t sure = 0;
    for (std::ptrdiff_t k = nearest; k < std::min(4 * skip, room / 2); ++k) {
      const std::ptrdiff_t j = i + direction * k;
      if (!closed_ && (j < 6 || j + 6 >= n_)) break;
      sure = rule_.single(at(j), at(j + 3) - at(j - 3)) ? sure + 1 : 0;
      if (sure == kSure) return k;
    }
    return nearest;
  }

  /// Half way from a side's last good point to the corner, in the direction of that side.
  Vec2 control(std::ptrdiff_t i, std::ptrdiff_t offset, const Vec2& corner) const {
    constexpr std::ptrdiff_t kBase = 5;
    const Vec2& from = at(i + offset);
    const Vec2 direction = (from - at(i + offset + (offset < 0 ? -kBase : kBase))).normalized();
    return from + 0.5 * (corner - from).dot(direction) * direction;
  }

  /// Half the angle between two directions towards a corner.
  static double half_angle(const Vec2& a, const Vec2& b) {
    return std::max(0.1, 0.5 * std::acos(std::clamp(a.normalized().dot(b.normalized()), -1.0, 1.0)));
  }

  /// How far the level half way between inside and outside of a wedge lies from its tip after a Gaussian (to
  /// 2 % of the integral).
  double retreat(double half) const {
    return rule_.blur_px * (0.675 + 0.123 * std::sin(half)) / std::tan(half);
  }

  /// Where the straight continuations of both sides cross.
  std::optional<Corner> crossing_at(std::ptrdiff_t i, std::ptrdiff_t before, std::ptrdiff_t after,
                                    std::ptrdiff_t rounded) const {
    std::optional<geometry::CircleOrLine> a;
    std::optional<geometry::CircleOrLine> b;
    std::ptrdiff_t skip = rounded;
    double max_distance = rule_.max_distance_px;
    double half = half_angle(at(i - skip / 2) - at(i - 2 * skip), at(i + skip / 2) - at(i + 2 * skip));
    for (int pass = 0; pass < 2; ++pass) {
      if (rule_.blur_px > 0.0) {
        max_distance = 1.15 * retreat(half) + 0.3;
        skip = std::max(rounded, std::lround(retreat(half) + 2.0 * rule_.blur_px));
      } else if (rule_.pen_px > 0.0) {
        max_distance = std::max(rule_.max_distance_px, 0.6 * rule_.pen_px / std::sin(half) + 3.0);
        skip = std::max(rounded, std::lround(0.5 * rule_.pen_px * (1.0 / std::tan(half) + 1.0)));
      }
      a = side(i, -1, before, skip);
      b = side(i, +1, after, skip);
      if (!a || !b) return std::nullopt;
      half = half_angle(a->direction, b->direction);
    }
    const double det = geometry::cross(a->direction, b->direction);
    if (std::abs(det) < 0.3) return std::nullopt;  // too flat or too sharp for a crossing point to be good
    const double along = geometry::cross(b->point_m - a->point_m, b->direction) / det;
    const Vec2 corner = a->point_m + along * a->direction;
    const double back = (corner - b->point_m).dot(b->direction);
    const double distance = (corner - at(i)).norm();
    if (along < 0.0 || back < 0.0 || distance > max_distance || distance < 0.15) return std::nullopt;
    const Vec2 outwards = (a->direction + b->direction).normalized();
    if ((corner - at(i)).dot(outwards) < 0.0) return std::nullopt;  // bent sides meet too early
    if (rule_.agrees && !rule_.agrees(corner, outwards)) return std::nullopt;
    return Corner{i - skip + 1, i + skip - 1, corner};
  }

  const std::vector<Vec2>& p_;
  bool closed_;
  const CornerRule& rule_;
  std::ptrdiff_t n_;
};

}  // namespace

void sharpen_corners(std::vector<Vec2>& points, bool closed, const CornerRule& rule) {
  if (static_cast<double>(points.size()) < 4.0 * (rule.rounded_px + rule.side_px)) return;
  const std::vector<Corner> corners = Sharpener(points, closed, rule).corners();
  if (corners.empty()) return;
  const auto n = static_cast<std::ptrdiff_t>(points.size());
  // Start behind the first corner's beginning, so that none is cut by the seam.
  const std::ptrdiff_t seam = closed ? corners.front().first : 0;
  std::vector<Vec2> out;
  out.reserve(points.size() + corners.size());
  const auto bend_to = [&](const Vec2& p, const std::optional<Vec2>& control) {  // about one point a pixel
    if (out.empty()) return out.push_back(p);
    const Vec2 from = out.back();
    const Vec2 middle = control.value_or(0.5 * (from + p));
    const auto steps = static_cast<int>(std::ceil((p - from).norm() / 1.5));
    for (int k = 1; k < steps; ++k) {
      const double t = double(k) / steps;
      out.push_back((1 - t) * (1 - t) * from + 2 * t * (1 - t) * middle + t * t * p);
    }
    out.push_back(p);
  };
  std::size_t next = 0;
  std::optional<Vec2> leaving;
  for (std::ptrdiff_t i = seam; i < seam + n; ++i) {
    if (next < corners.size() && i >= corners[next].first) {
      if (out.empty() && closed) out.push_back(points[((i - 1) % n + n) % n]);
      bend_to(corners[next].at, corners[next].control_before);
      leaving = corners[next].control_after;
      i = corners[next].last;
      ++next;
      continue;
    }
    bend_to(points[((i % n) + n) % n], std::exchange(leaving, std::nullopt));
  }
  if (closed) out.pop_back();  // the seam's point was put in front as well
  points = std::move(out);
}

}  // namespace telekerf::vision
