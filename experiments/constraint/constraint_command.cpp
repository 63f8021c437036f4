// SPDX-License-Identifier: Apache-2.0
// telekerf-experiment constraint: every figure of the virtual constraint against its bar, and a table over k
// and over circles, lines and descriptor.
#include <fmt/format.h>

#include <array>
#include <chrono>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "common/reporting/plot.h"
#include "common/runtime/results.h"
#include "common/runtime/startup_error.h"
#include "experiments/acceptance.h"
#include "experiments/commands.h"
#include "experiments/constraint/constraint_acceptance.h"
#include "experiments/constraint/constraint_curves.h"
#include "experiments/quick_form.h"
#include "experiments/result_file.h"
#include "experiments/simulation/simulation.h"

namespace telekerf::experiments {
namespace {

using reporting::Figure;
using reporting::Line;
using reporting::Panel;

struct Options : QuickForm {
  std::string page;
  std::string out = "out/constraint";
  std::uint64_t seed = 1;
  double duration_s = 20.0;
};

void measure_tracking(const std::vector<ContourMessage>& contours, const Options& options,
                      std::vector<Acceptance>& bars, nlohmann::ordered_json& rows) {
  for (const auto& contour : contours) {
    TrialSettings settings;
    settings.station.seed = options.seed;
    settings.station.hand_speed_mm_s = 30.0;
    settings.duration_s = options.duration_s;
    const Trial trial = run_trial(contour, settings);
    rows.push_back({{"contour", contour.source},
                    {"rms_um", 1e6 * trial.rms_m},
                    {"max_um", 1e6 * trial.max_m},
                    {"handover_mm_s", 1e3 * trial.max_handover_m_per_s},
                    {"mean_speed_mm_s", 1e3 * trial.mean_speed_m_per_s}});
    bars.push_back({contour.source + "_rms", trial.rms_m, 30e-6, 1e6, "um"});
    bars.push_back({contour.source + "_max", trial.max_m, 150e-6, 1e6, "um"});
    bars.push_back({contour.source + "_handover", trial.handover_m(), 0.5e-6, 1e6, "um"});
  }
}

/// How far the family of circles, lines or the descriptor itself is from the contour, and what it costs.
nlohmann::ordered_json table(const std::vector<ContourMessage>& contours, const Options& options,
                             Figure& figure) {
  using master::CurveKind;
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  constexpr std::array kKinds{std::pair{CurveKind::kCircles, "circles"},
                              std::pair{CurveKind::kLines, "lines"},
                              std::pair{CurveKind::kDescriptor, "descriptor"}};
  for (const auto& contour : contours) {
    Panel panel{.title = contour.source,
                .x_label = "k",
                .y_label = "largest contour error [um]",
                .log_x = true,
                .log_y = true};
    for (const auto& [kind, name] : kKinds) {
      Line line{.label = name};
      for (const int k : kTableWindows) {
        const master::StationSettings station = curve_station(kind, k);
        const CurveError error = curve_error(contour, station);
        TrialSettings driven;
        driven.station = station;
        driven.station.seed = options.seed;
        driven.duration_s = 0.5 * options.duration_s;
        const Trial trial = run_trial(contour, driven);
        rows.push_back({{"contour", contour.source},
                        {"curve", name},
                        {"k", k},
                        {"curve_rms_um", 1e6 * error.rms_m},
                        {"curve_max_um", 1e6 * error.max_m},
                        {"driven_rms_um", 1e6 * trial.rms_m},
                        {"driven_max_um", 1e6 * trial.max_m},
                        {"handover_mm_s", 1e3 * trial.max_handover_m_per_s},
                        {"cost_ns", error.cost_ns}});
        fmt::print(
            "{:<10} {:<10} k {:<2}  curve {:6.2f} / {:7.2f} um  driven {:6.1f} / {:6.1f} um  {:5.0f} ns\n",
            contour.source, name, k, 1e6 * error.rms_m, 1e6 * error.max_m, 1e6 * trial.rms_m,
            1e6 * trial.max_m, error.cost_ns);
        line.x.push_back(k);
        line.y.push_back(1e6 * error.max_m);
        if (kind == CurveKind::kDescriptor) {
          // It has no k.
          line.x = {1, 32};
          line.y = {1e6 * error.max_m, 1e6 * error.max_m};
          line.style = Line::Style::kDashed;
          break;
        }
      }
      panel.lines.push_back(line);
    }
    figure.panels.push_back(panel);
  }
  return rows;
}

int run(const Options& options) {
  make_folder("--out", options.out);
  const std::vector<ContourMessage> all = table_contours();
  nlohmann::ordered_json results{{"experiment", "constraint"}};
  std::vector<Acceptance> bars;
  results["tracking"] = nlohmann::ordered_json::array();
  measure_tracking(all, options, bars, results["tracking"]);

  const Decay decay = measure_decay(options.seed);
  bars.push_back({"decay", std::abs(decay.rate_rad_s / decay.chosen_rad_s - 1.0), 0.05, 1e2, "%"});
  bars.push_back({"glide_force", glide_force_n(options.seed), 0.3, 1.0, "N"});
  double drift = 0.0;
  double letting_go = 0.0;
  for (const auto& contour : all) {
    drift = std::max(drift, drift_m_per_s(contour, options.seed));
    letting_go = std::max(letting_go, letting_go_m(contour, options.seed));
  }
  bars.push_back({"drift", drift, 1e-6, 1e6, "um/s"});
  bars.push_back({"letting_go", letting_go, 100e-6, 1e6, "um"});
  results["breakaway_force_n"] = breakaway_force_n(options.seed);
  const Region region = measure_region(options.seed);
  results["corridor"] = {
      {"half_width_m", 0.5e-3}, {"used_m", region.used_m}, {"beyond_wall_m", region.beyond_wall_m}};
  std::vector<std::vector<std::string>> pushes;
  for (const double force : kTablePushes_n) {
    const Fight fought = fight(force, options.seed);
    pushes.push_back(push_row(force, fought));
    results["fight"].push_back({{"force_n", force},
                                {"pushed_off_m", fought.pushed_off_m},
                                {"overshoot_m", fought.overshoot_m},
                                {"back_s", fought.back_s},
                                {"return_m_per_s", fought.return_m_per_s},
                                {"saturated", fought.saturated},
                                {"broken", fought.broken}});
    fmt::print("fight {:3.0f} N: pushed off {:8.1f} um, back after {:5.3f} s, overshoot {:6.1f} um{}\n",
               force, 1e6 * fought.pushed_off_m, fought.back_s, 1e6 * fought.overshoot_m,
               fought.saturated ? ", motors at their limit" : "");
  }

  Figure figure{.title = "The virtual constraint over k", .columns = 2};
  results["table"] = table(all, options, figure);
  if (!options.page.empty())
    reporting::write_tables(options.page, constraint_tables(results["table"], pushes));
  Line measured{.label = "robot", .y = {}};
  Line ideal{.label = "eq. 65", .style = Line::Style::kDashed};
  for (std::size_t i = 0; i < decay.t_s.size(); ++i) {
    measured.x.push_back(1e3 * decay.t_s[i]);
    measured.y.push_back(1e6 * decay.error_m[i]);
    ideal.x.push_back(1e3 * decay.t_s[i]);
    ideal.y.push_back(1e6 * decay.ideal_m[i]);
  }
  figure.panels.push_back({.title = "decay of the error",
                           .x_label = "time [ms]",
                           .y_label = "error [um]",
                           .lines = {measured, ideal}});
  draw_figure(figure, std::filesystem::path(options.out) / "constraint.png");

  bool good = true;
  for (const auto& bar : bars) {
    good = good && bar.met();
    results["bars"].push_back(
        {{"name", bar.name}, {"value", bar.value}, {"bar", bar.bar}, {"good", bar.met()}});
    bar.print();
  }
  results["good"] = good;
  // Costs are the machine's, not the experiment's: beside the results.
  nlohmann::ordered_json timing = nlohmann::ordered_json::array();
  for (auto& row : results["table"]) {
    timing.push_back(
        {{"contour", row["contour"]}, {"curve", row["curve"]}, {"k", row["k"]}, {"cost_ns", row["cost_ns"]}});
    row.erase("cost_ns");
  }
  write_json(std::filesystem::path(options.out) / "timing.json", timing);
  write_result(std::filesystem::path(options.out) / "constraint.json", results, options.seed);
  return good ? 0 : 1;
}

}  // namespace

void add_constraint_command(Program& program) {
  program.add(
      "constraint", "The virtual constraint against its bars, and over k: constraint.json, constraint.png",
      Options{},
      [](Options& o, Settings& s) {
        s.add("seed", o.seed, kSeeds, "of robot and hand");
        s.add("duration_s", o.duration_s, {.min = 5, .max = 100, .unit = "s"}, "length of one run");
        o.add_quick(s, {QuickForm::shorter("duration_s", o.duration_s, 5)}, {"page"});
        s.add("page", o.page, kFile, "results page whose tables are written anew");
        s.add("out", o.out, kFolder, "for the results");
      },
      run);
}

}  // namespace telekerf::experiments
