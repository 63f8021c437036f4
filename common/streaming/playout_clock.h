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
  double margin_s = 0.002;  ///< on top of the observed jitter
  double max_depth_s = 2.0;
  double max_slowing =
      0.2;  ///< of the usual pace, while more delay is taken up; the pace itself does not jump
  double max_hurry = 0.005;  ///< and while delay is given back; as above where there is a hurry
  double give_up_s = 0.25;   ///< a correction longer than this is no slow one: the clock begins anew
  double max_lag_s = 0.75;  ///< but where samples have a place, of what is behind: up to this it is caught up
};

/// A block that came.
struct BlockArrival {
  std::int64_t now_ns = 0;
  std::int64_t sent_ns = 0;  ///< by its sender's clock
  std::int64_t last = 0;     ///< index of its last sample
  int count = 0;             ///< samples in it
  std::int64_t sample_period_ns = 0;
  int copies = 0;      ///< earlier blocks that its sender repeats: waited for where losses are seen
  int lookahead = 0;   ///< samples after the one that is applied which are needed as well
  bool lost = false;   ///< blocks before it are missing
  bool placed = true;  ///< samples say where the tool is to be: time may go faster for a while, but not jump
};

/// Maps the slave's clock to the stream sample to apply. The map is the lower envelope of (arrival - sending)
/// plus a depth that covers block filling, jitter and, where losses are seen, the redundant copies. Time that
/// the sender's loop lost is no jitter: all that it sends later is later by as much.
/// The map is corrected by whole samples, and they little by little: what is played goes on without a jump, a
/// little slower or faster.
class PlayoutClock {
 public:
  explicit PlayoutClock(const PlayoutSettings& settings) noexcept : settings_(settings) {}

  /// Forgets the link; the next arrival synchronizes the clock.
  void reset() noexcept;
  void arrived(const BlockArrival& block) noexcept;
  /// Advances by one control step; returns the stream time to apply, in samples, once the clock is
  /// synchronized.
  std::optional<double> advance(std::int64_t now_ns, std::int64_t control_period_ns) noexcept;
  /// The last advance() went on by a step, at the usual pace or that of a correction: it did not begin anew.
  bool went_on() const noexcept { return went_on_; }
  /// What is due is not there. Until that is said no more, what is played stands at `at` (samples), no later
  /// than what is due; then it sets off again without a jump of the pace. Returns where it stands.
  double stand(double at) noexcept;
  /// The slave's loop has lost time since the last advance(). Where the sender lost as much, as on a machine
  /// of both that did something else, nothing is behind; what is left is caught up within a second or two.
  void overslept(std::int64_t lost_ns) noexcept { overslept_ns_ += synchronized_ ? lost_ns : 0; }
  /// Commands come so late that they are of little use: delay that has gone is given back as fast as the pace
  /// may change, and none is kept for what may come again.
  void hurry(bool on) noexcept { hurry_ = on; }
  /// Depth from the fastest arrival of a block's last sample to its use, in samples.
  int depth_samples() const noexcept { return depth_; }
  /// The part of the depth that is not block filling: what waiting for stragglers costs.
  double wait_s() const noexcept { return (depth_ - (block_ - 1)) * static_cast<double>(period_ns_) * 1e-9; }
  /// Whole-sample corrections since the start (clock drift, changed depth, overruns).
  std::uint64_t corrections() const noexcept { return corrections_; }
  /// Times the clock had to be synchronized anew.
  std::uint64_t resyncs() const noexcept { return resyncs_; }

 private:
  /// How far the sender's clock is ahead of its samples' time when it sends this one: more by what its loop
  /// loses.
  std::int64_t sender_lag_ns(const BlockArrival& block) const noexcept;
  void choose_depth(const BlockArrival& newest) noexcept;
  /// A delay that has gone must not be waited for as long as the history lasts.
  void forget_what_is_over() noexcept;
  double target(std::int64_t now_ns) const noexcept;
  double catch_up(double step) noexcept;

  static constexpr int kHistory = 512;
  static constexpr int kRecent = 96;  ///< 1.5 s of blocks of 16 ms
  PlayoutSettings settings_;
  /// Of a block that came, in the clocks' difference.
  struct Transit {
    std::int64_t ns = 0;    ///< arrival - sending
    std::int64_t late = 0;  ///< and with what its sender had just lost and the slave had not
  };
  std::array<Transit, kHistory> history_{};  ///< newest overwrite oldest
  int transits_ = 0;
  int next_ = 0;
  std::int64_t envelope_ns_ = 0;
  std::int64_t newest_ = 0;         ///< last sample that came
  std::int64_t sender_lag_ns_ = 0;  ///< when it was sent
  std::int64_t period_ns_ = 0;
  int block_ = 0;
  int depth_ = 0;
  double loss_memory_s_ = 0.0;  ///< how long losses are still taken for usual
  std::int64_t last_arrival_ns_ = 0;
  bool synchronized_ = false;
  bool went_on_ = false;
  bool hurry_ = false;
  bool placed_ = true;
  bool stood_ = false;             ///< or was far behind, and has not caught up yet
  std::int64_t overslept_ns_ = 0;  ///< that nothing has been done for yet
  double cursor_ = 0.0;            ///< as if corrections took no time
  double ahead_ = 0.0;             ///< samples by which what is played is still ahead of that
  double slowing_ = 0.0;
  std::uint64_t corrections_ = 0;
  std::uint64_t resyncs_ = 0;
};

}  // namespace telekerf::streaming
