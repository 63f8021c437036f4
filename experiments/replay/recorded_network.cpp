// SPDX-License-Identifier: Apache-2.0
#include "experiments/replay/recorded_network.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace telekerf::experiments {

std::vector<RecordedBlock> recorded_blocks(std::span<const BlockRow> sent, std::span<const BlockRow> heard,
                                           std::uint64_t from_tick, double later_s) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, double> arrived_s;  // by epoch and number
  for (const BlockRow& row : heard)
    if (row.received) arrived_s.emplace(std::pair(row.epoch, row.sequence), row.t_s - later_s);
  std::vector<RecordedBlock> blocks;
  for (const BlockRow& row : sent) {
    if (row.received || row.tick < from_tick) continue;
    const auto found = arrived_s.find({row.epoch, row.sequence});
    const bool lost = found == arrived_s.end();
    blocks.push_back({row.tick - from_tick, lost ? 0.0 : std::max(0.0, found->second - row.t_s), lost});
  }
  return blocks;
}

netem::Recording trace_of(std::span<const RecordedBlock> blocks, double start_s, double period_s) {
  netem::Recording recording;
  double half_s = 0.0;
  for (std::size_t n = 0; n < blocks.size(); ++n) {
    const double at_s = start_s + static_cast<double>(blocks[n].tick) * period_s;
    if (n + 1 < blocks.size())
      half_s = 0.5 * static_cast<double>(blocks[n + 1].tick - blocks[n].tick) * period_s;
    recording.push_back({.in_ns = std::max<std::int64_t>(0, std::llround(1e9 * (at_s - half_s))),
                         .delay_ns = std::llround(1e9 * blocks[n].delay_s),
                         .lost = blocks[n].lost});
  }
  return recording;
}

}  // namespace telekerf::experiments
