// SPDX-License-Identifier: Apache-2.0
// The command stream as it comes off the network: who may speak, which blocks are new, late, lost or refused,
// every sample at its place, and which of them is due now.
#pragma once

#include <memory>
#include <optional>

#include "common/codec/decoder.h"
#include "common/protocol/messages.h"
#include "common/streaming/playout.h"
#include "slave/joiner.h"

namespace telekerf::slave {

struct CommandReceiverSettings {
  PlayoutSettings playout;
  double stale_s = 0.15;                    ///< silence after which a stream is no longer fresh
  double max_acceleration_m_per_s2 = 10.0;  ///< of what bridges a gap
  std::int64_t control_period_ns = 1'000'000;
};

struct CommandReceiverCounters {
  std::uint64_t blocks = 0;
  std::uint64_t lost = 0;     ///< blocks whose number never came
  std::uint64_t stale = 0;    ///< late, reordered or repeated blocks
  std::uint64_t refused = 0;  ///< undecodable, other contour, other master, from the future
};

/// What the stream has for one control step.
struct Played {
  bool fresh = false;            ///< the stream has not dried up
  std::optional<double> cursor;  ///< stream time in samples; nothing before the play-out has begun
  bool seam = true;              ///< the stream's time did not go on by one step, as it should
  std::int64_t index = -1;
  const StreamSample* sample = nullptr;  ///< null: not there; valid until the next receive()
  KinematicState motion;                 ///< of `sample` at the cursor
};

class CommandReceiver {
 public:
  explicit CommandReceiver(const CommandReceiverSettings& settings);

  /// `contour_id`: of the contour that is known here; blocks for another one are refused.
  void receive(const Received<CommandBlock>& received, std::optional<std::uint32_t> contour_id) noexcept;
  /// Every control step, once. `tool`: as measured; bare accelerations start from it.
  Played play(std::int64_t now_ns, const KinematicState& tool) noexcept;
  /// Sample `index` was followed at this step; otherwise pass().
  void acknowledge(std::int64_t index) noexcept;
  void pass() noexcept { ++applied_age_; }

  bool heard() const noexcept { return heard_; }
  /// Newest block, without payload.
  const CommandBlock& header() const noexcept { return header_; }
  /// Control steps since a sample was followed.
  std::uint32_t applied_age() const noexcept { return applied_age_; }
  const PlayoutClock& clock() const noexcept { return clock_; }
  const CommandReceiverCounters& counters() const noexcept { return counters_; }
  /// What a state block says about the command stream.
  void describe(StateBlock& block) const noexcept;

 private:
  /// A block that a newer one has overtaken, while its samples can still be of use.
  bool catch_up(const Received<CommandBlock>& received) noexcept;
  void begin_afresh(const CommandBlock& block) noexcept;
  void store(const codec::DecodedPacket& packet, const CommandBlock& block) noexcept;
  std::optional<KinematicState> motion_at(double cursor, const KinematicState& tool) const noexcept;

  CommandReceiverSettings settings_;
  codec::BlockDecoder decoder_;
  std::unique_ptr<JitterBuffer> ring_;
  PlayoutClock clock_;
  std::optional<std::uint32_t> master_epoch_;
  std::uint32_t number_ = 0;        ///< newest block's
  std::uint32_t first_number_ = 0;  ///< of the first block since the stream was joined
  std::int64_t newest_index_ = -1;
  CommandBlock header_;
  std::int64_t last_arrival_ns_ = 0;
  bool heard_ = false;
  std::uint32_t generation_ = 0;
  bool starving_ = false;
  std::optional<double> cursor_;  ///< of the last step
  std::uint64_t applied_bitmap_ = 0;
  std::int64_t applied_index_ = -1;  ///< newest index that was followed
  std::uint32_t applied_age_ = 0;
  CommandReceiverCounters counters_;
};

}  // namespace telekerf::slave
