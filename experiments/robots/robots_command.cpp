// SPDX-License-Identifier: Apache-2.0
// telekerf-experiment robots: the gains that are chosen from robot, rate and drive, on robots, hands and
// networks drawn at random.
#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>

#include "common/reporting/run_report.h"
#include "common/runtime/results.h"
#include "common/runtime/startup_error.h"
#include "experiments/commands.h"
#include "experiments/parallel.h"
#include "experiments/quick_form.h"
#include "experiments/result_file.h"
#include "experiments/robots/random_site.h"

namespace telekerf::experiments {
namespace {

using Json = nlohmann::ordered_json;

struct Options : QuickForm {
  int runs = 1000;
  std::uint64_t seed = 1;
  double duration_s = 12.0;
  int jobs = 0;
  std::string out = "out/robots";
};

struct Row {
  std::uint64_t seed = 0;
  Json drawn;
  Json report;
  std::string refusal;  ///< empty: it was run
};

Row run_one(std::uint64_t seed, const Options& options, const std::filesystem::path& robots) {
  Row row;
  row.seed = seed;
  try {
    const RandomSite site = random_site(seed, options.duration_s, robots);
    row.drawn = site.drawn;
    row.report = reporting::make_report(simulation::simulate(site.settings));
  } catch (const StartupError& error) {
    row.refusal = error.what();
  }
  return row;
}

double number(const Row& row, const char* part, const char* name) {
  const Json& value = row.report[part][name];
  return value.is_number() ? value.get<double>() : std::nan("");
}

/// Least, median and largest of what was measured, what at least 90 % and 95 % of the runs do not exceed, and
/// in how many runs nothing was.
Json spread(const std::vector<Row>& rows, const char* part, const char* name) {
  std::vector<double> values;
  std::size_t none = 0;
  for (const Row& row : rows) {
    if (!row.refusal.empty()) continue;
    const double value = number(row, part, name);
    std::isfinite(value) ? values.push_back(value) : void(++none);
  }
  if (values.empty())
    return {{"min", nullptr}, {"p50", nullptr}, {"p90", nullptr},
            {"p95", nullptr}, {"max", nullptr}, {"none", none}};
  std::sort(values.begin(), values.end());
  const auto at = [&](double share) {
    return values[static_cast<std::size_t>(std::ceil(share * static_cast<double>(values.size()))) - 1];
  };
  return {{"min", values.front()}, {"p50", at(0.5)},       {"p90", at(0.9)},
          {"p95", at(0.95)},       {"max", values.back()}, {"none", none}};
}

Json json_of(const Row& row) {
  Json out{{"seed", row.seed}};
  if (!row.refusal.empty()) {
    out["refused"] = row.refusal;
    return out;
  }
  out["drawn"] = row.drawn;
  for (const char* part : {"constraint", "tracking", "prediction", "cut"}) out[part] = row.report[part];
  return out;
}

/// What a refusal is about, without its figures: everything up to the first digit or quote.
std::string reason_of(const std::string& refusal) {
  const std::size_t slash = refusal.rfind(".toml");
  const std::string text = slash == refusal.npos ? refusal : refusal.substr(slash + 5);
  return text.substr(0, text.find_first_of("0123456789'"));
}

int run(const Options& options) {
  const std::filesystem::path folder = options.out;
  make_folder("--out", folder);
  make_folder("--out", folder / "robots");
  std::vector<Row> rows(static_cast<std::size_t>(options.runs));
  std::atomic<std::size_t> done{0};
  for_each_parallel(
      rows.size(),
      [&](std::size_t i) {
        rows[i] = run_one(options.seed + i, options, folder / "robots");
        if (++done % 50 == 0) {
          fmt::print("{} of {}\n", done.load(), rows.size());
          std::fflush(stdout);
        }
      },
      static_cast<unsigned>(options.jobs));

  std::map<std::string, std::size_t> refused;
  const Row* worst = nullptr;
  std::size_t beyond = 0;
  std::size_t dark = 0;
  for (const Row& row : rows) {
    if (!row.refusal.empty()) {
      ++refused[reason_of(row.refusal)];
      continue;
    }
    const double outside_j = number(row, "cut", "energy_outside_corridor_j");
    beyond += outside_j > 0.0 ? 1U : 0U;
    dark += number(row, "cut", "energy_inside_j") > 0.0 ? 0U : 1U;
    if (worst == nullptr || outside_j > number(*worst, "cut", "energy_outside_corridor_j")) worst = &row;
  }
  Json json{{"experiment", "robots"},
            {"runs", options.runs},
            {"seed", options.seed},
            {"duration_s", options.duration_s}};
  json["refused"] = refused;
  json["runs_refused"] =
      std::count_if(rows.begin(), rows.end(), [](const Row& row) { return !row.refusal.empty(); });
  json["runs_with_energy_outside"] = beyond;
  json["runs_without_a_cut"] = dark;
  json["energy_outside_corridor_j_max"] =
      worst == nullptr ? Json() : Json(number(*worst, "cut", "energy_outside_corridor_j"));
  json["worst_seed"] = worst == nullptr ? Json() : Json(worst->seed);
  json["energy_inside_j"] = spread(rows, "cut", "energy_inside_j");
  json["coverage"] = spread(rows, "cut", "coverage");
  json["constraint_rms_um"] = spread(rows, "constraint", "rms_um");
  json["tracking_rms_um"] = spread(rows, "tracking", "rms_um");
  json["prediction_rmse_um"] = spread(rows, "prediction", "rmse_um");
  json["cut_rms_um"] = spread(rows, "cut", "rms_um");
  fmt::print("{}\n", json_text(json));
  json["rows"] = Json::array();
  for (const Row& row : rows) json["rows"].push_back(json_of(row));
  write_result(folder / "robots.json", json, options.seed);
  const bool ran = worst != nullptr;
  if (beyond > 0) {
    fmt::print(
        "energy outside the corridor; the worst again: telekerf-experiment robots --runs 1 --seed {}\n",
        worst->seed);
  }
  return ran && beyond == 0 ? 0 : 1;
}

}  // namespace

void add_robots_command(Program& program) {
  program.add(
      "robots", "Robots, hands and networks drawn at random: robots.json; exit code 1 if one burns outside",
      Options{},
      [](Options& o, Settings& s) {
        s.add("runs", o.runs, {.min = 1, .max = 1e6}, "how many, with the seeds from --seed on");
        s.add("seed", o.seed, kSeeds, "of the first run");
        o.add_quick(s, {QuickForm::shorter("runs", o.runs, 5)});
        s.add("duration_s", o.duration_s, {.min = 2, .max = 600, .unit = "s"}, "length of a run");
        s.add("jobs", o.jobs, {.min = 0, .max = 256}, "runs at a time, 0: one a processor");
        s.add("out", o.out, kFolder, "folder for the results and the robots");
      },
      run);
}

}  // namespace telekerf::experiments
