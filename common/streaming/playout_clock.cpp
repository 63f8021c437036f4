// SPDX-License-Identifier: Apache-2.0
#include "common/streaming/playout_clock.h"

#include <algorithm>
#include <cmath>

namespace telekerf::streaming {
namespace {

/// In which the pace changes, and in which the rest of a correction fades.
constexpr double kCorrection_s = 0.02;
/// In which what stood sets off.
constexpr double kStart_s = 0.05;
/// Delay that was longer than any lately by this much is no jitter: it is over.
constexpr std::int64_t kOver_ns = 250'000'000;
/// In which what was overslept is asked back.
constexpr std::int64_t kAwake_ns = 500'000'000;
/// A stamp that tells of more is not believed.
constexpr std::int64_t kMostLost_ns = 10'000'000'000;

}  // namespace

void PlayoutClock::reset() noexcept {
  transits_ = 0;
  next_ = 0;
  synchronized_ = false;
  loss_memory_s_ = 0.0;
  overslept_ns_ = 0;
}

void PlayoutClock::arrived(const BlockArrival& block) noexcept {
  if (period_ns_ != 0 && period_ns_ != block.sample_period_ns) reset();
  constexpr double kLossMemory_s = 10.0;
  const double since_last_s =
      transits_ == 0 ? 0.0 : static_cast<double>(block.now_ns - last_arrival_ns_) * 1e-9;
  loss_memory_s_ = block.lost ? kLossMemory_s : std::max(0.0, loss_memory_s_ - since_last_s);
  last_arrival_ns_ = block.now_ns;
  period_ns_ = block.sample_period_ns;
  block_ = block.count;
  placed_ = block.placed;
  const std::int64_t lag_ns = sender_lag_ns(block);
  const bool newest = transits_ == 0 || block.last > newest_;
  std::int64_t lost_ns = newest && transits_ > 0 ? std::max<std::int64_t>(0, lag_ns - sender_lag_ns_) : 0;
  const std::int64_t by_both_ns = std::min(lost_ns, overslept_ns_);
  overslept_ns_ -= by_both_ns;
  lost_ns -= by_both_ns;
  const std::int64_t transit_ns = block.now_ns - block.last * block.sample_period_ns - lag_ns;
  history_[static_cast<std::size_t>(next_)] = {transit_ns, transit_ns + lost_ns};
  if (newest) {
    newest_ = block.last;
    sender_lag_ns_ = lag_ns;
  }
  next_ = (next_ + 1) % kHistory;
  transits_ = std::min(transits_ + 1, kHistory);
  choose_depth(block);
}

std::int64_t PlayoutClock::sender_lag_ns(const BlockArrival& block) const noexcept {
  const bool possible = block.sent_ns >= 0 && block.sent_ns < std::int64_t{1} << 62;
  const std::int64_t made_ns = block.last * block.sample_period_ns;
  if (transits_ == 0) return (possible ? block.sent_ns : block.now_ns) - made_ns;
  if (!possible) return sender_lag_ns_;
  // Time is lost, never won: what came later has no smaller lag, but for the step's own lateness.
  const std::int64_t lag_ns = block.sent_ns - made_ns;
  const std::int64_t more_ns = block.last > newest_ ? lag_ns - sender_lag_ns_ : sender_lag_ns_ - lag_ns;
  return more_ns > -2 * period_ns_ && more_ns < kMostLost_ns ? lag_ns : sender_lag_ns_;
}

void PlayoutClock::forget_what_is_over() noexcept {
  if (transits_ <= kRecent) return;
  std::array<Transit, kRecent> recent{};
  for (int n = 0; n < kRecent; ++n)
    recent[static_cast<std::size_t>(n)] =
        history_[static_cast<std::size_t>((next_ + kHistory - kRecent + n) % kHistory)];
  const auto latest = [](auto begin, auto end) {
    return std::max_element(begin, end, [](const Transit& a, const Transit& b) { return a.late < b.late; })
        ->late;
  };
  if (!hurry_ &&
      latest(history_.begin(), history_.begin() + transits_) - latest(recent.begin(), recent.end()) <
          kOver_ns)
    return;
  std::copy(recent.begin(), recent.end(), history_.begin());
  transits_ = next_ = kRecent;
}

void PlayoutClock::choose_depth(const BlockArrival& newest) noexcept {
  forget_what_is_over();
  // The newest transits at block rate: 512 blocks of 16 ms are 8 s, so the envelope follows the clocks' skew.
  std::array<std::int64_t, kHistory> late_ns;
  envelope_ns_ = history_.front().ns;
  for (std::size_t i = 0; i < static_cast<std::size_t>(transits_); ++i) {
    late_ns[i] = history_[i].late;
    envelope_ns_ = std::min(envelope_ns_, history_[i].ns);
  }
  const auto rank = static_cast<std::ptrdiff_t>(std::lround(settings_.jitter_quantile * (transits_ - 1)));
  std::nth_element(late_ns.begin(), late_ns.begin() + rank, late_ns.begin() + transits_);
  const std::int64_t late = late_ns[static_cast<std::size_t>(rank)];

  const double period_s = static_cast<double>(period_ns_) * 1e-9;
  double depth_s = static_cast<double>(late - envelope_ns_) * 1e-9 + settings_.margin_s;
  depth_s += (block_ - 1 + newest.lookahead) * period_s;
  if (loss_memory_s_ > 0.0) depth_s += newest.copies * block_ * period_s;
  depth_ = static_cast<int>(std::ceil(std::min(depth_s, settings_.max_depth_s) / period_s - 1e-6));
}

double PlayoutClock::target(std::int64_t now_ns) const noexcept {
  const std::int64_t since_ns = now_ns - envelope_ns_ - sender_lag_ns_ - overslept_ns_;
  return static_cast<double>(since_ns) / static_cast<double>(period_ns_) - depth_;
}

std::optional<double> PlayoutClock::advance(std::int64_t now_ns, std::int64_t control_period_ns) noexcept {
  went_on_ = false;
  if (transits_ == 0) return std::nullopt;
  overslept_ns_ -=
      std::min(overslept_ns_, std::max(overslept_ns_, control_period_ns) * control_period_ns / kAwake_ns);
  const double wanted = target(now_ns);
  const auto too_far = [&](double samples, double most_s) {
    return std::abs(samples) * static_cast<double>(period_ns_) > 1e9 * most_s;
  };
  const double behind = wanted - (cursor_ + ahead_);
  if (placed_ && behind > 0.0 && too_far(behind, settings_.give_up_s)) stood_ = true;
  const bool lost = stood_ ? too_far(behind, settings_.max_lag_s)
                           : too_far(wanted - cursor_, settings_.give_up_s) ||
                                 too_far(std::min(ahead_, 0.0), settings_.give_up_s);
  if (!synchronized_ || lost) {
    resyncs_ += synchronized_ ? 1 : 0;
    cursor_ = std::floor(wanted);
    ahead_ = slowing_ = 0.0;
    stood_ = false;
    synchronized_ = true;
    return cursor_;
  }
  const double step = static_cast<double>(control_period_ns) / static_cast<double>(period_ns_);
  went_on_ = true;
  cursor_ += step;
  // By whole samples: late data wants more delay soon; a better link may keep some of it.
  const double error = wanted - cursor_;
  const double whole = error < -1.5 ? std::ceil(error) : error > 3.5 ? std::floor(error - 2.5) : 0.0;
  cursor_ += whole;
  ahead_ -= whole;
  corrections_ += static_cast<std::uint64_t>(std::abs(whole));
  return cursor_ + catch_up(step);
}

double PlayoutClock::stand(double at) noexcept {
  ahead_ = std::min(at - cursor_, 0.0);
  slowing_ = 1.0;
  stood_ = true;
  return cursor_ + ahead_;
}

double PlayoutClock::catch_up(double step) noexcept {
  const double period_s = static_cast<double>(period_ns_) * 1e-9;
  const bool hurry = hurry_ || stood_ || overslept_ns_ > 0;
  const double aim =
      std::clamp(ahead_ * period_s / kCorrection_s, -(hurry ? settings_.max_slowing : settings_.max_hurry),
                 settings_.max_slowing);
  const double share =
      slowing_ > settings_.max_slowing ? 1.0 / kStart_s : settings_.max_slowing / kCorrection_s;
  const double change = step * period_s * share;
  slowing_ += std::clamp(aim - slowing_, -change, change);
  ahead_ -= slowing_ * step;
  if (slowing_ < 1.0 && ahead_ > -1.0) stood_ = false;
  if (std::abs(ahead_) < 1e-3 && std::abs(slowing_) < 1e-3) ahead_ = slowing_ = 0.0;
  return ahead_;
}

}  // namespace telekerf::streaming
