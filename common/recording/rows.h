// SPDX-License-Identifier: Apache-2.0
// What a run's processes record: one row a tick of each robot, and the tables of their columns. SI; the
// master's tool in the master's workpiece frame, everything of the slave in the workpiece frame.
#pragma once

#include <cstdint>
#include <span>

#include "common/recording/columns.h"
#include "common/runtime/vectors.h"

namespace telekerf {

struct MasterRow {
  std::uint64_t tick = 0;
  double t_s = 0.0;
  Vec3 tool_m = Vec3::Zero();  ///< true tool, or the measured one (DriveRecord)
  Vec3 hand_n = Vec3::Zero();  ///< hand force on the tool; of a real hand what is estimated
  double constraint_n = 0.0;   ///< force by which the constraint answers, across the curve
  bool guided = false;         ///< on the constraint, the hand moves it
  bool engaged = false;        ///< the slave follows
  bool button = false;
  Vec3 predicted_m = Vec3::Zero();  ///< slave's tool when it applies this tick, as predicted
  bool joined = false;       ///< engaged, and nothing is left of the approach of the slave to the master
  double beta = 1.0;         ///< slave motion = beta x master motion; may change during a run
  double force_tick = -1.0;  ///< slave tick of the force below; negative: none is known
  Vec3 slave_force_n = Vec3::Zero();  ///< on the slave's tool, as fed back
};

struct SlaveRow {
  std::uint64_t tick = 0;
  double t_s = 0.0;
  double applied = -1.0;       ///< master tick being applied; negative: none (holding)
  Vec3 ref_m = Vec3::Zero();   ///< commanded reference
  Vec3 tool_m = Vec3::Zero();  ///< true tool, or the measured one (DriveRecord)
  double laser_w = 0.0;
  int interlock = 0;
  bool settled = false;         ///< following, and no offset of an approach is left
  Vec3 force_n = Vec3::Zero();  ///< estimated, of the world on the tool
};

std::span<const Column<MasterRow>> master_columns();  ///< of master.csv
std::span<const Column<SlaveRow>> slave_columns();    ///< of slave.csv
std::span<const Column<Vec2>> contour_columns();      ///< of contour.csv; a point is a row

}  // namespace telekerf
