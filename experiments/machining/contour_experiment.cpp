// SPDX-License-Identifier: Apache-2.0
#include "experiments/machining/contour_experiment.h"

#include <fmt/format.h>

#include <filesystem>
#include <optional>

#include "common/reporting/plot.h"
#include "common/runtime/results.h"
#include "common/runtime/settings.h"
#include "common/runtime/startup_error.h"
#include "experiments/machining/contour_run.h"
#include "experiments/machining/contour_source.h"
#include "experiments/machining/contour_tables.h"
#include "experiments/machining/independent_baselines.h"
#include "experiments/quick_form.h"
#include "experiments/result_file.h"

namespace telekerf::experiments {
namespace {

using reporting::draw_figure;
using reporting::Line;

using nlohmann::ordered_json;

struct Options : QuickForm {
  std::string image;
  std::string robot = "slave-keops";
  double width_mm = 0.0;
  double speed_mm_s = 8.0;
  machining::ControllerKind controller = machining::ControllerKind::kAuto;
  machining::CornerPolicy corner = machining::CornerPolicy::kRounded;
  bool ideal = false;
  std::optional<const workpiece::Material*> material;  ///< none: wood, or what the thesis' figure has
  std::string page;
  std::string out;
  double tolerance_um = 10.0;
  double along_rad_s = 0.0;
  double across_rad_s = 0.0;
  double mismatch = 0.1;
  int loop_delay = 1;
  bool no_preview = false;
  bool no_model_ahead = false;
  bool sweep = false;
  std::uint64_t seed = 1;
};

/// Whether the plant is an ideal one.
constexpr EnumRow<bool> kPlantRows[] = {
    {"full", false, "friction, mismatch, Hall sensors"},
    {"ideal", true, "none of them"},
};
constexpr EnumTable<bool> kPlants(kPlantRows);

ContourRunSettings run_settings(const Options& options, const robot::RobotModel& model) {
  ContourRunSettings s;
  s.robot = options.robot;
  s.plan.keep_within(model.limits);
  s.plan.speed_m_per_s = options.speed_mm_s * 1e-3;
  s.plan.corner = options.corner;
  s.plan.tolerance_m = options.tolerance_um * 1e-6;
  s.follower.loop_delay = options.loop_delay;
  s.follower.preview = !options.no_preview;
  if (options.no_model_ahead) s.follower.model = machining::ModelUse::kNone;
  s.follower = tuned_follower(model, s);
  if (options.along_rad_s > 0.0) s.follower.along_rad_s = options.along_rad_s;
  if (options.across_rad_s > 0.0) s.follower.across_rad_s = options.across_rad_s;
  s.controller = options.controller;
  s.ideal = options.ideal;
  s.mismatch = options.mismatch;
  s.seed = options.seed;
  return s;
}

ordered_json one_picture(const ContourExperiment::Subject& subject, const Options& options,
                         const ContourExperiment& experiment, const std::filesystem::path& out) {
  const std::string& image = subject.picture;
  const robot::RobotModel model = robot::load_robot(options.robot);
  const ContourRunSettings settings = run_settings(options, model);
  const ContourSource source =
      find_contour(image, options.width_mm, model.workspace.radius_m, experiment.closed);
  const geometry::Polyline& contour = source.contour;
  const auto plan = machining::make_timed_path(contour, settings.plan);
  if (!plan) throw input_error(fmt::format("{}: {}", image, plan.error()));
  const ContourRun run = run_contour(*plan, contour, settings);
  make_folder("--out", out);
  ordered_json result{{"experiment", experiment.name},
                      {"image", std::filesystem::path(image).filename().string()},
                      {"length_mm", plan->path.length_m() * 1e3},
                      {"closed", contour.closed},
                      {"robot", model.name},
                      {"controller", machining::kControllers.word(options.controller)},
                      {"corner", machining::kCorners.word(options.corner)},
                      {"plant", kPlants.word(options.ideal)},
                      {"control_hz", settings.plan.control_hz}};
  result.update(measure(run, settings));
  result["tuning"] = tuning(settings);
  result["burn"] = machining::burn({&run.pass, 1}, *options.material.value_or(subject.material), out);
  write_contour_trace(run, out / "trace.csv");

  std::vector<NamedRun> runs{
      {std::string(machining::kControllers.word(machining::chosen(options.controller, contour.closed))),
       &run}};
  ContourRun baseline;
  if (experiment.closed && options.controller != machining::ControllerKind::kIndependent) {
    ContourRunSettings other = settings;
    other.controller = machining::ControllerKind::kIndependent;
    baseline = run_contour(*plan, contour, other);
    runs.push_back({"independent", &baseline});
    const auto measured = measure(baseline, other);
    result["independent"] = {{"normal_error_um", measured["normal_error_um"]},
                             {"tangential_speed", measured["tangential_speed"]}};
    result["normal_error_ratio"] = normal_error_ratio(result, measured);
    result["equal_terms"] = equal_terms(*plan, contour, settings);
  }
  draw_runs(fmt::format("{} at {:g} mm/s", image, options.speed_mm_s), runs, source.picture, out / "mark.png",
            subject.letters, out / "panels.png");

  if (options.sweep) {
    // Contour error against speed.
    Line rms{"rms", {}, {}}, max{"max", {}, {}};
    ordered_json rows = ordered_json::array();
    for (const double speed : {1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0}) {
      Options faster = options;
      faster.speed_mm_s = speed;
      const ContourRunSettings s = run_settings(faster, model);
      if (s.plan.speed_m_per_s > s.plan.max_speed_m_per_s) break;
      const auto p = machining::make_timed_path(contour, s.plan);
      if (!p) throw input_error(p.error());
      const auto m = measure(run_contour(*p, contour, s), s);
      rms.x.push_back(speed);
      max.x.push_back(speed);
      rms.y.push_back(m["contour_error_um"]["rms"]);
      max.y.push_back(m["contour_error_um"]["max"]);
      rows.push_back({{"speed_mm_s", speed},
                      {"contour_error_um", m["contour_error_um"]},
                      {"normal_error_um", m["normal_error_um"]},
                      {"mean_mm_s", m["tangential_speed"]["mean_mm_s"]},
                      {"limit_violations", m["limit_violations"]}});
    }
    result["speeds"] = rows;
    draw_figure({.title = image,
                 .panels = {{.title = "contour error against speed",
                             .x_label = "speed [mm/s]",
                             .y_label = "[um]",
                             .lines = {rms, max},
                             .log_x = true,
                             .log_y = true}}},
                out / "error-against-speed.png");
  }
  return result;
}

int run(const Options& options, const ContourExperiment& experiment) {
  const std::filesystem::path out = options.out;
  ordered_json result;
  if (!options.image.empty()) {
    result = one_picture({options.image}, options, experiment, out);
  } else {
    // All pictures: each in its folder; the top level repeats the first one's measures and lists all.
    ordered_json all = ordered_json::array();
    for (const auto& subject : experiment.subjects) {
      const std::filesystem::path folder = out / subject.picture;
      all.push_back(one_picture(subject, options, experiment, folder));
      write_result(folder / "result.json", all.back(), options.seed);
    }
    if (!experiment.closed) {
      std::vector<std::filesystem::path> folders;
      for (const auto& subject : experiment.subjects) folders.push_back(out / subject.picture);
      draw_pictures_and_marks(folders, options.material.value_or(&workpiece::kWood)->name,
                              out / "figure-8.3.png");
    }
    result = all.front();
    std::filesystem::copy_file(out / experiment.subjects.front().picture / "trace.csv", out / "trace.csv",
                               std::filesystem::copy_options::overwrite_existing);
    result["pictures"] = all;
    if (!options.page.empty()) reporting::write_tables(options.page, contour_tables(all));
  }
  write_result(out / "result.json", result, options.seed);
  fmt::print("{}\n", json_text(result));
  return 0;
}

void add_parameters(const ContourExperiment& experiment, Options& o, Settings& s) {
  TextForm drawn_as_well = kPicture;  // outline-N is looked at where it is drawn
  drawn_as_well.complaint = [](const std::string&) { return std::string(); };
  s.add("image", o.image, drawn_as_well, "picture: a shipped name or a file; none: the thesis' set");
  s.add("robot", o.robot, kRobot, "that machines: a shipped name or a file");
  s.add("width_mm", o.width_mm, {.min = 0, .max = 1000, .unit = "mm"},
        "width of the whole picture, 0: fitted to the workspace");
  s.add("speed_mm_s", o.speed_mm_s, {.min = 0.1, .max = 300, .unit = "mm/s"}, "tangential speed");
  s.add("controller", o.controller, machining::kControllers, "how the robot is kept on the path");
  s.add("corner", o.corner, machining::kCorners, "what to do at corners");
  s.add("tolerance_um", o.tolerance_um, {.min = 0, .max = 1000, .unit = "um"}, "rounding of corners");
  s.add("plant", o.ideal, kPlants, "what is machined with");
  s.add("material", o.material, workpiece::kMaterials,
        "what the beam meets; none: wood, of the thesis' set what its figure has");
  s.add("mismatch", o.mismatch, {.min = 0, .max = 0.5}, "how far the plant is off its file, as a share");
  s.add("loop_delay", o.loop_delay, {.min = 0, .max = control::kMaxLoopDelay},
        "samples from a reading to the effect of its currents");
  s.add("no_preview", o.no_preview, "accelerations of the same sample, as if the loop had no delay");
  s.add("no_model_ahead", o.no_model_ahead, "no force of the model sent ahead, only the observer");
  s.add("along_rad_s", o.along_rad_s, {.min = 0, .max = 500, .unit = "rad/s"},
        "bandwidth along the path, 0: by speed");
  s.add("across_rad_s", o.across_rad_s, {.min = 0, .max = 500, .unit = "rad/s"},
        "contouring: across it, 0: the usual one");
  s.add("sweep", o.sweep, "contour error against speed, 1 to 100 mm/s");
  s.add("seed", o.seed, kSeeds, "of everything random");
  o.add_quick(s);
  if (experiment.closed)
    s.add("page", o.page, kFile,
          "page whose tables 'contours' and 'terms' are written anew, of the whole set");
  s.add("out", o.out, kFolder, "folder for the results");
}

}  // namespace

void add_contour_experiment(Program& program, const ContourExperiment& experiment) {
  Options options;
  options.speed_mm_s = experiment.speed_mm_s;
  options.out = "out/" + experiment.name;
  program.add(
      experiment.name, experiment.help, options,
      [experiment](Options& o, Settings& s) { add_parameters(experiment, o, s); },
      [experiment](const Options& o) { return run(o, experiment); });
}

}  // namespace telekerf::experiments
