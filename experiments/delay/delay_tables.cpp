// SPDX-License-Identifier: Apache-2.0
#include "experiments/delay/delay_tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <sstream>

namespace telekerf::experiments {
namespace {

constexpr Condition kConditions[] = {{0, 0, 0},       {50, 5, 0.01},   {100, 10, 0.01},
                                     {200, 20, 0.01}, {400, 40, 0.05}, {800, 80, 0.05}};

std::string heading(const Condition& c) {
  return c.rtt_ms == 0.0 ? "0"
                         : fmt::format("{:g} ms / {:g} ms / {:g} %", c.rtt_ms, c.jitter_ms, 100.0 * c.loss);
}

const Run* find_run(const std::vector<Run>& runs, const Rival& rival, const Condition& c) {
  return find_run(runs, rival, c.rtt_ms, c.rtt_ms > 0.0 ? c.jitter_ms / c.rtt_ms : 0.0, c.loss);
}

using CellOf = std::function<std::string(const Run&)>;

std::vector<std::string> head_of_rivals() {
  std::vector<std::string> head{"law", "estimator"};
  for (const Condition& condition : kConditions) head.push_back(heading(condition));
  return head;
}

reporting::PageTable over_conditions(const std::string& name, const std::vector<Run>& runs,
                                     const CellOf& cell_of) {
  std::vector<std::vector<std::string>> rows{head_of_rivals()};
  for (const Rival& rival : rivals()) {
    std::vector<std::string> row{law_of(rival), word_of(rival.estimator)};
    for (const Condition& condition : kConditions) {
      const Run* run = find_run(runs, rival, condition);
      row.push_back(run == nullptr ? "" : cell_of(*run));
    }
    rows.push_back(row);
  }
  return {name, reporting::markdown_table(rows)};
}

std::string tuning_cell(const Run& run) {
  std::string text;
  for (const Tuned& tuned : run.tuning) text += fmt::format("{}{:g}", text.empty() ? "" : "; ", tuned.value);
  return text.empty() ? "as shipped" : text;
}

/// "median / worst" over the seeds; a run that is not stable is worse than all others.
std::string over_seeds(const std::vector<Run>& runs, const Rival& rival, const std::string& profile) {
  std::vector<const DelayResult*> results;
  for (const Run& run : runs) {
    if (same(run.rival, rival) && run.profile == profile) results.push_back(&run.result);
  }
  const auto worse = [](const DelayResult* a, const DelayResult* b) {
    if (a->stable != b->stable) return a->stable;
    return a->stable && a->tracking_rmse_um < b->tracking_rmse_um;
  };
  std::sort(results.begin(), results.end(), worse);
  const auto what = &DelayResult::tracking_rmse_um;
  return cell(*results[results.size() / 2], what) + " / " + cell(*results.back(), what);
}

reporting::PageTable over_profiles(const std::vector<Run>& runs) {
  std::vector<std::string> head{"profile"};
  for (const Rival& rival : profile_rivals())
    head.push_back(law_of(rival) + " + " + word_of(rival.estimator));
  std::vector<std::vector<std::string>> rows{head};
  for (const Run& run : runs) {
    if (run.profile.empty() || run.profile == rows.back().front()) continue;
    if (std::any_of(rows.begin(), rows.end(), [&](const auto& row) { return row.front() == run.profile; }))
      continue;
    std::vector<std::string> row{run.profile};
    for (const Rival& rival : profile_rivals()) row.push_back(over_seeds(runs, rival, run.profile));
    rows.push_back(row);
  }
  return {"profiles", reporting::markdown_table(rows)};
}

}  // namespace

std::span<const Condition> table_conditions() { return kConditions; }

std::string cell(const DelayResult& result, double DelayResult::*what) {
  const double value = result.*what;
  if (!result.stable || !std::isfinite(value)) return "unstable";
  return value < 10.0 ? fmt::format("{:.2f}", value)
                      : (value < 100.0 ? fmt::format("{:.1f}", value) : fmt::format("{:.0f}", value));
}

std::vector<reporting::PageTable> delay_tables(const std::vector<Run>& runs) {
  const auto tracking = [](const Run& run) { return cell(run.result, &DelayResult::tracking_rmse_um); };
  const auto prediction = [](const Run& run) { return cell(run.result, &DelayResult::prediction_rmse_um); };
  return {over_conditions("tracking", runs, tracking), over_conditions("prediction", runs, prediction),
          over_conditions("tuning", runs, tuning_cell), over_profiles(runs)};
}

std::vector<Tuned> parsed_tuning(const DelayTrial& trial, const std::string& cell) {
  std::vector<Tuned> tuning = tuning_of(trial);
  std::istringstream text(cell);
  std::string value;
  for (Tuned& tuned : tuning) {
    std::getline(text, value, ';');
    tuned.value = std::stod(value);
  }
  return tuning;
}

}  // namespace telekerf::experiments
