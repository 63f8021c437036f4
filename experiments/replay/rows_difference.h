// SPDX-License-Identifier: Apache-2.0
// How the rows of a replay differ from those of the run.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/recording/run_record.h"

namespace telekerf::experiments {

/// How the rows of a replay differ from the recorded ones: bit by bit, times and ticks aside where the run was real.
/// Rows stand for each other that have the same number; of a real run's slave, whose loop has clocks and delays of its
/// own: those that apply the same tick of the master.
struct RowsDifference {
  std::string name;
  std::uint64_t recorded = 0;
  std::uint64_t replayed = 0;
  std::uint64_t compared = 0;   ///< recorded rows that have a counterpart
  std::uint64_t different = 0;  ///< of these
  double first_tick = -1.0;     ///< of the different ones
  std::string column = {};      ///< the first that differs there
  double tool_rms_m = 0.0;      ///< of the tool's distance, over the compared ones
  double tool_max_m = 0.0;
  bool identical() const { return recorded == replayed && different == 0; }
};
std::vector<RowsDifference> compare(const RunRecord& recorded, const RunRecord& replayed, bool virtual_time);

}  // namespace telekerf::experiments
