// SPDX-License-Identifier: Apache-2.0
#include "common/reporting/run_trace.h"

#include <fmt/format.h>

#include <string>

#include "common/reporting/run_lookup.h"
#include "common/reporting/tracking_error.h"
#include "common/runtime/results.h"

namespace telekerf::reporting {
namespace {

std::string cells(const Vec3& point_m) {
  return fmt::format("{:.9f},{:.9f},{:.9f}", point_m.x(), point_m.y(), point_m.z());
}

}  // namespace

void write_run_trace(const std::filesystem::path& file, const RunRecord& record) {
  std::string out =
      "t_s,master_x_m,master_y_m,master_z_m,ref_x_m,ref_y_m,tool_x_m,tool_y_m,tool_z_m,laser_w,"
      "force_x_n,force_y_n,force_z_n,applied_tick,beta,predicted_x_m,predicted_y_m,predicted_z_m,settled\n";
  for (const auto& row : record.slave) {
    // What the master knew at the tick that the slave applies; empty where it applies none.
    const auto master_m =
        row.applied >= 0.0 ? master_at(record, row.applied, &MasterRow::tool_m) : std::nullopt;
    std::string applied = ",,,,";
    if (master_m) {
      applied = fmt::format("{},{},{}", row.applied, beta_at(record, row.applied),
                            cells(*master_at(record, row.applied, &MasterRow::predicted_m)));
    }
    out += fmt::format("{:.6f},{},{:.9f},{:.9f},{},{},{:.5f},{:.5f},{:.5f},{},{}\n",
                       row.t_s - record.slave.front().t_s, master_m ? cells(*master_m) : ",,", row.ref_m[0],
                       row.ref_m[1], cells(row.tool_m), row.laser_w, row.force_n[0], row.force_n[1],
                       row.force_n[2], applied, settled_at(record, row) ? 1 : 0);
  }
  write_atomically(file, out);
}

}  // namespace telekerf::reporting
