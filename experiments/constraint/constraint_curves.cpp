// SPDX-License-Identifier: Apache-2.0
#include "experiments/constraint/constraint_curves.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "common/geometry/nearest.h"
#include "experiments/constraint/constraint_trial.h"
#include "experiments/simulation/simulation.h"
#include "master/constraint/guide_path.h"

namespace telekerf::experiments {

master::StationSettings curve_station(master::CurveKind kind, int k) {
  master::StationSettings station;
  station.node.constraint.spacing_m = 0.1e-3 * station.beta;  // 0.1 mm apart for the master
  station.node.constraint.rounding_m = 0.0;
  station.node.constraint.min_radius_m = 0.0;
  station.node.constraint.window_bend_rad = 4.0;
  station.node.constraint.half_window = k;
  station.node.constraint.curve = kind;
  return station;
}

CurveError curve_error(const ContourMessage& contour, const master::StationSettings& station) {
  constexpr int kPlaces = 4000;
  const master::GuidePath guide = master::make_guide(contour, station.beta, station.node.constraint);
  geometry::Polyline truth;
  truth.closed = contour.closed;
  for (const auto& p : contour.points_m) truth.points_m.push_back(p / station.beta);
  const geometry::NearestIndex index(truth);
  std::vector<Vec2> places;
  places.reserve(kPlaces);
  const auto begin = std::chrono::steady_clock::now();
  for (int i = 0; i < kPlaces; ++i) places.push_back(guide.at(guide.length_m() * i / kPlaces).point_m);
  const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - begin;
  CurveError out;
  for (const auto& place : places) {
    const double error_m = index.find(place).distance_m;
    out.rms_m += error_m * error_m / kPlaces;
    out.max_m = std::max(out.max_m, error_m);
  }
  out.rms_m = std::sqrt(out.rms_m);
  out.cost_ns = 1e9 * spent.count() / kPlaces;
  return out;
}

std::vector<ContourMessage> table_contours() {
  std::vector<ContourMessage> out{rounded_outline(1e-3, 20e-3)};
  for (const char* picture : {"gear", "letter-e", "figure-8"}) {
    simulation::SimulationSettings settings;
    settings.image = picture;
    out.push_back(simulation::find_contour(settings));
    out.back().source = picture;
  }
  return out;
}

std::string curve_cell(double rms_um, double max_um) {
  return fmt::format("{:.2f} / {:.1f}", rms_um, max_um);
}

std::vector<std::string> push_row(double force_n, const Fight& fight) {
  return {fmt::format("{:g} N", force_n), fmt::format("{:.1f}", 1e6 * fight.pushed_off_m),
          fmt::format("{:.1f}", 1e6 * fight.overshoot_m), fmt::format("{:.3f}", fight.back_s),
          fight.saturated ? "yes" : "no"};
}

std::vector<reporting::PageTable> constraint_tables(const nlohmann::ordered_json& curves,
                                                    const std::vector<std::vector<std::string>>& pushes) {
  reporting::TableRows rows{{"curve", "k"}};
  for (const auto& at : curves) {
    const auto contour = at["contour"].get<std::string>();
    if (rows[0].back() != contour) rows[0].push_back(contour);
  }
  const auto same_row = [](const nlohmann::ordered_json& a, const nlohmann::ordered_json& b) {
    return a["curve"] == b["curve"] && a["k"] == b["k"];
  };
  for (const auto& first : curves) {
    if (first["contour"] != curves[0]["contour"]) break;
    const bool has_window = first["curve"] != "descriptor";
    rows.push_back(
        {first["curve"].get<std::string>(), has_window ? fmt::format("{}", first["k"].get<int>()) : "-"});
    for (const auto& at : curves) {
      if (same_row(at, first))
        rows.back().push_back(curve_cell(at["curve_rms_um"].get<double>(), at["curve_max_um"].get<double>()));
    }
  }
  reporting::TableRows table{
      {"hand", "pushed off, um", "to the other side, um", "back after, s", "motors at their limit"}};
  table.insert(table.end(), pushes.begin(), pushes.end());
  return {{"curves", reporting::markdown_table(rows)}, {"pushes", reporting::markdown_table(table)}};
}

}  // namespace telekerf::experiments
