// SPDX-License-Identifier: Apache-2.0
// How near circles, lines or the descriptor come to a contour, over k; and the tables of
// docs/results/constraint.md.
#pragma once

#include <nlohmann/json.hpp>
#include <vector>

#include "common/protocol/messages.h"
#include "common/reporting/page_tables.h"
#include "experiments/constraint/constraint_acceptance.h"
#include "master/station_settings.h"

namespace telekerf::experiments {

struct CurveError {
  double rms_m = 0.0;
  double max_m = 0.0;
  double cost_ns = 0.0;  ///< of finding the curve once, on this machine
};

/// Points 0.1 mm apart for the master, corners neither rounded nor opened, windows as wide as k says.
master::StationSettings curve_station(master::CurveKind kind, int k);

/// Distance of the curve from contour / beta at 4,000 places.
CurveError curve_error(const ContourMessage& contour, const master::StationSettings& station);

/// Contours of the table, a column each, by their sources' names.
std::vector<ContourMessage> table_contours();
/// k of the rows; the descriptor has none.
inline constexpr std::array kTableWindows{1, 2, 4, 8, 16, 32};
inline constexpr std::array kTablePushes_n{3.0, 10.0, 20.0, 30.0, 40.0, 60.0};

/// "1.61 / 20.6": rms / largest, um.
std::string curve_cell(double rms_um, double max_um);
/// "9.1", "8.7", "0.000": pushed off and overshoot in um, time until back in s.
std::vector<std::string> push_row(double force_n, const Fight& fight);

/// `curves` of the rows of constraint.json's table, and `pushes`.
std::vector<reporting::PageTable> constraint_tables(const nlohmann::ordered_json& curves,
                                                    const std::vector<std::vector<std::string>>& pushes);

}  // namespace telekerf::experiments
