// SPDX-License-Identifier: Apache-2.0
// The play-out clock ("delay regulator"): samples are applied a fixed time after they were made, so that
// jitter and reordering on the link become a constant delay (docs/results/delay.md).
#pragma once

#include <array>
#include <cstdint>
#include <optional>

namespace telekerf::streaming {

struct PlayoutSettings {
  double jitter_quantile = 0.995;
  double margin_s = 0.002;    ///< on top of the observed jitter
  int lookahead_samples = 4;  ///< the differentiator's half window
  double max_depth_s = 2.0;
  int redundancy = 1;             ///< previous blocks in every packet: waited for where losses are seen
  double grow_interval_s = 0.02;  ///< at most one whole sample of correction per interval ...
  double shrink_interval_s = 0.2;
};

/// Maps the slave's clock to the stream sample to apply. The map is the lower envelope of (arrival - sample
/// time) plus a depth that covers block filling, jitter and, where losses are seen, the redundant copies.
class PlayoutClock {
 public:
  explicit PlayoutClock(const PlayoutSettings& settings) noexcept : settings_(settings) {}

  /// Forgets the link; the next arrival synchronizes the clock.
  void reset() noexcept;
  /// A block of `count` samples whose last has index `last` arrived; `lost` says that blocks before it are
  /// missing.
  void arrived(std::int64_t now_ns, std::int64_t last, int count, std::int64_t sample_period_ns,
               bool lost) noexcept;
  /// Advances by one control step; returns the stream time to apply, in samples, once the clock is
  /// synchronized. `underrun`: the last step found no data; then a clock that runs too early waits instead of
  /// running on.
  std::optional<double> advance(std::int64_t now_ns, std::int64_t control_period_ns, bool underrun) noexcept;

  /// Depth from the fastest arrival of a block's last sample to its use, in samples.
  int depth_samples() const noexcept { return depth_; }
  /// The part of the depth that is not block filling: what waiting for stragglers costs.
  double wait_s() const noexcept { return (depth_ - (block_ - 1)) * static_cast<double>(period_ns_) * 1e-9; }
  /// Whole-sample corrections since the start (clock drift, changed depth, overruns).
  std::uint64_t corrections() const noexcept { return corrections_; }
  /// Times the clock had to be synchronized anew.
  std::uint64_t resyncs() const noexcept { return resyncs_; }

 private:
  void choose_depth() noexcept;
  double target(std::int64_t now_ns) const noexcept;

  static constexpr int kHistory = 512;
  PlayoutSettings settings_;
  std::array<std::int64_t, kHistory> transit_ns_{};  ///< arrival - last * period, newest overwrite oldest
  int transits_ = 0;
  int next_ = 0;
  std::int64_t envelope_ns_ = 0;
  std::int64_t period_ns_ = 0;
  int block_ = 0;
  int depth_ = 0;
  double loss_memory_s_ = 0.0;  ///< how long losses are still taken for usual
  std::int64_t last_arrival_ns_ = 0;
  std::int64_t last_correction_ns_ = 0;
  bool synchronized_ = false;
  double cursor_ = 0.0;
  double waited_ = 0.0;  ///< samples, fraction not yet counted
  std::uint64_t corrections_ = 0;
  std::uint64_t resyncs_ = 0;
};

}  // namespace telekerf::streaming
