// SPDX-License-Identifier: Apache-2.0
#include "slave/automatic/work_report.h"

#include <fmt/format.h>

#include <fstream>

#include "common/runtime/refusal.h"
#include "common/runtime/results.h"
#include "slave/automatic/pass.h"

namespace telekerf::slave {
namespace {

/// What was cut of each contour.
std::vector<Pass> passes_of(const Job& job, const std::vector<WorkRow>& rows) {
  std::vector<Pass> passes;
  bool cutting = false;
  for (const WorkRow& row : rows) {
    const bool cut = job.phases[row.tick] == JobPhase::kCut;
    if (cut && !cutting) passes.push_back({&job.plans[passes.size()], &job.lines[passes.size()], {}});
    cutting = cut;
    const Reference& reference = job.track[row.tick];
    if (cut && reference.beam)
      passes.back().rows.push_back(pass_row(reference, row.tool_m, row.tool_velocity_m_per_s, row.laser_w));
  }
  return passes;
}

void write_trace(const std::filesystem::path& file, const Job& job, const std::vector<WorkRow>& rows) {
  std::ofstream trace(file);
  trace << "t_s,ref_x_m,ref_y_m,tool_x_m,tool_y_m,tool_z_m,laser_w\n";
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Vec3& reference_m = job.track[rows[i].tick].position_m;
    const Vec3& tool_m = rows[i].tool_m;
    trace << fmt::format("{:.7f},{:.12f},{:.12f},{:.12f},{:.12f},{:.12f},{:.6g}\n",
                         static_cast<double>(i) * job.period_s, reference_m.x(), reference_m.y(), tool_m.x(),
                         tool_m.y(), tool_m.z(), rows[i].laser_w);
  }
  if (!trace.flush()) throw Refusal(fmt::format("{}: cannot be written", file.string()));
}

}  // namespace

nlohmann::ordered_json report_work(const std::filesystem::path& folder, const Job& job,
                                   const WorkRecord& work) {
  const std::vector<Pass> passes = passes_of(job, work.rows);
  nlohmann::ordered_json result{{"finished", work.finished},
                                {"controller", work.controller},
                                {"corner", work.corner},
                                {"drive", words_of(work.drive)},
                                {"sensor", work.sensor},
                                {"contours", job.plans.size()},
                                {"order", job.order},
                                {"contours_cut", passes.size()},
                                {"length_mm", job.cut_length_m * 1e3}};
  if (!work.drive.true_tool) result["sensor"] = nullptr;  // the machine's own, whatever it is
  result.update(measure(passes, work.speed_m_per_s));
  result["limit_violations"] = work.limit_violations;
  result["time_s"] = static_cast<double>(work.rows.size()) * job.period_s;
  result["time_estimate_s"] = job.time_s();
  result["burn"] = burn(passes, work.material, folder);
  write_trace(folder / "trace.csv", job, work.rows);
  write_json(folder / "result.json", result);
  return result;
}

}  // namespace telekerf::slave
