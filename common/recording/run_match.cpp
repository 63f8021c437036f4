// SPDX-License-Identifier: Apache-2.0
#include "common/recording/run_match.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "common/recording/run_folder.h"
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

std::optional<std::string> difference_of_heads(const RunIdentity& ours, const RunIdentity& theirs) {
  if (ours.cell != theirs.cell) return fmt::format("cell {} and cell {}", ours.cell, theirs.cell);
  if (ours.virtual_time != theirs.virtual_time) return "one is of virtual time, the other of a real clock";
  return std::nullopt;
}

std::optional<std::string> difference_of(const RunReader& master, const RunReader& slave) {
  const RunIdentity& ours = master.identity();
  const RunIdentity& theirs = slave.identity();
  if (auto difference = difference_of_heads(ours, theirs)) return difference;
  if (ours.virtual_time && ours.settings != theirs.settings) return "their settings differ";
  if (auto difference = difference_of_contours(master, slave)) return difference;
  if (auto difference = difference_of_epochs(master, slave)) return difference;
  return difference_of_times(master, slave);
}

/// First and last date of all that is in it, s since 1970; none: nothing is.
std::optional<std::pair<double, double>> dates_of(const RunReader& reader) {
  std::optional<std::pair<double, double>> span;
  const auto take = [&span](double t_s) {
    span = span ? std::pair(std::min(span->first, t_s), std::max(span->second, t_s)) : std::pair(t_s, t_s);
  };
  for (std::size_t n = 0; n < reader.series().size(); ++n) {
    if (const auto of_series = reader.span_s(n)) {
      take(of_series->first);
      take(of_series->second);
    }
  }
  for (const RunEvent& event : reader.events()) take(event.t_s);
  for (const RunContour& contour : reader.contours()) take(contour.t_s);
  const double zero_s = 1e-9 * static_cast<double>(reader.identity().utc_at_zero_ns);
  if (span) span = std::pair(span->first + zero_s, span->second + zero_s);
  return span;
}

/// Of a robot's side and any other process, or of two others.
std::optional<std::string> difference_of_others(const RunReader& first, const RunReader& other) {
  if (auto difference = difference_of_heads(first.identity(), other.identity())) return difference;
  const auto dates = dates_of(first), others = dates_of(other);
  if (first.identity().virtual_time || !dates || !others) return std::nullopt;
  const double apart_s = std::max(others->first - dates->second, dates->first - others->second);
  if (apart_s <= kDateTolerance_s) return std::nullopt;
  return fmt::format("they are {:.0f} s apart in time", apart_s);
}

[[noreturn]] void refuse(const RunReader& one, const RunReader& other, const std::string& difference) {
  throw input_error(fmt::format("{} and {}: are not of the same run: {}; name the folders of one run",
                                one.file().string(), other.file().string(), difference));
}

}  // namespace

void refuse_unrelated(std::span<const std::filesystem::path> folders) {
  std::optional<RunReader> first;
  for (const char* role : kRecordedRoles) {
    // Of the robots' sides what a killed process has left is finished; the others may still be at it.
    const bool robot = role == std::string_view("master") || role == std::string_view("slave");
    const auto file = robot ? recording_of(role, folders) : find_recording(role, folders);
    if (!file) continue;
    if (!first) {
      first.emplace(*file, RunReader::Check::kHead);
      continue;
    }
    const RunReader other(*file, RunReader::Check::kHead);
    if (first->identity().role == "master" && other.identity().role == "slave") {
      refuse_unrelated(*first, other);
    } else if (const auto difference = difference_of_others(*first, other)) {
      refuse(*first, other, *difference);
    }
  }
}

void refuse_unrelated(const RunReader& master, const RunReader& slave) {
  if (const auto difference = difference_of(master, slave)) refuse(master, slave, *difference);
}

}  // namespace telekerf
