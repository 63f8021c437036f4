// SPDX-License-Identifier: Apache-2.0
// The slave's end of the command stream: blocks in as they come, and at each control step the sample that is
// due, gaps concealed.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <optional>

#include "common/streaming/acknowledgement.h"
#include "common/streaming/echo_log.h"
#include "common/streaming/jitter_buffer.h"
#include "common/streaming/playout_clock.h"
#include "common/streaming/stream_receiver.h"

namespace telekerf::streaming {

struct CommandReceiverSettings {
  PlayoutSettings playout;
  double timeout_s = 0.15;                  ///< silence after which a stream is no longer fresh
  double max_acceleration_m_per_s2 = 10.0;  ///< of what conceals a gap
  std::int64_t control_period_ns = 1'000'000;
  /// Commands older than this are of little use; where they are, the play-out gives up what delay it can.
  double beam_age_s = std::numeric_limits<double>::infinity();
};

/// What the stream has for one control step.
struct Played {
  bool begins = false;           ///< the stream began anew since the last step
  bool fresh = false;            ///< the stream has not dried up
  std::optional<double> cursor;  ///< stream time in samples; nothing before the play-out has begun
  double tick = -1.0;            ///< the cursor in master ticks
  bool discontinuity = true;     ///< the stream's time did not go on by one step, as it should
  bool waits = false;            ///< what is due has not come for a while, and time stands until it has
  std::int64_t index = -1;
  const StreamSample* sample = nullptr;  ///< null: not there; valid until the next receive()
  KinematicState state;                  ///< of `sample` at the cursor
  /// Of `sample`, s, an upper bound by this side's clock. None: it echoes no state of this side.
  std::optional<double> age_s;
};

/// No allocation, lock or throw after construction.
class CommandReceiver {
 public:
  explicit CommandReceiver(const CommandReceiverSettings& settings);

  /// `contour_id`: of the contour that is known here; blocks for another one are refused. `now_ns`: of the
  /// step that takes the block.
  void receive(const Received<CommandBlock>& received, std::optional<std::uint32_t> contour_id,
               std::int64_t now_ns) noexcept;
  /// Every control step, once. `tool`: as measured; bare accelerations start from it.
  Played play(std::int64_t now_ns, const KinematicState& tool) noexcept;

  /// A state block leaves: commands may echo it from now on.
  void state_sent(std::uint32_t sequence, std::int64_t sent_ns) noexcept { echoes_.sent(sequence, sent_ns); }

  bool heard() const noexcept { return stream_.heard(); }
  /// Since the newest block came.
  double silent_s(std::int64_t now_ns) const noexcept { return stream_.silent_s(now_ns); }
  /// Of the newest block.
  const CommandHeader& header() const noexcept { return stream_.header(); }
  const PlayoutClock& clock() const noexcept { return clock_; }
  const StreamCounters& counters() const noexcept { return stream_.counters(); }
  /// What a state block says about the command stream, and about what became of it.
  void describe(const Acknowledgement& acknowledgement, StateHeader& header) const noexcept;

 private:
  /// No step was made for so long that its time is given up.
  bool asleep(std::int64_t now_ns) const noexcept;
  /// What the steps have lost by `now_ns`.
  void keep_time(std::int64_t now_ns) noexcept;
  std::optional<KinematicState> state_at(double cursor, const KinematicState& tool) const noexcept;
  /// `missing`: what is due is not there. For a while time goes on; then it stands at what came last, until
  /// more has come.
  void wait_for(bool missing, Played& out) noexcept;
  /// Time that goes slower or faster makes the motion slower or faster.
  void keep_pace(Played& out) noexcept;

  CommandReceiverSettings settings_;
  StreamReceiver<CommandBlock> stream_;
  std::unique_ptr<JitterBuffer> buffer_;
  PlayoutClock clock_;
  EchoLog echoes_;
  std::optional<std::int64_t> played_ns_;  ///< when the last step was made
  bool begins_ = false;
  std::optional<double> cursor_;      ///< of the last step
  double pace_ = 1.0;                 ///< by how much it went on in that step, of what is usual
  std::optional<std::int64_t> next_;  ///< index after the last sample that was played
  double missing_s_ = 0.0;            ///< since then
};

}  // namespace telekerf::streaming
