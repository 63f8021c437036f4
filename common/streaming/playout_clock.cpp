// SPDX-License-Identifier: Apache-2.0
#include "common/streaming/playout_clock.h"

#include <algorithm>
#include <cmath>

namespace telekerf::streaming {

void PlayoutClock::reset() noexcept {
  transits_ = 0;
  next_ = 0;
  synchronized_ = false;
  loss_memory_s_ = 0.0;
}

void PlayoutClock::arrived(std::int64_t now_ns, std::int64_t last, int count, std::int64_t sample_period_ns,
                           bool lost) noexcept {
  if (period_ns_ != sample_period_ns) reset();
  constexpr double kLossMemory = 10.0;
  const double since_last_s = static_cast<double>(now_ns - last_arrival_ns_) * 1e-9;
  loss_memory_s_ = lost ? kLossMemory : std::max(0.0, loss_memory_s_ - since_last_s);
  last_arrival_ns_ = now_ns;
  period_ns_ = sample_period_ns;
  block_ = count;
  transit_ns_[static_cast<std::size_t>(next_)] = now_ns - last * sample_period_ns;
  next_ = (next_ + 1) % kHistory;
  transits_ = std::min(transits_ + 1, kHistory);
  choose_depth();
}

void PlayoutClock::choose_depth() noexcept {
  // The newest transits at block rate: 512 blocks of 16 ms are 8 s, so the envelope follows the clocks' skew.
  std::array<std::int64_t, kHistory> sorted = transit_ns_;
  const auto begin = sorted.begin();
  const auto end = begin + transits_;
  const auto rank = static_cast<std::ptrdiff_t>(std::lround(settings_.jitter_quantile * (transits_ - 1)));
  std::nth_element(begin, begin + rank, end);
  const std::int64_t late = *(begin + rank);
  envelope_ns_ = *std::min_element(begin, end);

  const double period_s = static_cast<double>(period_ns_) * 1e-9;
  double depth_s = static_cast<double>(late - envelope_ns_) * 1e-9 + settings_.margin_s;
  depth_s += (block_ - 1 + settings_.lookahead_samples) * period_s;
  if (loss_memory_s_ > 0.0) depth_s += settings_.redundancy * block_ * period_s;
  depth_ = static_cast<int>(std::ceil(std::min(depth_s, settings_.max_depth_s) / period_s));
}

double PlayoutClock::target(std::int64_t now_ns) const noexcept {
  return static_cast<double>(now_ns - envelope_ns_) / static_cast<double>(period_ns_) - depth_;
}

std::optional<double> PlayoutClock::advance(std::int64_t now_ns, std::int64_t control_period_ns,
                                            bool underrun) noexcept {
  if (transits_ == 0) return std::nullopt;
  const double wanted = target(now_ns);
  // Beyond a quarter of a second nothing can be won by slow correction.
  const double give_up = 0.25e9 / static_cast<double>(period_ns_);
  if (!synchronized_ || std::abs(wanted - cursor_) > give_up) {
    resyncs_ += synchronized_ ? 1 : 0;
    cursor_ = std::floor(wanted);
    synchronized_ = true;
    last_correction_ns_ = now_ns;
    return cursor_;
  }
  const double step = static_cast<double>(control_period_ns) / static_cast<double>(period_ns_);
  if (underrun && wanted - cursor_ < -1.5) {
    waited_ += step;  // counted as corrections, one a sample
    if (waited_ >= 1.0) {
      waited_ -= 1.0;
      ++corrections_;
      last_correction_ns_ = now_ns;
    }
    return cursor_;
  }
  cursor_ += step;
  // One whole sample at a time, rarely: late data wants more delay soon, a better link gives it back slowly.
  const double error = wanted - cursor_;
  const double waited_s = static_cast<double>(now_ns - last_correction_ns_) * 1e-9;
  if (error < -1.5 && waited_s >= settings_.grow_interval_s) {
    cursor_ -= 1.0;
  } else if (error > 3.5 && waited_s >= settings_.shrink_interval_s) {
    cursor_ += 1.0;
  } else {
    return cursor_;
  }
  ++corrections_;
  last_correction_ns_ = now_ns;
  return cursor_;
}

}  // namespace telekerf::streaming
