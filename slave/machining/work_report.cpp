// SPDX-License-Identifier: Apache-2.0
#include "slave/machining/work_report.h"

#include "common/runtime/results.h"
#include "slave/machining/contour_pass.h"
#include "slave/machining/tool_trace.h"

namespace telekerf::machining {
namespace {

/// What was cut of each contour.
std::vector<ContourPass> passes_of(const Job& job, const std::vector<WorkRow>& rows) {
  std::vector<ContourPass> passes;
  bool cutting = false;
  for (const WorkRow& row : rows) {
    const bool cut = job.phases[row.tick] == JobPhase::kCut;
    if (cut && !cutting) passes.push_back({&job.plans[passes.size()], &job.lines[passes.size()], {}});
    cutting = cut;
    const Reference& reference = job.trajectory[row.tick];
    if (cut && reference.beam)
      passes.back().rows.push_back(pass_row(reference, row.tool_m, row.tool_velocity_m_per_s, row.laser_w));
  }
  return passes;
}

}  // namespace

nlohmann::ordered_json report_work(const std::filesystem::path& folder, const Job& job,
                                   const WorkRecord& work) {
  const std::vector<ContourPass> passes = passes_of(job, work.rows);
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
  result["burn"] = burn(passes, *work.material, folder);
  write_tool_trace(folder / "trace.csv", job.period_s, work.rows.size(), [&](std::size_t i) {
    const WorkRow& row = work.rows[i];
    return ToolTraceRow{job.trajectory[row.tick].position_m, row.tool_m, row.laser_w};
  });
  write_json(folder / "result.json", result);
  return result;
}

}  // namespace telekerf::machining
