// SPDX-License-Identifier: Apache-2.0
// What the slave tells of itself: measured positions and forces, each with its own coding, and what became of
// the commands.
#pragma once

#include <optional>

#include "common/protocol/messages.h"
#include "common/streaming/acknowledgement.h"
#include "common/streaming/command_receiver.h"
#include "common/streaming/packetizer.h"

namespace telekerf::slave {

struct StateReportSettings {
  codec::StreamSettings positions;  ///< m
  codec::StreamSettings forces;     ///< N; codec, block, redundancy and period are the positions'
  int ticks_per_sample = 1;
  std::int64_t control_period_ns = 1'000'000;
};

/// One control step as the master will see it, workpiece frame.
struct ReportSample {
  Vec3 tool_m = Vec3::Zero();
  Vec3 velocity_m_per_s = Vec3::Zero();
  Vec3 force_n = Vec3::Zero();  ///< of the world on the tool
  bool laser_on = false;
  Interlock interlock = Interlock::kNoContour;
  std::uint32_t contour_id = 0;  ///< 0: none is known
  SlaveMode mode = SlaveMode::kWaiting;
  HoldReason reason = HoldReason::kNoCommands;
  std::uint32_t engage_spent = 0;  ///< engagements up to this one are not followed any more
  std::uint32_t stop = 0;          ///< number of the emergency stop that is obeyed; 0: none
  Tick stop_tick = 0;              ///< since when
  std::uint32_t guards = 0;        ///< bit n: guard n forbids the beam
  double command_age_s = -1.0;     ///< negative: none is applied
};

struct StateReportCounters {
  std::uint64_t states = 0;  ///< blocks reported
  std::uint64_t position_bytes = 0;
  std::uint64_t force_bytes = 0;
};

class StateReport {
 public:
  /// Throws StartupError.
  StateReport(const StateReportSettings& settings, std::uint32_t epoch);

  /// Every control step. A block when one is full. One that cannot be coded is not sent: the next one stands
  /// alone.
  std::optional<StateBlock> step(std::int64_t now_ns, Tick tick, const ReportSample& sample,
                                 const streaming::CommandReceiver& commands,
                                 const streaming::Acknowledgement& acknowledgement) noexcept;

  /// Another codec, block length or redundancy, from where the next block begins; the rate stays. Throws
  /// StartupError.
  void change(const codec::StreamSettings& positions, codec::StreamSettings forces);

  const StateReportCounters& counters() const noexcept { return counters_; }

 private:
  Tick ticks_per_sample_;
  streaming::Packetizer positions_;
  streaming::Packetizer forces_;
  StateReportCounters counters_;
};

}  // namespace telekerf::slave
