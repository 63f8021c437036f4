// SPDX-License-Identifier: Apache-2.0
#include "experiments/autofocus/focus_figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "common/runtime/error_statistics.h"
#include "experiments/parallel.h"

namespace telekerf::experiments {
namespace {

using namespace imaging;
using Json = nlohmann::ordered_json;

constexpr std::array kTextures{Target::kRelief, Target::kTissue, Target::kLetter};
constexpr int kZoomsAUnit = 5;
constexpr double kHold_s = 60.0;
/// Of the starts one in so many is held: it takes fifty times the pictures of a search.
constexpr int kStartsAHold = 10;

int median(std::vector<int> values) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

FocusStart start_of(const FocusPlan& plan, StartKind kind, std::size_t i) {
  return {kTextures[i % kTextures.size()], kind, plan.seed + i / kTextures.size()};
}

/// Runs a strategy from all starts of a kind; each is recorded.
std::vector<FocusOutcome> outcomes(const FocusPlan& plan, std::string_view name, StartKind kind,
                                   FocusStrategy strategy, FocusFigures& figures, bool blank = false) {
  static constexpr std::string_view kKinds[] = {"usual", "out_of_range", "moving"};
  std::vector<FocusOutcome> out(static_cast<std::size_t>(plan.starts) * kTextures.size());
  std::vector<FocusStart> starts(out.size());
  std::vector<double> offsets_dof(out.size());
  for (std::size_t i = 0; i < out.size(); ++i) {
    starts[i] = start_of(plan, kind, i);
    if (blank) starts[i].target = Target::kBlank;
    if (blank) starts[i].seed = plan.seed + i;
  }
  for_each_parallel(
      out.size(),
      [&](std::size_t i) {
        DrawnStart drawn = draw_start(starts[i]);
        offsets_dof[i] = drawn.unit->defocus_dof();
        out[i] = strategy(*drawn.unit, drawn.range);
      },
      plan.jobs);
  for (std::size_t i = 0; i < out.size(); ++i) {
    figures.starts.push_back({std::string(name),
                              std::string(blank ? "blank" : kKinds[static_cast<std::size_t>(kind)]),
                              std::string(kTargets.word(starts[i].target)), starts[i].seed, offsets_dof[i],
                              out[i]});
  }
  return out;
}

StrategyRow row_of(std::string_view name, const std::vector<FocusOutcome>& outcomes) {
  StrategyRow row{.name = std::string(name), .starts = outcomes.size()};
  std::vector<int> pictures;
  ErrorStatistics errors;
  for (const FocusOutcome& outcome : outcomes) {
    pictures.push_back(outcome.pictures);
    row.false_locks += outcome.false_lock() ? 1U : 0U;
    if (!outcome.success()) continue;
    ++row.successes;
    errors.add(outcome.error_dof);
  }
  row.pictures_p50 = median(pictures);
  row.pictures_max = *std::max_element(pictures.begin(), pictures.end());
  row.error_rms_dof = errors.rms();
  row.error_max_dof = errors.max;
  return row;
}

RefusedRow refused_of(std::string_view name, const std::vector<FocusOutcome>& outcomes) {
  RefusedRow row{.name = std::string(name), .starts = outcomes.size()};
  for (const FocusOutcome& outcome : outcomes) {
    if (outcome.claimed) continue;
    ++row.refused;
    ++row.reasons[outcome.verdict];
  }
  return row;
}

std::string reasons_of(const RefusedRow& row) {
  std::string out;
  for (const auto& [verdict, count] : row.reasons)
    out += fmt::format("{}{} {}", out.empty() ? "" : ", ", kFocusVerdicts.word(verdict), count);
  return out;
}

void add_holds(const FocusPlan& plan, FocusFigures& figures) {
  const auto seeds = static_cast<std::size_t>(std::max(1, plan.starts / kStartsAHold));
  std::vector<FocusHold> holds(kTextures.size() * seeds);
  for_each_parallel(
      holds.size(),
      [&](std::size_t i) { holds[i] = hold_focus(kTextures[i / seeds], plan.seed + i % seeds, kHold_s); },
      plan.jobs);
  for (std::size_t i = 0; i < holds.size(); ++i) {
    if (i % seeds == 0) figures.holds.push_back({.target = std::string(kTargets.word(kTextures[i / seeds]))});
    HoldRow& row = figures.holds.back();
    ++row.runs;
    row.lost += holds[i].lost ? 1U : 0U;
    row.all_dof.add(holds[i].all_dof);
    row.passed_dof.add(holds[i].passed_dof);
  }
}

void add_zooms(const FocusPlan& plan, FocusFigures& figures) {
  const Calibration calibration = calibrated_unit(plan.seed);
  figures.calibration_residual = calibration.scale_residual;
  const std::size_t units =
      kTextures.size() * static_cast<std::size_t>(std::max(1, plan.starts / kZoomsAUnit));
  std::vector<std::vector<ZoomStep>> steps(units);
  for_each_parallel(
      units,
      [&](std::size_t i) {
        steps[i] = zoom_steps(kTextures[i % kTextures.size()], plan.seed + i / kTextures.size(), kZoomsAUnit,
                              calibration.model);
      },
      plan.jobs);
  std::vector<int> pictures;
  ErrorStatistics errors;
  for (std::size_t i = 0; i < units; ++i) {
    for (const ZoomStep& step : steps[i]) {
      figures.steps.push_back({std::string(kTargets.word(kTextures[i % kTextures.size()])),
                               plan.seed + i / kTextures.size(),
                               static_cast<int>(figures.zooms) % kZoomsAUnit, step});
      ++figures.zooms;
      pictures.push_back(step.pictures);
      figures.scale_error_max = std::max(figures.scale_error_max, std::abs(step.scale_error));
      if (!step.found || std::abs(step.error_dof) > 1.0) continue;
      ++figures.zooms_found;
      errors.add(step.error_dof);
    }
  }
  figures.zoom_pictures_p50 = median(pictures);
  figures.zoom_pictures_max = *std::max_element(pictures.begin(), pictures.end());
  figures.zoom_error_rms_dof = errors.rms();
}

const StrategyRow* row_named(const FocusFigures& figures, std::string_view name) {
  for (const StrategyRow& row : figures.rows) {
    if (row.name == name) return &row;
  }
  return nullptr;
}

std::string percent(double share) { return fmt::format("{:.1f}", 100.0 * share); }

}  // namespace

double StrategyRow::success_rate() const noexcept {
  return starts == 0 ? 0.0 : static_cast<double>(successes) / static_cast<double>(starts);
}

FocusFigures focus_figures(const FocusPlan& plan) {
  FocusFigures figures;
  figures.law = plan.thesis_only ? "thesis" : "search";
  const ImagingModel model = simulated_model();
  figures.depth_of_field_m = model.depth_of_field_m(0.5 * model.magnification_travel_m);
  for (const auto& strategy : kFocusStrategies) {
    if (plan.thesis_only && strategy.value != by_printed_law) continue;
    figures.rows.push_back(
        row_of(strategy.word, outcomes(plan, strategy.word, StartKind::kUsual, strategy.value, figures)));
  }
  if (plan.thesis_only) return figures;
  const auto refused = [&](std::string_view name, StartKind kind, bool blank) {
    figures.refused.push_back(refused_of(name, outcomes(plan, "search", kind, by_search, figures, blank)));
  };
  refused("blank", StartKind::kUsual, true);
  refused("out_of_range", StartKind::kOutOfRange, false);
  refused("moving", StartKind::kMoving, false);
  add_zooms(plan, figures);
  add_holds(plan, figures);
  return figures;
}

Json json_of(const FocusFigures& figures, const FocusPlan& plan) {
  const StrategyRow& chosen = figures.rows.front();
  Json json{{"experiment", "autofocus"},
            {"law", figures.law},
            {"seed", plan.seed},
            {"starts", chosen.starts},
            {"depth_of_field_um", 1e6 * figures.depth_of_field_m},
            {"success_rate", chosen.success_rate()},
            {"false_locks", chosen.false_locks},
            {"images_used", chosen.pictures_p50},
            {"focus_error_dof", chosen.error_rms_dof}};
  if (figures.zooms > 0) {
    json["images_after_zoom"] = figures.zoom_pictures_p50;
    json["zoom"] = {
        {"steps", figures.zooms},
        {"found", figures.zooms_found},
        {"found_share", static_cast<double>(figures.zooms_found) / static_cast<double>(figures.zooms)},
        {"images_max", figures.zoom_pictures_max},
        {"focus_error_dof", figures.zoom_error_rms_dof},
        {"scale_error_max", figures.scale_error_max},
        {"calibration_residual", figures.calibration_residual}};
  }
  std::size_t locks = 0;
  for (const RefusedRow& row : figures.refused) {
    json["no_focus"][row.name] = {{"starts", row.starts}, {"refused", row.refused}};
    for (const auto& [verdict, count] : row.reasons)
      json["no_focus"][row.name]["reasons"][std::string(kFocusVerdicts.word(verdict))] = count;
    locks += row.starts - row.refused;
  }
  json["no_focus_locks"] = locks;
  if (const StrategyRow* thesis = row_named(figures, "thesis_law"))
    json["thesis_law"] = {{"success_rate", thesis->success_rate()}, {"false_locks", thesis->false_locks}};
  for (const HoldRow& row : figures.holds) {
    json["hold"][row.target] = {{"runs", row.runs},
                                {"seconds", kHold_s},
                                {"lost", row.lost},
                                {"pictures", row.all_dof.count},
                                {"error_rms_dof", row.all_dof.rms()},
                                {"error_max_dof", row.all_dof.max},
                                {"passed_on", row.passed_dof.count},
                                {"passed_error_rms_dof", row.passed_dof.rms()},
                                {"passed_error_max_dof", row.passed_dof.max}};
  }
  json["rows"] = Json::array();
  for (const StrategyRow& row : figures.rows) {
    json["rows"].push_back({{"strategy", row.name},
                            {"success_rate", row.success_rate()},
                            {"false_locks", row.false_locks},
                            {"images_used", row.pictures_p50},
                            {"images_max", row.pictures_max},
                            {"focus_error_dof", row.error_rms_dof},
                            {"focus_error_max_dof", row.error_max_dof}});
  }
  return json;
}

std::vector<reporting::PageTable> page_tables(const FocusFigures& figures) {
  reporting::TableRows strategies{{"strategy", "success, %", "false locks", "pictures, median", "most",
                                   "error rms, dof", "largest, dof"}};
  for (const StrategyRow& row : figures.rows) {
    strategies.push_back(
        {row.name, percent(row.success_rate()), fmt::format("{} of {}", row.false_locks, row.starts),
         std::to_string(row.pictures_p50), std::to_string(row.pictures_max),
         fmt::format("{:.3f}", row.error_rms_dof), fmt::format("{:.3f}", row.error_max_dof)});
  }
  reporting::TableRows refused{{"start", "no focus found", "reasons"}};
  for (const RefusedRow& row : figures.refused)
    refused.push_back({row.name, fmt::format("{} of {}", row.refused, row.starts), reasons_of(row)});
  reporting::TableRows hold{{"target", "runs", "focus lost", "all pictures: rms, dof", "largest",
                             "passed on, %", "these: rms, dof", "largest, dof"}};
  for (const HoldRow& row : figures.holds) {
    hold.push_back({row.target, std::to_string(row.runs), std::to_string(row.lost),
                    fmt::format("{:.2f}", row.all_dof.rms()), fmt::format("{:.2f}", row.all_dof.max),
                    percent(static_cast<double>(row.passed_dof.count) / static_cast<double>(row.all_dof.count)),
                    fmt::format("{:.3f}", row.passed_dof.rms()), fmt::format("{:.2f}", row.passed_dof.max)});
  }
  const reporting::TableRows zoom{
      {"zoom steps", "found", "pictures, median", "most", "error rms, dof", "scale off at the most, %"},
      {std::to_string(figures.zooms), std::to_string(figures.zooms_found),
       std::to_string(figures.zoom_pictures_p50), std::to_string(figures.zoom_pictures_max),
       fmt::format("{:.3f}", figures.zoom_error_rms_dof),
       fmt::format("{:.3f}", 100.0 * figures.scale_error_max)}};
  return {{"strategies", reporting::markdown_table(strategies)},
          {"refused", reporting::markdown_table(refused)},
          {"zoom", reporting::markdown_table(zoom)},
          {"hold", reporting::markdown_table(hold)}};
}

std::string starts_csv(const FocusFigures& figures) {
  std::string out = "strategy,start,target,seed,offset_dof,claimed,verdict,pictures,error_dof\n";
  for (const StartRecord& row : figures.starts) {
    out += fmt::format("{},{},{},{},{},{:d},{},{},{}\n", row.strategy, row.kind, row.target, row.seed,
                       row.offset_dof, row.outcome.claimed, kFocusVerdicts.word(row.outcome.verdict), row.outcome.pictures,
                       row.outcome.error_dof);
  }
  return out;
}

std::string zooms_csv(const FocusFigures& figures) {
  std::string out = "target,seed,step,found,pictures,error_dof,scale_error\n";
  for (const ZoomRecord& row : figures.steps) {
    out += fmt::format("{},{},{},{:d},{},{},{}\n", row.target, row.seed, row.step, row.zoom.found,
                       row.zoom.pictures, row.zoom.error_dof, row.zoom.scale_error);
  }
  return out;
}

std::vector<Acceptance> acceptance(const FocusFigures& figures) {
  const StrategyRow& row = figures.rows.front();
  std::size_t found_in_nothing = 0;
  for (const RefusedRow& refused : figures.refused) found_in_nothing += refused.starts - refused.refused;
  return {{"starts not in focus", 1.0 - row.success_rate(), 0.005, 100.0, "%"},
          {"false locks", static_cast<double>(row.false_locks), 0.0, 1.0, ""},
          {"pictures, median", static_cast<double>(row.pictures_p50), 26.0, 1.0, ""},
          {"error rms", row.error_rms_dof, 0.1, 1.0, "dof"},
          {"found where nothing is", static_cast<double>(found_in_nothing), 0.0, 1.0, ""},
          {"pictures after a zoom", static_cast<double>(figures.zoom_pictures_p50), 8.0, 1.0, ""},
          {"zooms not in focus", static_cast<double>(figures.zooms - figures.zooms_found), 0.0, 1.0, ""},
          {"scale after a zoom", figures.scale_error_max, 0.002, 100.0, "%"}};
}

}  // namespace telekerf::experiments
