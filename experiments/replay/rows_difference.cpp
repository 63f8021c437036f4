// SPDX-License-Identifier: Apache-2.0
#include "experiments/replay/rows_difference.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <iterator>
#include <map>
#include <span>
#include <string_view>

namespace telekerf::experiments {
namespace {

/// Takes in the distance of a recorded row's tool from its counterpart's.
void add_distance(RowsDifference& difference, double distance_m) {
  ++difference.compared;
  difference.tool_rms_m += distance_m * distance_m;  // the sum, until all are in
  difference.tool_max_m = std::max(difference.tool_max_m, distance_m);
}

template <typename Row>
void add_different(RowsDifference& difference, const Row& was, std::string_view column) {
  if (difference.different++ > 0) return;
  difference.first_tick = static_cast<double>(was.tick);
  difference.column = column;
}

template <typename Row>
RowsDifference compare_by_number(const char* name, std::span<const Column<Row>> columns, const std::vector<Row>& was,
                                 const std::vector<Row>& is, bool virtual_time) {
  RowsDifference difference{.name = name, .recorded = was.size(), .replayed = is.size()};
  for (std::size_t n = 0; n < std::min(was.size(), is.size()); ++n) {
    add_distance(difference, (was[n].tool_m - is[n].tool_m).norm());
    const auto differs = std::find_if(columns.begin(), columns.end(), [&](const Column<Row>& column) {
      if (!virtual_time && (column.unit == "s" || column.name.ends_with("tick"))) return false;
      const double a = column.read(was[n]);
      const double b = column.read(is[n]);
      return std::memcmp(&a, &b, sizeof a) != 0;
    });
    if (differs != columns.end()) add_different(difference, was[n], differs->name);
  }
  return difference;
}

/// By the master's tick that is applied, counted from each record's first; between two replayed rows their tools'
/// mean. A row that holds, or applies what the replay passed over, has no counterpart.
RowsDifference compare_by_applied(const RunRecord& recorded, const RunRecord& replayed) {
  RowsDifference difference{.name = "slave", .recorded = recorded.slave.size(), .replayed = replayed.slave.size()};
  std::map<double, Vec3> tools;  // of the replay
  for (const SlaveRow& row : replayed.slave)
    if (row.applied >= 0.0)
      tools.try_emplace(row.applied - static_cast<double>(replayed.master.front().tick), row.tool_m);
  constexpr double kMostApart = 2.0;  // ticks between the two replayed rows
  for (const SlaveRow& row : recorded.slave) {
    const double at = row.applied - static_cast<double>(recorded.master.front().tick);
    const auto after = tools.lower_bound(at);
    if (row.applied < 0.0 || after == tools.end()) continue;
    const auto before = after->first == at || after == tools.begin() ? after : std::prev(after);
    const double apart = after->first - before->first;
    if (after->first - at > kMostApart || apart > kMostApart) continue;
    const double part = apart > 0.0 ? (at - before->first) / apart : 0.0;
    const double distance_m = (row.tool_m - before->second - part * (after->second - before->second)).norm();
    add_distance(difference, distance_m);
    if (distance_m > 0.0) add_different(difference, row, "tool");
  }
  return difference;
}

}  // namespace

std::vector<RowsDifference> compare(const RunRecord& recorded, const RunRecord& replayed, bool virtual_time) {
  const bool by_applied = !virtual_time && !recorded.master.empty() && !replayed.master.empty();
  std::vector<RowsDifference> all = {
      compare_by_number("master", master_columns(), recorded.master, replayed.master, virtual_time),
      by_applied ? compare_by_applied(recorded, replayed)
                 : compare_by_number("slave", slave_columns(), recorded.slave, replayed.slave, virtual_time)};
  for (RowsDifference& one : all)
    one.tool_rms_m = one.compared == 0 ? 0.0 : std::sqrt(one.tool_rms_m / static_cast<double>(one.compared));
  return all;
}

}  // namespace telekerf::experiments
