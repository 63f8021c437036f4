// SPDX-License-Identifier: Apache-2.0
// The dead-man of every device that speaks in frames: a lease that runs out by itself, never an event that
// has to arrive.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>

namespace telekerf::master {

/// What one frame says of the hand.
struct LeasedFrame {
  std::uint64_t sequence = 0;           ///< from 1, more each time
  std::optional<std::int64_t> sent_ns;  ///< sender's clock, whatever its zero; none: it tells no time
  bool held = false;                    ///< something is asked for: to move, or the laser
};

/// Judges frames by order, age and silence. Pure: time is what it is told. Neither allocates nor throws.
///
/// Silence of 0.1 s releases, and after it, as at the start, a frame "released" has to come before anything
/// is held again. Age is what a frame took longer than the fastest one of late: a queue that a stalled
/// line lets go of at once is dropped, and counted.
class OperatorLease {
 public:
  static constexpr std::int64_t kSilence_ns = 100'000'000;
  static constexpr std::int64_t kOldest_ns = 150'000'000;

  struct Counters {
    std::uint64_t taken = 0;
    std::uint64_t late = 0;       ///< too old
    std::uint64_t overtaken = 0;  ///< repeated, or by a newer one
  };

  /// Another sender: its numbers and its clock have nothing to do with the last one's.
  void begin() noexcept;
  /// True: the frame counts.
  bool hear(const LeasedFrame& frame, std::int64_t now_ns) noexcept;
  /// No frame has counted within kSilence_ns.
  bool silent(std::int64_t now_ns) const noexcept { return now_ns - heard_ns_ >= kSilence_ns; }
  /// The newest frame holds, and may.
  bool held(std::int64_t now_ns) const noexcept { return held_ && let_go_ && !silent(now_ns); }
  const Counters& counters() const noexcept { return counters_; }

 private:
  bool too_old(std::int64_t sent_ns, std::int64_t now_ns) noexcept;

  std::uint64_t newest_ = 0;
  std::int64_t heard_ns_ = std::numeric_limits<std::int64_t>::min() / 2;  ///< never
  bool held_ = false;
  bool let_go_ = false;                    ///< since the last silence
  std::optional<std::int64_t> offset_ns_;  ///< receiver's clock less the sender's, of the fastest frame
  std::int64_t offset_at_ns_ = 0;          ///< when that was known
  Counters counters_;
};

}  // namespace telekerf::master
