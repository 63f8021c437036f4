// SPDX-License-Identifier: Apache-2.0
// What the autofocus experiment found, in figures: rows of strategies, zoom steps, what must not be found.
#pragma once

#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "common/reporting/page_tables.h"
#include "experiments/acceptance.h"
#include "experiments/autofocus/focus_hold.h"
#include "experiments/autofocus/focus_rivals.h"
#include "experiments/autofocus/focus_zoom.h"

namespace telekerf::experiments {

/// One strategy over all starts.
struct StrategyRow {
  std::string name;
  std::size_t starts = 0;
  std::size_t successes = 0;
  std::size_t false_locks = 0;  ///< claimed, and more than a depth of field off
  int pictures_p50 = 0;
  int pictures_max = 0;
  double error_rms_dof = 0.0;  ///< of the successes
  double error_max_dof = 0.0;
  double success_rate() const noexcept;
};

/// Starts that hold no focus: how many were given up, as they must.
struct RefusedRow {
  std::string name;
  std::size_t starts = 0;
  std::size_t refused = 0;
  std::map<imaging::FocusVerdict, std::size_t> reasons{};  ///< of those refused
};

/// One start of one strategy.
struct StartRecord {
  std::string strategy;
  std::string kind;  ///< usual, blank, out_of_range or moving
  std::string target;
  std::uint64_t seed = 0;
  double offset_dof = 0.0;  ///< true defocus at the start
  FocusOutcome outcome;
};
/// The focus kept on a target that stands still, over several seeds.
struct HoldRow {
  std::string target;
  std::size_t runs = 0;
  std::size_t lost = 0;
  ErrorStatistics all_dof{};     ///< true defocus at every picture,
  ErrorStatistics passed_dof{};  ///< at those that are passed on as in focus
};

/// One step of the magnification.
struct ZoomRecord {
  std::string target;
  std::uint64_t seed = 0;
  int step = 0;
  ZoomStep zoom;
};

struct FocusFigures {
  std::string law;
  double depth_of_field_m = 0.0;  ///< half way up the magnification axis
  std::vector<StrategyRow> rows;  ///< the chosen law first
  std::vector<RefusedRow> refused;
  std::size_t zooms = 0;
  std::size_t zooms_found = 0;
  int zoom_pictures_p50 = 0;
  int zoom_pictures_max = 0;
  double zoom_error_rms_dof = 0.0;
  double scale_error_max = 0.0;  ///< as a share
  double calibration_residual = 0.0;
  std::vector<HoldRow> holds;
  std::vector<StartRecord> starts;  ///< what all of the above are made of
  std::vector<ZoomRecord> steps;
};

struct FocusPlan {
  int starts = 200;  ///< a target
  std::uint64_t seed = 1;
  bool thesis_only = false;  ///< the printed law alone: no zooms, nothing refused, no rivals
  unsigned jobs = 0;         ///< 0: one a processor
};

FocusFigures focus_figures(const FocusPlan& plan);

nlohmann::ordered_json json_of(const FocusFigures& figures, const FocusPlan& plan);
/// Tables `strategies`, `refused`, `zoom` and `hold` of docs/results/autofocus.md.
std::vector<reporting::PageTable> page_tables(const FocusFigures& figures);
/// starts.csv and zooms.csv: a row for each, so that every figure can be had from them again.
std::string starts_csv(const FocusFigures& figures);
std::string zooms_csv(const FocusFigures& figures);
/// What decides the exit code.
std::vector<Acceptance> acceptance(const FocusFigures& figures);

}  // namespace telekerf::experiments
