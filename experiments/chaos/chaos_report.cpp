// SPDX-License-Identifier: Apache-2.0
#include "experiments/chaos/chaos_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <tuple>

#include "common/runtime/startup_error.h"
#include "experiments/chaos/shrink.h"
#include "experiments/chaos/stop_trial.h"
#include "experiments/parallel.h"

namespace telekerf::experiments {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kLeastEnergy = 0.5;  ///< of the undisturbed run's, in the mean
constexpr double kMostDose = 2.0;     ///< of the undisturbed run's
/// A contour's shape and the hand's pace decide what an undisturbed run brings: several of them, and always
/// the same, so that a seed meets the same bars alone.
constexpr std::uint64_t kUndisturbed = 4;
/// A mean of fewer runs says nothing.
constexpr int kFewest = 10;

struct Row {
  ChaosSettings settings;
  ChaosOutcome outcome;
};

int missed_bars(const Findings& findings) {
  return static_cast<int>(std::count_if(findings.first_s.begin(), findings.first_s.end(),
                                        [](const auto& at) { return at.has_value(); }));
}

/// Burnt outside, then burnt too much, then everything else.
bool worse(const Row& a, const Row& b) {
  const auto key = [](const Findings& f) {
    return std::tuple(f.energy_outside_j, f.missed(Bar::kDose) ? f.dose_j : 0.0, f.relights, missed_bars(f),
                      f.beam_age_s);
  };
  return key(a.outcome.findings) > key(b.outcome.findings);
}

template <class Of>
double largest(const std::vector<Row>& rows, const Of& of) {
  double most = 0.0;
  for (const Row& row : rows) most = std::max(most, static_cast<double>(of(row.outcome.findings)));
  return most;
}

template <class Of>
double sum(const std::vector<Row>& rows, const Of& of) {
  double all = 0.0;
  for (const Row& row : rows) all += static_cast<double>(of(row.outcome));
  return all;
}

bool has(const Row& row, FaultKind kind) {
  const auto& kinds = row.settings.kinds;
  return std::find(kinds.begin(), kinds.end(), kind) != kinds.end();
}

Json per_fault(const std::vector<Row>& rows) {
  Json table = Json::object();
  for (const auto& fault : kFaultRows) {
    int runs = 0, failed = 0, recovered = 0;
    double energy_j = 0.0;
    Json bars = Json::object();
    for (const Row& row : rows) {
      if (!has(row, fault.value)) continue;
      ++runs;
      failed += row.outcome.findings.failed() ? 1 : 0;
      recovered += row.outcome.recovered ? 1 : 0;
      energy_j += row.outcome.findings.energy_inside_j;
      for (const auto& bar : kBarRows) {
        if (!row.outcome.findings.missed(bar.value)) continue;
        Json& count = bars[std::string(bar.word)];
        count = count.is_null() ? 1 : count.get<int>() + 1;
      }
    }
    if (runs == 0) continue;
    table[std::string(fault.word)] = {{"runs", runs},
                                      {"failed", failed},
                                      {"missed", bars},
                                      {"recovered", recovered},
                                      {"energy_inside_j_mean", energy_j / runs}};
  }
  return table;
}

/// Each run that missed a bar, and when it first did.
Json failures_of(const std::vector<Row>& rows) {
  Json failures = Json::array();
  for (const Row& row : rows) {
    if (!row.outcome.findings.failed()) continue;
    Json missed = Json::object();
    for (const auto& bar : kBarRows) {
      const auto& first_s = row.outcome.findings.first_s[static_cast<std::size_t>(bar.value)];
      if (first_s) missed[std::string(bar.word)] = *first_s;
    }
    Json faults = Json::array();
    for (const FaultKind kind : row.settings.kinds) faults.push_back(kFaults.word(kind));
    failures.push_back({{"seed", row.settings.seed}, {"missed_at_s", missed}, {"faults", faults}});
  }
  return failures;
}

void run_all(std::vector<Row>& rows, const ChaosContours& contours, int jobs,
             const std::function<void(std::size_t)>& progress) {
  std::atomic<std::size_t> done{0};
  for_each_parallel(
      rows.size(),
      [&](std::size_t i) {
        rows[i].outcome = run_chaos(rows[i].settings, contours);
        progress(++done);
      },
      static_cast<unsigned>(jobs));
}

/// The first seed that misses each bar, as small as it gets.
void shrink_failures(const std::vector<Row>& rows, const ChaosContours& contours, bool shrinks,
                     ChaosReport& report) {
  report.json["missed"] = Json::array();
  for (const auto& bar : kBarRows) {
    const auto missed = [&](const Row& row) { return row.outcome.findings.missed(bar.value); };
    const auto first = std::find_if(rows.begin(), rows.end(), missed);
    if (first == rows.end()) continue;
    ChaosSettings smallest = first->settings;
    if (shrinks) {
      smallest = shrink(smallest, [&](const ChaosSettings& candidate) {
        return run_chaos(candidate, contours).findings.missed(bar.value);
      });
    }
    const auto runs = std::count_if(rows.begin(), rows.end(), missed);
    const std::string command = command_line(smallest);
    report.json["missed"].push_back(
        {{"bar", bar.word}, {"runs", runs}, {"seed", first->settings.seed}, {"command", command}});
    report.sentences.push_back(fmt::format("{}: {}, in {} of {} runs; the first: {}", bar.word, bar.sentence,
                                           runs, rows.size(), command));
  }
}

}  // namespace

