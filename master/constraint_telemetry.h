// SPDX-License-Identifier: Apache-2.0
// What the constraint does, as named numbers for console and recorder, handed from the loop to another thread
// without a lock.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <optional>

#include "common/bus/messages.h"
#include "master/master_node.h"

namespace telekerf::master {

inline constexpr std::array<const char*, 14> kConstraintValues{
    "mode",       "tool_x_m",       "tool_y_m",   "constraint_n",       "phi_m",
    "corridor_m", "circle_is_line", "circle_x_m", "circle_y_m",         "circle_radius_m",
    "tangent_x",  "tangent_y",      "arc_m",      "speed_limit_m_per_s"};
using ConstraintValues = std::array<double, kConstraintValues.size()>;

/// In the order of kConstraintValues. Circle and tangent in the master's workpiece frame; of a line,
/// circle_x_m and circle_y_m are a point on it and the radius is zero.
ConstraintValues constraint_values(const MasterOutputs& out) noexcept;

/// The newest values of one writer, for any number of readers. The writer never waits.
class ConstraintSnapshot {
 public:
  void store(Tick tick, const ConstraintValues& values) noexcept;
  /// None while the writer is just at it (ask again later) or has not begun.
  std::optional<TelemetryMessage> load() const;

 private:
  std::atomic<std::uint64_t> version_{0};  // odd while values change
  std::atomic<Tick> tick_{0};
  std::array<std::atomic<double>, kConstraintValues.size()> values_{};
};

}  // namespace telekerf::master
