// SPDX-License-Identifier: Apache-2.0
// A run whose errors are known by construction.
#pragma once

#include <cmath>

#include "common/recording/run_record.h"

namespace telekerf::reporting {

/// A circle of 10 mm radius; the master runs on 20 mm (beta 0.5) `out` metres outside, the slave applies each
/// tick 30 ticks later with a radial error of `off` metres; the laser burns over the first half of the
/// circle.
inline RunRecord circle_run(double out, double off) {
  RunRecord record;
  for (int i = 0; i < 3600; ++i) {
    record.contour_m.push_back({0.01 * std::cos(i * M_PI / 1800), 0.01 * std::sin(i * M_PI / 1800)});
  }
  for (int i = 0; i < 1000; ++i) {
    const double angle = i * 2 * M_PI / 1000;
    MasterRow row;
    row.tick = 500 + static_cast<std::uint64_t>(i);
    row.t_s = i * 1e-3;
    row.tool_m = {(0.02 + out) * std::cos(angle), (0.02 + out) * std::sin(angle), 0.0};
    row.guided = row.engaged = row.joined = true;
    row.beta = 0.5;
    const double predicted = 0.5 * (0.02 + out) + off - 7e-6;
    row.predicted_m = {predicted * std::cos(angle), predicted * std::sin(angle), 0.0};
    row.force_tick = i < 100 ? -1.0 : 40 + i - 60;
    row.slave_force_n = {0.25, 0.0, i * 1e-3 - 0.060};
    record.master.push_back(row);
  }
  for (int i = 0; i < 1000; ++i) {
    const double angle = i * 2 * M_PI / 1000;
    SlaveRow row;
    row.tick = 40 + static_cast<std::uint64_t>(i);
    row.t_s = (i + 30) * 1e-3;
    row.applied = 500 + i;
    const double radius = 0.5 * (0.02 + out) + off;
    row.tool_m = {radius * std::cos(angle), radius * std::sin(angle), 0.0};
    row.ref_m = row.tool_m;
    row.settled = true;
    row.force_n = {0.26, 0.0, i * 1e-3};
    row.laser_w = i < 500 ? 4.0 : 0.0;
    record.slave.push_back(row);
  }
  record.master_figures["beta"] = 0.5;
  return record;
}

}  // namespace telekerf::reporting
