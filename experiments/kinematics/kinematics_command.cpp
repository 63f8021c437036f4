// SPDX-License-Identifier: Apache-2.0
// telekerf-experiment kinematics: thesis 8.4, the kinematics against an independent engine, 9 panels and a
// table.
#include <fmt/format.h>

#include <array>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "common/reporting/plot.h"
#include "common/runtime/results.h"
#include "common/runtime/startup_error.h"
#include "experiments/acceptance.h"
#include "experiments/commands.h"
#include "experiments/kinematics/kinematics_validation.h"
#include "experiments/quick_form.h"
#include "experiments/result_file.h"

namespace telekerf::experiments {
namespace {

using reporting::Figure;
using reporting::Line;
using reporting::Panel;

struct Options : QuickForm {
  std::string robot = "slave-keops";
  double step_m = 0.005;
  std::uint64_t seed = 1;
  std::string out = "out/kinematics";
};

// The bars that decide the exit code.
constexpr double kPositionBar_m = 1e-6;
constexpr double kVelocityBar = 1e-3;
constexpr double kDynamicsBar = 1e-2;

using Pick = Vec3 KinematicsSample::*;

Panel panel(const KinematicsValidation& run, std::string title, std::string y_label, int axis, Pick measured,
            Pick calculated) {
  constexpr double kMm = 1e3;
  Line a{"measured", {}, {}, Line::Style::kSolid, 5};
  Line b{"calculated", {}, {}, Line::Style::kDashed, 1};
  for (const auto& sample : run.samples) {
    a.x.push_back(sample.time_s);
    a.y.push_back(kMm * (sample.*measured)[axis]);
    b.x.push_back(sample.time_s);
    b.y.push_back(kMm * (sample.*calculated)[axis]);
  }
  return {.title = std::move(title), .x_label = "time [s]", .y_label = std::move(y_label), .lines = {a, b}};
}

/// Fig. 8.10: rows FK against task space, IK against joint space, Jacobian velocities against measured ones.
Figure figure(const KinematicsValidation& run, const std::string& robot, double step_m) {
  Figure figure;
  figure.title =
      fmt::format("{}: kinematics against MuJoCo, steps of {:.3g} mm in x, y, z", robot, 1e3 * step_m);
  figure.columns = 3;
  for (int i = 0; i < 3; ++i) {
    figure.panels.push_back(panel(run, fmt::format("({}) forward kinematics, {}", "ABC"[i], "xyz"[i]),
                                  fmt::format("{} [mm]", "xyz"[i]), i, &KinematicsSample::tool_m,
                                  &KinematicsSample::tool_calculated_m));
  }
  for (int i = 0; i < 3; ++i) {
    figure.panels.push_back(panel(run, fmt::format("({}) inverse kinematics, joint {}", "DEF"[i], i + 1),
                                  fmt::format("d{} [mm]", i + 1), i, &KinematicsSample::joints_m,
                                  &KinematicsSample::joints_calculated_m));
  }
  for (int i = 0; i < 3; ++i) {
    figure.panels.push_back(panel(run, fmt::format("({}) Jacobian, {}", "GHI"[i], "xyz"[i]),
                                  fmt::format("v{} [mm/s]", "xyz"[i]), i, &KinematicsSample::velocity_m_per_s,
                                  &KinematicsSample::velocity_calculated_m_per_s));
  }
  return figure;
}

int run(const Options& options) {
  const robot::RobotModel model = robot::load_robot(options.robot);
  const KinematicsValidation steps = validate_kinematics(model, options.step_m);
  const DynamicsValidation fall = validate_free_fall(model);
  const DynamicsValidation forced = validate_forced_motion(model);
  const std::filesystem::path out = options.out;
  make_folder("--out", out);
  draw_figure(figure(steps, model.name, options.step_m), out / "kinematics.png");

  const std::array<Acceptance, 5> rows{{
      {"forward_kinematics_m", steps.worst_forward_m, kPositionBar_m, 1e6, "um"},
      {"inverse_kinematics_m", steps.worst_inverse_m, kPositionBar_m, 1e6, "um"},
      {"jacobian_velocity_share", steps.worst_velocity, kVelocityBar, 1e2, "%"},
      {"free_fall_share", fall.share(), kDynamicsBar, 1e2, "%"},
      {"forced_motion_share", forced.share(), kDynamicsBar, 1e2, "%"},
  }};
  nlohmann::ordered_json results{
      {"experiment", "kinematics"}, {"robot", model.name}, {"step_m", options.step_m}};
  bool good = true;
  fmt::print("{}, largest difference to MuJoCo (its own rod error of {:.3g} um subtracted)\n", model.name,
             1e6 * steps.worst_violation_m);
  for (const auto& row : rows) {
    good = good && row.met();
    results["worst"][row.name] = row.value;
    results["bar"][row.name] = row.bar;
    row.print();
  }
  results["engine"] = {{"rod_error_m", steps.worst_violation_m}, {"tool_tilt_rad", steps.worst_tilt_rad}};
  results["travelled_m"] = {{"free_fall", fall.travelled_m}, {"forced_motion", forced.travelled_m}};
  results["good"] = good;
  write_result(out / "results.json", results, options.seed);
  return good ? 0 : 1;
}

}  // namespace

void add_kinematics_command(Program& program) {
  program.add(
      "kinematics", "Thesis 8.4: kinematics and dynamics against MuJoCo; kinematics.png, results.json",
      Options{},
      [](Options& o, Settings& s) {
        s.add("robot", o.robot, kRobot, "whose");
        s.add("step_m", o.step_m, {.min = 1e-4, .max = 0.05, .unit = "m"}, "size of the steps");
        s.add("seed", o.seed, kSeeds, "stands in the results; nothing is drawn at random here");
        o.add_quick(s);
        s.add("out", o.out, kFolder, "for the results");
      },
      run);
}

}  // namespace telekerf::experiments
