// SPDX-License-Identifier: Apache-2.0
// trace.csv of automatic machining: what was wanted of the tool and what it did, every tick.
#pragma once

#include <filesystem>
#include <functional>
#include <span>

#include "common/recording/columns.h"
#include "common/runtime/vectors.h"

namespace telekerf::machining {

/// Workpiece frame.
struct ToolTraceRow {
  Vec3 reference_m = Vec3::Zero();
  Vec3 tool_m = Vec3::Zero();
  double laser_w = 0.0;
  double t_s = 0.0;
};

std::span<const Column<ToolTraceRow>> tool_trace_columns();

/// `count` rows, `period_s` apart. Throws StartupError.
void write_tool_trace(const std::filesystem::path& file, double period_s, std::size_t count,
                      const std::function<ToolTraceRow(std::size_t)>& row);

}  // namespace telekerf::machining
