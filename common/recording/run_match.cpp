// SPDX-License-Identifier: Apache-2.0
#include "common/recording/run_match.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <string>
#include <utility>

#include "common/recording/run_tables.h"
#include "common/runtime/startup_error.h"

namespace telekerf {
namespace {

constexpr double kDateTolerance_s = 60.0;

/// First and last stamp of a role's rows, s; none: it has no rows.
std::optional<std::pair<double, double>> span_of(const RunReader& reader) {
  for (std::size_t n = 0; n < reader.series().size(); ++n)
    if (reader.series()[n].schema.name == reader.identity().role) return reader.span_s(n);
  return std::nullopt;
}

std::optional<std::string> difference_of_contours(const RunReader& master, const RunReader& slave) {
  const auto theirs = slave.contours();
  for (const RunContour& ours : master.contours()) {
    const auto same =
        std::find_if(theirs.begin(), theirs.end(), [&](const RunContour& c) { return c.id == ours.id; });
    if (same != theirs.end() && (same->points_m != ours.points_m || same->closed != ours.closed))
      return fmt::format("contour {} is another one there", ours.id);
  }
  return std::nullopt;
}

std::optional<std::string> difference_of_epochs(const RunReader& master, const RunReader& slave) {
  const auto data = slave.data("blocks");
  if (!data) return std::nullopt;
  const auto blocks = rows_of(*data, block_columns());
  const auto heard = std::find_if(blocks.begin(), blocks.end(), [](const BlockRow& b) { return b.received; });
  if (heard == blocks.end()) return std::nullopt;
  const bool of_this = std::any_of(blocks.begin(), blocks.end(), [&](const BlockRow& b) {
    return b.received && b.epoch == master.identity().epoch;
  });
  if (of_this) return std::nullopt;
  return fmt::format("the slave heard master {}, this is master {}", heard->epoch, master.identity().epoch);
}

std::optional<std::string> difference_of_times(const RunReader& master, const RunReader& slave) {
  const auto ours = span_of(master);
  const auto theirs = span_of(slave);
  if (!ours || !theirs || master.identity().virtual_time) return std::nullopt;
  const auto& figures = master.identity().figures;
  const auto compared = figures.find("clock_offset_us");
  const double offset_s =
      compared != figures.end()
          ? 1e-6 * compared->second
          : 1e-9 * static_cast<double>(master.identity().utc_at_zero_ns - slave.identity().utc_at_zero_ns);
  const double tolerance_s = compared != figures.end() ? 0.0 : kDateTolerance_s;
  const double apart_s =
      std::max(theirs->first - offset_s - ours->second, ours->first - (theirs->second - offset_s));
  if (apart_s <= tolerance_s) return std::nullopt;
  return fmt::format("they are {:.1f} s apart in time", apart_s);
}

std::optional<std::string> difference_of(const RunReader& master, const RunReader& slave) {
  const RunIdentity& ours = master.identity();
  const RunIdentity& theirs = slave.identity();
  if (ours.cell != theirs.cell) return fmt::format("cell {} and cell {}", ours.cell, theirs.cell);
  if (ours.virtual_time != theirs.virtual_time) return "one is of virtual time, the other of a real clock";
  if (ours.virtual_time && ours.settings != theirs.settings) return "their settings differ";
  if (auto difference = difference_of_contours(master, slave)) return difference;
  if (auto difference = difference_of_epochs(master, slave)) return difference;
  return difference_of_times(master, slave);
}

}  // namespace

void refuse_unrelated(const RunReader& master, const RunReader& slave) {
  if (const auto difference = difference_of(master, slave))
    throw input_error(fmt::format("{} and {}: are not of the same run: {}; name the folders of one run",
                                  master.file().string(), slave.file().string(), *difference));
}

}  // namespace telekerf
