// SPDX-License-Identifier: Apache-2.0
// What the constraint does and what the network observer thinks, as named numbers for console and recorder,
// handed from the loop to another thread without a lock.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <optional>

#include "common/protocol/messages.h"
#include "master/master_node.h"
#include "master/stream_choice.h"

namespace telekerf::master {

inline constexpr std::array kMasterValueNames{
    // The constraint.
    "mode", "tool_x_m", "tool_y_m", "constraint_n", "phi_m", "corridor_m", "off_line", "circle_is_line",
    "circle_x_m", "circle_y_m", "circle_radius_m", "tangent_x", "tangent_y", "arc_m", "speed_limit_m_per_s", "beta",
    // The network observer.
    "slave_x_m", "slave_y_m", "slave_z_m", "slave_x_m_per_s", "slave_y_m_per_s", "slave_z_m_per_s",
    "disturbance_x_m_per_s2", "disturbance_y_m_per_s2", "disturbance_z_m_per_s2", "innovation_x_m",
    "innovation_y_m", "innovation_z_m", "delay_s", "joined",
    // The clocks.
    "clock_offset_s", "clock_skew", "clock_uncertainty_s",
    // The force on the slave's tool; not known: nothing came, or nothing comes any more.
    "force_known", "force_x_n", "force_y_n", "force_z_n",
    // The tool's motion, the hand's force on it as it is estimated, and the network alone, there and back.
    "tool_x_m_per_s", "tool_y_m_per_s", "hand_x_n", "hand_y_n", "round_trip_s",
    // The command stream: law, estimator and codec by the rows of their tables.
    "law", "estimator", "codec", "block", "keep", "redundancy"};
using MasterValues = std::array<double, kMasterValueNames.size()>;

/// In the order of kMasterValueNames. Circle and tangent in the master's workpiece frame; of a line,
/// circle_x_m and circle_y_m are a point on it and the radius is zero. `off_line`: 1: so far off the contour that the
/// button is not passed on. `slave_`: predicted for the tick at which the command made now acts, slave's workpiece
/// frame. `clock_`: slave's clock against the master's. `round_trip_s`: the newest.
MasterValues master_values(const MasterOutputs& out, double beta, const streaming::ClockEstimate& clocks,
                           double round_trip_s, const StreamChoice& stream) noexcept;

/// The newest values of one writer, for any number of readers. The writer never waits.
class Snapshot {
 public:
  void store(Tick tick, const MasterValues& values) noexcept;
  /// None while the writer is just at it (ask again later) or has not begun.
  std::optional<TelemetryMessage> load() const;

 private:
  std::atomic<std::uint64_t> version_{0};  // odd while values change
  std::atomic<Tick> tick_{0};
  std::array<std::atomic<double>, kMasterValueNames.size()> values_{};
};

}  // namespace telekerf::master
