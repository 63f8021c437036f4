// SPDX-License-Identifier: Apache-2.0
// telekerf-experiment haptics: thesis 9.2, the cut as the hand feels it, and what that may do to the hand.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "common/reporting/plot.h"
#include "common/runtime/results.h"
#include "common/runtime/settings.h"
#include "common/workpiece/line_depth.h"
#include "experiments/commands.h"
#include "experiments/haptics/felt_cut_trial.h"
#include "experiments/haptics/port_trial.h"
#include "experiments/quick_form.h"
#include "experiments/result_file.h"
#include "master/haptics/energy_tank.h"

namespace telekerf::experiments {
namespace {

using nlohmann::ordered_json;
using reporting::Line;
using reporting::Panel;

struct Options : QuickForm {
  FeltCutTrial trial;
  double own_depth_mm = 0.35;  ///< about what the hand cuts by itself
  int runs = 2000;
  int hands = 5;
  std::uint64_t seed = 1;
  std::string out = "out/haptics";
};

constexpr PortLaw kLaws[] = {PortLaw::kNone, PortLaw::kObserver, PortLaw::kTank};

std::vector<PortResult> port_results(const Options& options) {
  std::vector<PortResult> out;
  for (const bool adversary : {false, true})
    for (const PortLaw law : kLaws) out.push_back(run_port(law, adversary, options.runs, options.seed));
  return out;
}

ordered_json port_json(const std::vector<PortResult>& results, const Options& options) {
  ordered_json rows = ordered_json::array();
  for (const PortResult& one : results)
    rows.push_back({{"law", word_of(one.law)},
                    {"adversary", one.adversary},
                    {"runs_above", one.above},
                    {"worst_beyond_mj", 1e3 * one.worst_j},
                    {"fastest_m_per_s", one.fastest_m_per_s},
                    {"felt_share", one.felt_share}});
  return {{"runs", options.runs},
          {"tank_start_mj", 1e3 * master::EnergyTankSettings{}.initial_j},
          {"rows", rows}};
}

ordered_json run_json(const FeltCutRun& run) {
  ordered_json out{{"depth_error_percent", 100.0 * run.depth_error},
                   {"marked_depth_error_percent", 100.0 * run.marked_error},
                   {"lit_places", run.lit_places},
                   {"marked_places", run.marked_places},
                   {"mean_depth_mm", 1e3 * run.mean_depth_m},
                   {"given_to_the_hand_mj_max", 1e3 * run.most_given_j},
                   {"tracking_rms_um", run.tracking_rms_um},
                   {"energy_outside_corridor_j", run.energy_outside_j}};
  if (run.felt) {
    out["wished_rms_n"] = run.wished_rms_n;
    out["felt_rms_n"] = run.felt_rms_n;
    out["held_back_share"] = run.held_back_share;
    out["port_beyond_drag_mj_max"] = 1e3 * run.port_most_given_j;
  }
  return out;
}

struct Pair {
  FeltCutRun blind, felt;
  double ratio() const { return felt.depth_error / blind.depth_error; }
  double marked_ratio() const { return felt.marked_error / blind.marked_error; }
};

std::vector<Pair> pairs(const Options& options, double depth_mm) {
  FeltCutTrial trial = options.trial;
  trial.depth_mm = depth_mm;
  std::vector<Pair> out;
  for (int i = 0; i < options.hands; ++i) {
    const std::uint64_t seed = options.seed + static_cast<std::uint64_t>(i);
    out.push_back({run_felt_cut(trial, false, seed), run_felt_cut(trial, true, seed)});
  }
  return out;
}

ordered_json cut_json(const std::vector<Pair>& hands, const Options& options, double depth_mm) {
  ordered_json rows = ordered_json::array();
  std::vector<double> ratios, marked_ratios;
  std::vector<double> lit_ratios, depths_mm;
  double tank_mj = 0.0, hand_mj = 0.0, outside_j = 0.0, felt = 0.0, held_back = 0.0, tracking = 0.0;
  for (std::size_t i = 0; i < hands.size(); ++i) {
    const Pair& pair = hands[i];
    rows.push_back({{"seed", options.seed + i},
                    {"without", run_json(pair.blind)},
                    {"felt", run_json(pair.felt)},
                    {"ratio", pair.ratio()}});
    ratios.push_back(pair.ratio());
    marked_ratios.push_back(pair.marked_ratio());
    lit_ratios.push_back(static_cast<double>(pair.felt.lit_places) /
                         static_cast<double>(pair.blind.lit_places));
    depths_mm.push_back(1e3 * pair.felt.mean_depth_m);
    tank_mj = std::max(tank_mj, 1e3 * pair.felt.port_most_given_j);
    hand_mj = std::max(hand_mj, 1e3 * (pair.felt.most_given_j - pair.blind.most_given_j));
    outside_j = std::max(outside_j, pair.felt.energy_outside_j);
    tracking = std::max(tracking, pair.felt.tracking_rms_um);
    felt += pair.felt.felt_rms_n / pair.felt.wished_rms_n / static_cast<double>(hands.size());
    held_back = std::max(held_back, pair.felt.held_back_share);
  }
  std::sort(ratios.begin(), ratios.end());
  std::sort(marked_ratios.begin(), marked_ratios.end());
  std::sort(lit_ratios.begin(), lit_ratios.end());
  std::sort(depths_mm.begin(), depths_mm.end());
  return {{"image", options.trial.image},
          {"netem", options.trial.netem},
          {"depth_mm", depth_mm},
          {"copy_mm2_per_s", 1e6 * workpiece::depth_speed_m2_per_s(workpiece::kWood, options.trial.laser_w)},
          {"error_ratio_median", ratios[ratios.size() / 2]},
          {"error_ratio_worst", ratios.back()},
          {"marked_error_ratio_median", marked_ratios[marked_ratios.size() / 2]},
          {"marked_error_ratio_worst", marked_ratios.back()},
          {"lit_places_ratio_median", lit_ratios[lit_ratios.size() / 2]},
          {"lit_places_ratio_worst", lit_ratios.front()},
          {"mean_depth_mm_median", depths_mm[depths_mm.size() / 2]},
          {"felt_share", felt},
          {"held_back_share_max", held_back},
          {"port_beyond_drag_mj_max", tank_mj},
          {"hand_beyond_without_mj_max", hand_mj},
          {"tracking_rms_um_max", tracking},
          {"energy_outside_corridor_j_max", outside_j},
          {"hands", rows}};
}

/// The same hand where the copy does not know the material.
ordered_json wrong_copies(const Options& options, const Pair& known) {
  ordered_json rows = ordered_json::array();
  for (const double factor : {0.8, 1.2}) {
    const FeltCutRun blind = run_felt_cut(options.trial, false, options.seed, factor);
    const FeltCutRun felt = run_felt_cut(options.trial, true, options.seed, factor);
    rows.push_back({{"heat_of_removal_factor", factor},
                    {"without_percent", 100.0 * blind.depth_error},
                    {"felt_percent", 100.0 * felt.depth_error}});
  }
  rows.push_back({{"heat_of_removal_factor", 1.0},
                  {"without_percent", 100.0 * known.blind.depth_error},
                  {"felt_percent", 100.0 * known.felt.depth_error}});
  return rows;
}

Line speed_line(const FeltCutRun& run, const char* label, int colour) {
  Line line{.label = label, .colour = colour};
  for (const RemoteSample& sample : run.motion) {
    line.x.push_back(sample.time_s);
    line.y.push_back(1e3 * sample.slave_m_per_s);
  }
  return line;
}

Line depth_line(const FeltCutRun& run, const char* label, int colour) {
  Line line{.label = label, .colour = colour};
  for (std::size_t i = 0; i < run.mark.arc_m.size(); ++i) {
    line.x.push_back(1e3 * run.mark.arc_m[i]);
    line.y.push_back(run.mark.dwell_s_per_m[i] > 0.0 ? 1e3 * run.mark.depth_m[i] : NAN);
  }
  return line;
}

Line given_line(const FeltCutRun& run, const char* label, int colour) {
  Line line{.label = label, .x = run.time_s, .y = run.given_j, .colour = colour};
  for (double& joule : line.y) joule *= 1e3;
  return line;
}

/// A run's share of all runs over what its port gave at the most; on the axis' floor: nothing.
Panel port_panel(const std::vector<PortResult>& results, bool adversary, const std::string& title) {
  constexpr double kFloor_mj = 1e-3;
  Panel panel{.title = title,
              .x_label = "given to the hand beyond the drag, at the most [mJ]",
              .y_label = "share of the runs",
              .lines = {},
              .y_range = std::array{0.0, 1.05},
              .log_x = true};
  for (const PortResult& one : results) {
    if (one.adversary != adversary) continue;
    Line line{.label = word_of(one.law)};
    for (std::size_t i = 0; i < one.given_j.size(); ++i) {
      line.x.push_back(std::max(kFloor_mj, 1e3 * one.given_j[i]));
      line.y.push_back(static_cast<double>(i + 1) / static_cast<double>(one.given_j.size()));
    }
    panel.lines.push_back(line);
  }
  const double start_mj = 1e3 * master::EnergyTankSettings{}.initial_j;
  panel.lines.push_back({.label = "in the tank at the start",
                         .x = {start_mj, start_mj},
                         .y = {0.0, 1.0},
                         .style = Line::Style::kDashed,
                         .colour = 7});
  return panel;
}

void draw(const Pair& hand, const std::vector<PortResult>& ports, const Options& options,
          const std::filesystem::path& png) {
  const double depth = options.trial.depth_mm;
  const double length = 1e3 * hand.felt.mark.arc_m.back();
  reporting::draw_figure(
      {.title = fmt::format("the cut felt by the hand: {}, network {}, wished depth {:g} mm",
                            options.trial.image, options.trial.netem, depth),
       .panels =
           {{.title = "slave's tangential velocity",
             .x_label = "time [s]",
             .y_label = "along the contour [mm/s]",
             .lines = {speed_line(hand.blind, "nothing felt", 1), speed_line(hand.felt, "cut felt", 0)}},
            {.title = "depth in wood, constant power",
             .x_label = "along the contour [mm]",
             .y_label = "depth [mm]",
             .lines = {depth_line(hand.blind, "nothing felt", 1),
                       depth_line(hand.felt, "cut felt", 0),
                       {.label = "wished",
                        .x = {0.0, length},
                        .y = {depth, depth},
                        .style = Line::Style::kDashed,
                        .colour = 7}}},
            {.title = "what the tool gave to the hand",
             .x_label = "time [s]",
             .y_label = "energy [mJ]",
             .lines = {given_line(hand.blind, "nothing felt", 1), given_line(hand.felt, "cut felt", 0)}},
            port_panel(ports, false, "late, lossy copies"),
            port_panel(ports, true, "an adversary's force")},
       .columns = 2},
      png);
}

int run(const Options& options) {
  const std::filesystem::path folder = options.out;
  make_folder("--out", folder);
  const std::vector<PortResult> ports = port_results(options);
  const std::vector<Pair> hands = pairs(options, options.trial.depth_mm);
  ordered_json result{{"experiment", "haptics"}};
  result["port"] = port_json(ports, options);
  result["cut"] = cut_json(hands, options, options.trial.depth_mm);
  result["cut_at_its_own_pace"] =
      cut_json(pairs(options, options.own_depth_mm), options, options.own_depth_mm);
  result["wrong_copy"] = wrong_copies(options, hands.front());
  draw(hands.front(), ports, options, folder / "haptics.png");
  write_result(folder / "result.json", result, options.seed);
  fmt::print("{}\n", json_text(result));
  const bool passive = std::none_of(ports.begin(), ports.end(), [](const PortResult& one) {
    return one.law == PortLaw::kTank && one.above > 0;
  });
  return passive && result["cut"]["energy_outside_corridor_j_max"] == 0.0 ? 0 : 1;
}

}  // namespace

void add_haptics_command(Program& program) {
  const Options options;
  program.add(
      "haptics",
      "Thesis 9.2: the cut felt by the hand, and the energy that it may give; result.json, figure; exit "
      "code 1 if the port gives more than its tank holds",
      options,
      [](Options& o, Settings& s) {
        s.add("image", o.trial.image, kPicture, "picture: a shipped name or a file");
        s.add("netem", o.trial.netem, kProfile, "network profile: a shipped name or a file");
        s.add("depth_mm", o.trial.depth_mm, {.min = 0.05, .max = 5, .unit = "mm"}, "wished depth in wood");
        s.add("own_depth_mm", o.own_depth_mm, {.min = 0.05, .max = 5, .unit = "mm"},
              "another one: about what the hand cuts by itself");
        s.add("laser_w", o.trial.laser_w, {.min = 0.1, .max = 20, .unit = "W"}, "power of the beam");
        s.add("hand_speed_mm_s", o.trial.hand_speed_mm_s, {.min = 1, .max = 100, .unit = "mm/s"},
              "mean speed that the hand wants");
        s.add("hands", o.hands, {.min = 1, .max = 100}, "simulated hands, with the seeds from --seed on");
        s.add("runs", o.runs, {.min = 1, .max = 100000}, "of the port alone, for each law");
        s.add("seed", o.seed, kSeeds, "of the first");
        o.add_quick(s, {QuickForm::shorter("hands", o.hands, 2), QuickForm::shorter("runs", o.runs, 200)});
        s.add("out", o.out, kFolder, "folder for the results");
      },
      run);
}

}  // namespace telekerf::experiments
