// SPDX-License-Identifier: Apache-2.0
#include "common/vision/vector/segment_grid.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <tuple>

namespace telekerf::vision {
namespace {

struct Entry {
  std::uint64_t cell;
  std::uint32_t line;
  std::uint32_t segment;  ///< of all
};

/// Cells as wide as a segment is long on average, so that there are not many more entries than segments.
class Grid {
 public:
  Grid(double cell, double distance) : cell_(cell), distance_(distance) {}

  void enter(const Segment& s, std::uint32_t line, std::uint32_t number) {
    const bool forwards = s.from.x() <= s.to.x();
    const Vec2& left = forwards ? s.from : s.to;
    const Vec2& right = forwards ? s.to : s.from;
    const std::int64_t first = row(left.x() - distance_);
    const std::int64_t last = row(right.x() + distance_);
    const double width = right.x() - left.x();
    for (std::int64_t column = first; column <= last; ++column) {
      const auto y_at = [&](double x) {
        const double t = width > 0.0 ? std::clamp((x - left.x()) / width, 0.0, 1.0) : 0.0;
        return left.y() + t * (right.y() - left.y());
      };
      double low = y_at(static_cast<double>(column) * cell_ - distance_);
      double high = y_at(static_cast<double>(column + 1) * cell_ + distance_);
      if (!(width > 0.0)) {
        low = left.y();
        high = right.y();
      }
      if (low > high) std::swap(low, high);
      for (std::int64_t r = row(low - distance_); r <= row(high + distance_); ++r) {
        // Two cells of one number cost a comparison, nothing else.
        const auto key =
            static_cast<std::uint64_t>(column) * 0x9E3779B97F4A7C15U ^ static_cast<std::uint64_t>(r);
        entries_.push_back({key, line, number});
      }
    }
  }

  std::vector<Entry>& entries() { return entries_; }

 private:
  std::int64_t row(double x) const {
    return static_cast<std::int64_t>(std::floor(std::clamp(x / cell_, -4e18, 4e18)));
  }

  double cell_;
  double distance_;
  std::vector<Entry> entries_;
};

}  // namespace

bool for_near_segments(const std::vector<geometry::Polyline>& lines, double distance, std::size_t max_pairs,
                       const std::function<void(const Segment&, const Segment&)>& visit) {
  std::vector<Segment> segments;
  double length = 0.0;
  for (std::size_t k = 0; k < lines.size(); ++k) {
    for (std::size_t i = 0; i < lines[k].segments(); ++i) {
      const Segment s{k, i, lines[k].start_of(i), lines[k].end_of(i)};
      const double own = (s.to - s.from).norm();
      if (!(own > 0.0)) continue;
      length += own;
      segments.push_back(s);
    }
  }
  if (!std::isfinite(length) || segments.size() > UINT32_MAX) return false;
  const double mean = length / static_cast<double>(std::max<std::size_t>(1, segments.size()));
  Grid grid(std::max({mean, 4.0 * distance, 1e-12}), distance);
  for (std::size_t i = 0; i < segments.size(); ++i)
    grid.enter(segments[i], static_cast<std::uint32_t>(segments[i].line), static_cast<std::uint32_t>(i));
  auto& entries = grid.entries();
  std::sort(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) {
    return std::tuple(a.cell, a.line, a.segment) < std::tuple(b.cell, b.line, b.segment);
  });
  std::size_t pairs = 0;
  for (std::size_t begin = 0; begin < entries.size();) {
    std::size_t end = begin;
    while (end < entries.size() && entries[end].cell == entries[begin].cell) ++end;
    std::size_t next_line = begin;
    for (std::size_t i = begin; i < end; ++i) {
      if (next_line <= i) {
        next_line = i + 1;
        while (next_line < end && entries[next_line].line == entries[i].line) ++next_line;
      }
      pairs += end - next_line;
      if (pairs > max_pairs) return false;
      for (std::size_t j = next_line; j < end; ++j)
        visit(segments[entries[i].segment], segments[entries[j].segment]);
    }
    begin = end;
  }
  return true;
}

}  // namespace telekerf::vision
