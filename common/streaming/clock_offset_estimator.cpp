// SPDX-License-Identifier: Apache-2.0
#include "common/streaming/clock_offset_estimator.h"

#include <algorithm>
#include <cmath>

namespace telekerf::streaming {

void ClockOffsetEstimator::add(const FourStamps& s) noexcept {
  Exchange& exchange = exchanges_[static_cast<std::size_t>(next_)];
  exchange.at_ns = s.t1_ns + (s.t4_ns - s.t1_ns) / 2;
  exchange.offset_ns = ((s.t2_ns - s.t1_ns) + (s.t3_ns - s.t4_ns)) / 2;
  exchange.delay_ns = (s.t4_ns - s.t1_ns) - (s.t3_ns - s.t2_ns);
  next_ = (next_ + 1) % kWindow;
  count_ = std::min(count_ + 1, kWindow);
}

ClockEstimate ClockOffsetEstimator::estimate(std::int64_t now_ns) const noexcept {
  ClockEstimate estimate;
  if (count_ < 2) return estimate;
  const auto begin = exchanges_.begin();
  const auto end = begin + count_;
  const std::int64_t shortest_ns = std::min_element(begin, end, [](const auto& a, const auto& b) {
                                     return a.delay_ns < b.delay_ns;
                                   })->delay_ns;
  // Relative to one exchange, so that nothing is lost of large clock values.
  const Exchange& origin = *begin;
  double w = 0.0;
  double wt = 0.0;
  double wy = 0.0;
  double wtt = 0.0;
  double wty = 0.0;
  const auto weight_of = [&](const Exchange& e) {
    const double queued_s = static_cast<double>(e.delay_ns - shortest_ns) * 1e-9 + 100e-6;
    return 1.0 / (queued_s * queued_s);
  };
  const auto time_of = [&](const Exchange& e) { return static_cast<double>(e.at_ns - origin.at_ns) * 1e-9; };
  const auto value_of = [&](const Exchange& e) {
    return static_cast<double>(e.offset_ns - origin.offset_ns) * 1e-9;
  };
  for (auto e = begin; e != end; ++e) {
    const double weight = weight_of(*e);
    const double t = time_of(*e);
    const double y = value_of(*e);
    w += weight;
    wt += weight * t;
    wy += weight * y;
    wtt += weight * t * t;
    wty += weight * t * y;
  }
  const double determinant = w * wtt - wt * wt;
  const bool spread = determinant > 1e-9 * w * wtt;
  estimate.skew = spread ? (w * wty - wt * wy) / determinant : 0.0;
  const double base = (wy - estimate.skew * wt) / w;
  const double now_s = static_cast<double>(now_ns - origin.at_ns) * 1e-9;
  estimate.offset_s = static_cast<double>(origin.offset_ns) * 1e-9 + base + estimate.skew * now_s;
  double squares = 0.0;
  for (auto e = begin; e != end; ++e) {
    const double miss = value_of(*e) - base - estimate.skew * time_of(*e);
    squares += weight_of(*e) * miss * miss;
  }
  estimate.uncertainty_s = 0.5 * static_cast<double>(shortest_ns) * 1e-9 + std::sqrt(squares / w / count_);
  return estimate;
}

}  // namespace telekerf::streaming
