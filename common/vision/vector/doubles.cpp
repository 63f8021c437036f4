// SPDX-License-Identifier: Apache-2.0
#include "common/vision/vector/doubles.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <tuple>
#include <utility>

#include "common/vision/vector/segment_grid.h"

namespace telekerf::vision {
namespace {

using geometry::Polyline;

constexpr double kReversal = -0.9999985;  ///< cosine of a turn of 179.9 degrees: the way back
constexpr double kLeastRun = 50.0;        ///< tolerances: lines that touch are as near for less than this
constexpr double kBeyond = 25.0;          ///< tolerances beyond a run, where lines that part ...
constexpr double kParting = 0.25;         ///< ... are this share of the way apart, or more
constexpr std::size_t kMaxComparisons = 300'000'000;

/// A stretch of a line by the way along it.
struct Stretch {
  double from = 0.0;
  double to = 0.0;
};

/// A stretch of one line that lies on another.
struct Run {
  std::size_t other = 0;
  Stretch stretch;
};

Vec2 point_at(const Polyline& line, const std::vector<double>& way, double s) {
  const auto next = std::upper_bound(way.begin(), way.end(), s);
  const std::size_t k =
      std::clamp<std::size_t>(static_cast<std::size_t>(next - way.begin()), 1, line.segments());
  const double length = way[k] - way[k - 1];
  const double t = length > 0.0 ? std::clamp((s - way[k - 1]) / length, 0.0, 1.0) : 0.0;
  return line.start_of(k - 1) + t * (line.end_of(k - 1) - line.start_of(k - 1));
}

double distance_m(const Polyline& line, const Vec2& p) {
  double best = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < line.segments(); ++i) {
    const Vec2 way = line.end_of(i) - line.start_of(i);
    const double square = way.squaredNorm();
    const double t = square > 0.0 ? std::clamp((p - line.start_of(i)).dot(way) / square, 0.0, 1.0) : 0.0;
    best = std::min(best, (line.start_of(i) + t * way - p).norm());
  }
  return best;
}

/// The part of segment a that lies on segment b, metres from a's start; nothing where they part.
Stretch common_stretch(const Segment& a, const Segment& b, double tolerance) {
  // Along and across are times a's length here: most pairs part, and cost no root and no division.
  const Vec2 way = a.to - a.from;
  const double square = way.squaredNorm();
  const double along0 = way.dot(b.from - a.from);
  const double along = way.dot(b.to - a.from) - along0;
  const double low = std::max(0.0, std::min(along0, along0 + along));
  const double high = std::min(square, std::max(along0, along0 + along));
  if (!(high > low)) return {};
  const double across0 = geometry::cross(way, b.from - a.from);
  const double across = geometry::cross(way, b.to - a.from) - across0;
  const double near = tolerance * along;
  for (const double s : {low, high}) {
    const double aside = across0 * along + (s - along0) * across;
    if (!(aside * aside <= near * near * square)) return {};
  }
  const double length = std::sqrt(square);
  return {low / length, high / length};
}

/// Where the pen goes back the way it came, one line ends and another begins.
void split_at_reversals(std::vector<Polyline>& lines, std::vector<std::size_t>& from) {
  const std::size_t given = lines.size();
  from.resize(given);
  std::iota(from.begin(), from.end(), std::size_t{0});
  for (std::size_t k = 0; k < given; ++k) {
    const std::size_t n = lines[k].size();
    const bool closed = lines[k].closed;
    std::vector<std::size_t> corners;
    for (std::size_t i = closed ? 0 : 1; i + (closed ? 0 : 1) < n; ++i) {
      const Vec2 before = lines[k].points_m[i] - lines[k].points_m[(i + n - 1) % n];
      const Vec2 after = lines[k].points_m[(i + 1) % n] - lines[k].points_m[i];
      if (before.dot(after) < kReversal * before.norm() * after.norm()) corners.push_back(i);
    }
    if (corners.empty()) continue;
    const Polyline whole = std::move(lines[k]);
    std::vector<std::size_t> ends = corners;
    if (closed) {
      ends.push_back(corners.front() + n);
    } else {
      ends.insert(ends.begin(), 0);
      ends.push_back(n - 1);
    }
    for (std::size_t j = 0; j + 1 < ends.size(); ++j) {
      Polyline part;
      for (std::size_t i = ends[j]; i <= ends[j + 1]; ++i) part.points_m.push_back(whole.points_m[i % n]);
      if (j == 0) {
        lines[k] = std::move(part);
      } else {
        lines.push_back(std::move(part));
        from.push_back(k);
      }
    }
  }
}

class Doubles {
 public:
  Doubles(std::vector<Polyline> lines, double tolerance) : lines_(std::move(lines)), tolerance_(tolerance) {
    split_at_reversals(lines_, from_);
    for (const auto& line : lines_) way_.push_back(geometry::arc_lengths(line));
    std::vector<std::size_t> order(lines_.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    const auto key = [&](std::size_t i) {
      const Vec2 low = geometry::bounding_box(lines_[i].points_m).min;
      return std::tuple(!lines_[i].closed, -way_[i].back(), low.x(), low.y());
    };
    std::vector<decltype(key(0))> keys;
    for (std::size_t i = 0; i < lines_.size(); ++i) keys.push_back(key(i));
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return keys[a] < keys[b]; });
    rank_.resize(order.size());
    for (std::size_t i = 0; i < order.size(); ++i) rank_[order[i]] = i;
    runs_.resize(lines_.size());
  }

