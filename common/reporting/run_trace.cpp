// SPDX-License-Identifier: Apache-2.0
#include "common/reporting/run_trace.h"

#include <fmt/format.h>

#include <string>

#include "common/reporting/run_lookup.h"
#include "common/runtime/results.h"

namespace telekerf::reporting {

void write_run_trace(const std::filesystem::path& file, const RunRecord& record) {
  std::string out =
      "t_s,master_x_m,master_y_m,master_z_m,ref_x_m,ref_y_m,tool_x_m,tool_y_m,tool_z_m,laser_w,"
      "force_x_n,force_y_n,force_z_n\n";
  for (const auto& row : record.slave) {
    // The master's tool at the tick that the slave applies; before the first one there is nothing to show.
    const auto master =
        row.applied >= 0.0 ? master_at(record, row.applied, &MasterRow::tool_m) : std::nullopt;
    if (!master) continue;
    out += fmt::format(
        "{:.6f},{:.9f},{:.9f},{:.9f},{:.9f},{:.9f},{:.9f},{:.9f},{:.9f},{},{:.5f},{:.5f},{:.5f}\n",
        row.t_s - record.slave.front().t_s, master->x(), master->y(), master->z(), row.ref_m[0], row.ref_m[1],
        row.tool_m[0], row.tool_m[1], row.tool_m[2], row.laser_w, row.force_n[0], row.force_n[1],
        row.force_n[2]);
  }
  write_atomically(file, out);
}

}  // namespace telekerf::reporting
