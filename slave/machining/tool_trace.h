// SPDX-License-Identifier: Apache-2.0
// trace.csv of automatic machining: what was wanted of the tool and what it did, every tick.
#pragma once

#include <filesystem>
#include <functional>

#include "slave/machining/path.h"

namespace telekerf::machining {

/// Metres, workpiece frame.
struct ToolTraceRow {
  Vec3 reference_m, tool_m;
  double laser_w;
};

/// `count` rows, `period_s` apart. Throws StartupError.
void write_tool_trace(const std::filesystem::path& file, double period_s, std::size_t count,
                      const std::function<ToolTraceRow(std::size_t)>& row);

}  // namespace telekerf::machining
