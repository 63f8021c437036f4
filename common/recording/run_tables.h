// SPDX-License-Identifier: Apache-2.0
// What a process records beside the rows of its robot (rows.h): the heads of the blocks that it sends and
// hears, what an operator asks for, and which contour is in force since when.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "common/recording/columns.h"
#include "common/recording/series.h"

namespace telekerf {

/// The head of a command or state block, when it is handed to the bus or taken by the control loop.
struct BlockRow {
  std::uint64_t tick = 0;  ///< of this process, when it was sent or taken
  double t_s = 0.0;        ///< sent, or arrived
  bool received = false;
  std::uint32_t sequence = 0;
  std::uint32_t epoch = 0;  ///< of who has sent it
  std::uint64_t first_tick = 0;
  double sent_s = 0.0;  ///< by its sender's clock
  std::uint32_t contour_id = 0;
  double beta = 1.0;
  bool engaged = false;  ///< of a command; of a state: the slave follows
  std::uint32_t stop = 0;
  std::uint32_t echo_sequence = 0;
  double applied_tick = -1.0;      ///< of a state; negative: of a command
  double interlock = -1.0;         ///< likewise
  std::uint32_t guards = 0;        ///< of a state: bit n: guard n forbids the beam
  double command_age_s = -1.0;     ///< of a state
  std::uint32_t payload_bytes = 0;
};

/// What the loop heard of an operator at a step: an event, or another emergency stop.
struct OperatorRow {
  std::uint64_t tick = 0;
  double t_s = 0.0;
  bool stop = false;        ///< `value` is the number of the emergency stop that is to be obeyed, 0: none
  std::uint32_t kind = 0;   ///< of an event, the contract's number
  std::uint32_t asker = 0;  ///< its epoch
  double value = 0.0;
};

struct InForceRow {
  std::uint64_t tick = 0;
  double t_s = 0.0;
  std::uint32_t contour_id = 0;
};

/// Another guard, mode or reason than a step before: at those steps alone.
struct GuardRow {
  std::uint64_t tick = 0;
  double t_s = 0.0;
  std::uint32_t forbidden = 0;  ///< bit n: guard n forbids the beam
  std::uint32_t mode = 0;       ///< the contract's numbers
  std::uint32_t reason = 0;
  std::uint32_t stop = 0;
};

/// Of a CommandBlock or StateBlock, which this room need not know.
template <typename Block>
BlockRow row_of(const Block& block, std::uint64_t tick, std::int64_t at_ns, bool received) noexcept {
  BlockRow row{.tick = tick, .t_s = 1e-9 * static_cast<double>(at_ns), .received = received};
  row.sequence = block.sequence;
  row.epoch = block.epoch;
  row.first_tick = block.first_tick;
  row.sent_s = 1e-9 * static_cast<double>(block.sent_ns);
  row.contour_id = block.contour_id;
  row.beta = block.beta;
  row.stop = block.stop;
  row.echo_sequence = block.echo_sequence;
  row.payload_bytes = static_cast<std::uint32_t>(block.payload.size);
  if constexpr (requires { block.applied_tick; }) {
    row.applied_tick = static_cast<double>(block.applied_tick);
    row.interlock = static_cast<double>(block.interlock);
    row.guards = block.guards;
    row.command_age_s = block.command_age_s;
    row.engaged = static_cast<int>(block.mode) == 1;  // following
    row.payload_bytes += static_cast<std::uint32_t>(block.force.size);
  } else {
    row.engaged = block.engaged;
  }
  return row;
}

/// The series `telemetry` of a process: tick, t_s, and the values with these names, whose endings say their units
/// ("tool_x_m_per_s").
SeriesSchema telemetry_schema(std::span<const std::string> names);

std::span<const Column<BlockRow>> block_columns();
std::span<const Column<GuardRow>> guard_columns();
std::span<const Column<OperatorRow>> operator_columns();
std::span<const Column<InForceRow>> in_force_columns();

}  // namespace telekerf