ChaosReport run_campaign(const ChaosCampaign& campaign, const std::function<void(std::size_t)>& progress) {
  const ChaosContours contours = chaos_contours(campaign.each.master, campaign.each.slave);

  std::vector<Row> undisturbed(kUndisturbed, Row{campaign.each, {}});
  for (std::size_t i = 0; i < undisturbed.size(); ++i) {
    undisturbed[i].settings.seed = 1 + i;
    undisturbed[i].settings.kinds.clear();
  }
  run_all(undisturbed, contours, campaign.jobs, [](std::size_t) {});
  const double nominal_j = sum(undisturbed, [](const auto& o) { return o.findings.energy_inside_j; }) /
                           static_cast<double>(kUndisturbed);
  const double nominal_dose_j = largest(undisturbed, [](const auto& f) { return f.dose_j; });

  std::vector<Row> rows(static_cast<std::size_t>(campaign.runs), Row{campaign.each, {}});
  for (std::size_t i = 0; i < rows.size(); ++i) {
    rows[i].settings.seed = campaign.seed + i;
    rows[i].settings.kinds = campaign.kinds.value_or(drawn_kinds(campaign.seed + i));
    rows[i].settings.bars.dose_j = kMostDose * nominal_dose_j;
  }
  run_all(rows, contours, campaign.jobs, progress);

  const bool live = campaign.each.mode == ChaosMode::kLiveness;
  const double inside_j =
      sum(rows, [](const auto& o) { return o.findings.energy_inside_j; }) / static_cast<double>(rows.size());
  const double recovered =
      sum(rows, [](const auto& o) { return o.recovered ? 1 : 0; }) / static_cast<double>(rows.size());
  Refused refused;
  for (const Row& row : rows) {
    for (const auto& [reason, times] : row.outcome.refused) refused[reason] += times;
  }
  const auto worst = std::min_element(rows.begin(), rows.end(), worse);

  ChaosReport report;
  Json& json = report.json;
  json["experiment"] = "chaos";
  json["runs"] = campaign.runs;
  json["energy_inside_j_mean"] = inside_j;
  json["energy_outside_corridor_j_max"] = largest(rows, [](const auto& f) { return f.energy_outside_j; });
  json["dose_j_max"] = largest(rows, [](const auto& f) { return f.dose_j; });
  json["limit_violations"] =
      static_cast<int>(sum(rows, [](const auto& o) { return o.findings.limit_violations; }));
  json["laser_off_ticks_max"] =
      static_cast<int>(largest(rows, [](const auto& f) { return f.laser_off_ticks; }));
  json["jumps"] = static_cast<int>(sum(rows, [](const auto& o) { return o.findings.jumps; }));
  json["relights"] = static_cast<int>(sum(rows, [](const auto& o) { return o.findings.relights; }));
  json["beam_age_s_max"] = largest(rows, [](const auto& f) { return f.beam_age_s; });
  json["recovered_fraction"] = live ? Json(recovered) : Json();
  json["refused"] = refused;
  json["worst_seed"] = worst->settings.seed;
  json["duration_s"] = campaign.each.duration_s;
  json["mode"] = kChaosModes.word(campaign.each.mode);
  json["undisturbed"] = {
      {"runs", kUndisturbed}, {"energy_inside_j_mean", nominal_j}, {"dose_j_max", nominal_dose_j}};
  json["energy_stuck_laser_j_max"] = largest(rows, [](const auto& f) { return f.energy_stuck_j; });
  json["energy_without_permit_j_max"] = largest(rows, [](const auto& f) { return f.energy_unpermitted_j; });
  json["failed_runs"] =
      std::count_if(rows.begin(), rows.end(), [](const Row& row) { return row.outcome.findings.failed(); });
  json["faults"] = per_fault(rows);
  shrink_failures(rows, contours, campaign.shrinks, report);

  const bool enough = inside_j >= kLeastEnergy * nominal_j;
  // Faults that nobody heals may take all of it.
  const bool judged = campaign.runs >= kFewest && campaign.each.mode == ChaosMode::kLiveness;
  json["energy_enough"] = judged ? Json(enough) : Json();
  if (judged && !enough) {
    report.sentences.push_back(
        fmt::format("energy: {:.1f} J inside in the mean, {:.1f} J undisturbed; at least half is asked for",
                    inside_j, nominal_j));
  }
  if (!try_stops(campaign.seed, campaign.runs, json["stop"])) {
    report.sentences.push_back(
        "stop: not acknowledged within the round trip and 2 ms, or 60 ms at 20 % loss, or lost by a restart");
  }
  json["failures"] = failures_of(rows);
  report.passed = report.sentences.empty();
  return report;
}

}  // namespace telekerf::experiments
