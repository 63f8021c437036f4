// SPDX-License-Identifier: Apache-2.0
// What automatic machining leaves behind: measures, the trace, the burnt workpiece.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "common/recording/run_record.h"
#include "common/workpiece/material.h"
#include "slave/machining/job.h"

namespace telekerf::machining {

/// One tick of the work.
struct WorkRow {
  std::size_t tick;                    ///< of the job's trajectory
  Vec3 tool_m, tool_velocity_m_per_s;  ///< the truth, or what is measured if nobody knows it
  double laser_w;
};

struct WorkRecord {
  std::string controller, corner, sensor;  ///< as the user chose them
  const workpiece::Material* material = &workpiece::kWood;
  double speed_m_per_s = 0.0;  ///< commanded
  DriveRecord drive;
  std::vector<WorkRow> rows{};
  int limit_violations = 0;
  bool finished = false;
};

/// Writes result.json, trace.csv, mark.png and depth.png into `folder`; returns what result.json holds, which
/// is nothing of the wall clock. Throws StartupError.
nlohmann::ordered_json report_work(const std::filesystem::path& folder, const Job& job,
                                   const WorkRecord& work);

}  // namespace telekerf::machining