  WithoutDoubles result() {
    WithoutDoubles out;
    out.gave_up = !find_runs();
    std::vector<std::vector<Stretch>> all(lines_.size());
    for (std::size_t k = 0; k < lines_.size() && !out.gave_up; ++k) all[k] = covered_of(k);
    for (std::size_t k = 0; k < lines_.size(); ++k) {
      const std::vector<Stretch>& covered = all[k];
      if (covered.empty()) {
        out.lines.push_back(std::move(lines_[k]));
        out.from.push_back(from_[k]);
        continue;
      }
      for (auto& part : parts(k, rest(k, covered))) {
        out.lines.push_back(std::move(part));
        out.from.push_back(from_[k]);
      }
      for (auto& part : parts(k, covered)) {
        out.doubles.push_back(std::move(part));
        out.doubles_from.push_back(from_[k]);
      }
    }
    return out;
  }

 private:
  bool find_runs() {
    return for_near_segments(lines_, tolerance_, kMaxComparisons, [&](const Segment& a, const Segment& b) {
      const bool a_goes = rank_[a.line] > rank_[b.line];
      const Segment& gone = a_goes ? a : b;
      const Segment& kept = a_goes ? b : a;
      const Stretch s = common_stretch(gone, kept, tolerance_);
      const double start = way_[gone.line][gone.index];
      if (s.to > s.from) runs_[gone.line].push_back({kept.line, {start + s.from, start + s.to}});
    });
  }

  /// The runs of one line as stretches that do not overlap, in order.
  std::vector<Stretch> covered_of(std::size_t k) {
    auto& runs = runs_[k];
    std::sort(runs.begin(), runs.end(), [](const Run& a, const Run& b) {
      return std::tuple(a.other, a.stretch.from, a.stretch.to) <
             std::tuple(b.other, b.stretch.from, b.stretch.to);
    });
    std::vector<Stretch> all;
    for (std::size_t i = 0; i < runs.size();) {
      const std::size_t other = runs[i].other;
      std::vector<Stretch> with_one;
      for (; i < runs.size() && runs[i].other == other; ++i) append(with_one, runs[i].stretch);
      close_round(k, with_one);
      for (const Stretch& s : with_one) {
        if (lies_on(k, other, s)) all.push_back(s);
      }
    }
    std::sort(all.begin(), all.end(), [](const Stretch& a, const Stretch& b) { return a.from < b.from; });
    std::vector<Stretch> out;
    const double length = way_[k].back();
    for (Stretch s : all) {
      if (s.to <= length) append(out, s);
    }
    for (Stretch s : all) {  // across the start of a closed line
      if (s.to <= length) continue;
      append(out, {s.from, length});
      append(out, {0.0, s.to - length});
      std::sort(out.begin(), out.end(), [](const Stretch& a, const Stretch& b) { return a.from < b.from; });
      std::vector<Stretch> merged;
      for (const Stretch& m : out) append(merged, m);
      out = merged;
    }
    return out;
  }

