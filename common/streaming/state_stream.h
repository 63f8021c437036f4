// SPDX-License-Identifier: Apache-2.0
// From the slave's samples to state blocks: positions and forces, each with its own coding.
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "common/codec/encoder.h"
#include "common/protocol/messages.h"

namespace telekerf::slave {

struct StateStreamSettings {
  codec::StreamSettings positions;  ///< m
  codec::StreamSettings forces;     ///< N; codec, block, redundancy and period are the positions'
  int ticks_per_sample = 1;
  std::int64_t control_period_ns = 1'000'000;
};

/// One control step as the master will see it, workpiece frame.
struct StateSample {
  Vec3 tool_m = Vec3::Zero();
  Vec3 velocity_m_per_s = Vec3::Zero();
  Vec3 force_n = Vec3::Zero();  ///< of the world on the tool
  bool laser_on = false;
};

struct StateStreamCounters {
  std::uint64_t states = 0;  ///< blocks reported
  std::uint64_t position_bytes = 0;
  std::uint64_t force_bytes = 0;
};

class StateStream {
 public:
  StateStream(const StateStreamSettings& settings, std::uint32_t epoch);

  /// Every control step. A block when one is full; what only the node knows is not filled in. A block that
  /// cannot be coded is not sent: the next one stands alone.
  std::optional<StateBlock> step(std::int64_t now_ns, Tick tick, const StateSample& sample) noexcept;

  /// Another codec, block length or redundancy, from where the next block begins; the rate stays. Throws
  /// StartupError.
  void change(const codec::StreamSettings& positions, const codec::StreamSettings& forces);

  const StateStreamCounters& counters() const noexcept { return counters_; }

 private:
  void take_up_changes() noexcept;
  std::optional<StateBlock> finish_block(std::int64_t now_ns) noexcept;

  StateStreamSettings settings_;
  std::uint32_t epoch_;
  std::optional<std::pair<codec::StreamSettings, codec::StreamSettings>> next_;
  codec::BlockEncoder encoder_;
  codec::BlockEncoder force_encoder_;
  std::vector<Vec3> samples_;
  std::vector<Vec3> forces_n_;
  std::size_t filled_ = 0;
  std::uint64_t laser_mask_ = 0;
  Anchor anchor_;
  Tick first_tick_ = 0;
  std::uint32_t number_ = 0;
  StateStreamCounters counters_;
};

}  // namespace telekerf::slave
