// SPDX-License-Identifier: Apache-2.0
#include "slave/machining/tool_trace.h"

#include <fmt/format.h>

#include <string>

#include "common/runtime/results.h"

namespace telekerf::machining {

void write_tool_trace(const std::filesystem::path& file, double period_s, std::size_t count,
                      const std::function<ToolTraceRow(std::size_t)>& row) {
  std::string text = "t_s,ref_x_m,ref_y_m,tool_x_m,tool_y_m,tool_z_m,laser_w\n";
  for (std::size_t i = 0; i < count; ++i) {
    const ToolTraceRow r = row(i);
    text += fmt::format("{:.7f},{:.12f},{:.12f},{:.12f},{:.12f},{:.12f},{:.6g}\n",
                        static_cast<double>(i) * period_s, r.reference_m.x(), r.reference_m.y(), r.tool_m.x(),
                        r.tool_m.y(), r.tool_m.z(), r.laser_w);
  }
  write_atomically(file, text);
}

}  // namespace telekerf::machining