  void append(std::vector<Stretch>& to, const Stretch& s) const {
    if (!to.empty() && s.from <= to.back().to + tolerance_) {
      to.back().to = std::max(to.back().to, s.to);
    } else {
      to.push_back(s);
    }
  }

  /// Joins the last stretch of a closed line to its first.
  void close_round(std::size_t k, std::vector<Stretch>& runs) const {
    const double length = way_[k].back();
    if (!lines_[k].closed || runs.size() < 2 || runs.front().from > tolerance_ ||
        runs.back().to < length - tolerance_)
      return;
    runs.back().to = length + runs.front().to;
    runs.erase(runs.begin());
  }

  bool lies_on(std::size_t k, std::size_t other, const Stretch& s) const {
    const double length = way_[k].back();
    if (s.to - s.from >= length - 2.0 * tolerance_) return true;
    return s.to - s.from >= kLeastRun * tolerance_ && ends_there(k, other, s.from, -1.0) &&
           ends_there(k, other, s.to, 1.0);
  }

  /// Whether one of the lines ends or turns away at a run's end.
  bool ends_there(std::size_t k, std::size_t other, double s, double side) const {
    const Polyline& line = lines_[k];
    const Polyline& on = lines_[other];
    const double length = way_[k].back();
    if (!line.closed && (side < 0.0 ? s <= tolerance_ : s >= length - tolerance_)) return true;
    const auto at = [&](double where) {
      if (line.closed) where = std::fmod(where + 2.0 * length, length);
      return point_at(line, way_[k], std::clamp(where, 0.0, length));
    };
    const Vec2 here = at(s);
    const double near = 3.0 * tolerance_;
    if (!on.closed &&
        ((on.points_m.front() - here).norm() <= near || (on.points_m.back() - here).norm() <= near))
      return true;
    const Vec2 beyond = at(s + side * kBeyond * tolerance_);
    return distance_m(on, beyond) >= kParting * (beyond - here).norm();
  }

  std::vector<Stretch> rest(std::size_t k, const std::vector<Stretch>& covered) const {
    std::vector<Stretch> out;
    const double length = way_[k].back();
    const double least = 2.0 * tolerance_;
    for (std::size_t i = 0; i + 1 < covered.size(); ++i) out.push_back({covered[i].to, covered[i + 1].from});
    if (lines_[k].closed) {
      out.push_back({covered.back().to, length + covered.front().from});
    } else {
      out.push_back({0.0, covered.front().from});
      out.push_back({covered.back().to, length});
    }
    std::erase_if(out, [&](const Stretch& s) { return s.to - s.from <= least; });
    return out;
  }

  std::vector<Polyline> parts(std::size_t k, const std::vector<Stretch>& stretches) const {
    const Polyline& line = lines_[k];
    const auto& way = way_[k];
    const double length = way.back();
    std::vector<Polyline> out;
    for (const Stretch& s : stretches) {
      if (s.to - s.from >= length * (1.0 - 1e-12)) {
        out.push_back(line);
        continue;
      }
      Polyline part;
      const auto at = [&](double where) {
        return point_at(line, way, where > length ? where - length : where);
      };
      part.points_m.push_back(at(s.from));
      for (const double turn : {0.0, length}) {
        for (std::size_t i = 0; i < line.size(); ++i) {
          const double here = way[i] + turn;
          if (here > s.from + 1e-12 && here < s.to - 1e-12) part.points_m.push_back(line.points_m[i]);
        }
        if (!line.closed) break;
      }
      part.points_m.push_back(at(s.to));
      out.push_back(std::move(part));
    }
    return out;
  }

  std::vector<Polyline> lines_;
  double tolerance_;
  std::vector<std::size_t> from_;
  std::vector<std::vector<double>> way_;
  std::vector<std::size_t> rank_;
  std::vector<std::vector<Run>> runs_;
};

}  // namespace

WithoutDoubles without_doubles(std::vector<Polyline> lines, double tolerance) {
  return Doubles(std::move(lines), tolerance).result();
}

}  // namespace telekerf::vision
