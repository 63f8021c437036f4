// SPDX-License-Identifier: Apache-2.0
#include "tests/experiments/contour_experiment.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <memory>
#include <numbers>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <random>

#include "common/runtime/refusal.h"
#include "common/runtime/resources.h"
#include "common/runtime/settings.h"
#include "common/vision/load.h"
#include "slave/laser/kerf.h"
#include "tests/experiments/contour_run.h"
#include "tests/experiments/plot.h"

namespace telekerf::experiments {
namespace {

using nlohmann::ordered_json;

struct Options {
  std::string image;
  double width_mm = 0.0;
  double speed_mm_s = 8.0;
  std::string controller = "auto";
  std::string corner = "rounded";
  std::string plant = "full";
  std::string material = "wood";
  std::string out;
  double tolerance_um = 15.0;
  double along_rad_s = 0.0;
  double across_rad_s = 0.0;
  double mismatch = 0.1;
  int loop_delay = 1;
  bool no_preview = false;
  bool no_model_ahead = false;
  bool sweep = false;
  std::uint64_t seed = 1;
  Settings settings;
};

slave::ControllerKind kind_of(const std::string& name) {
  if (name == "independent") return slave::ControllerKind::kIndependent;
  if (name == "preview") return slave::ControllerKind::kPreview;
  if (name == "contouring") return slave::ControllerKind::kContouring;
  return slave::ControllerKind::kAuto;
}

slave::CornerPolicy corner_of(const std::string& name) {
  if (name == "exact") return slave::CornerPolicy::kExact;
  if (name == "slow") return slave::CornerPolicy::kSlow;
  return slave::CornerPolicy::kRounded;
}

/// An irregular outline like the ones of figure 8.5: a circle with eleven seeded harmonics, dark on a grey
/// ground with noise.
cv::Mat irregular_outline(std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const auto spread = [&] { return 2.0 * static_cast<double>(random() >> 11) * 0x1p-53 - 1.0; };
  std::array<double, 12> even{}, odd{};
  for (std::size_t k = 2; k < even.size(); ++k) {
    even[k] = 0.35 * spread() / std::pow(static_cast<double>(k), 1.3);
    odd[k] = 0.35 * spread() / std::pow(static_cast<double>(k), 1.3);
  }
  constexpr int kSide = 480;
  constexpr int kShift = 8;
  std::vector<cv::Point> points;
  for (int i = 0; i < 1440; ++i) {
    const double t = 2.0 * std::numbers::pi * i / 1440;
    double r = 1.0;
    for (std::size_t k = 2; k < even.size(); ++k) {
      r += even[k] * std::cos(static_cast<double>(k) * t) + odd[k] * std::sin(static_cast<double>(k) * t);
    }
    r = 130.0 * std::max(r, 0.3);
    points.emplace_back(static_cast<int>((0.5 * kSide + r * std::cos(t)) * (1 << kShift)),
                        static_cast<int>((0.5 * kSide + r * std::sin(t)) * (1 << kShift)));
  }
  cv::Mat image(kSide, kSide, CV_8UC1, cv::Scalar(205));
  cv::fillPoly(image, std::vector<std::vector<cv::Point>>{points}, cv::Scalar(60), cv::LINE_AA, kShift);
  cv::GaussianBlur(image, image, {}, 0.8);
  for (int row = 0; row < kSide; ++row) {
    for (int column = 0; column < kSide; ++column) {
      auto& v = image.at<std::uint8_t>(row, column);
      v = cv::saturate_cast<std::uint8_t>(v + 3.0 * spread());
    }
  }
  return image;
}

/// The largest contour of the expected kind; if the picture shows none at first sight, it is looked at as
/// strokes or as outlines. Failing that the largest contour is taken as it is.
geometry::Polyline contour_of(const std::string& image, const Options& options,
                              const robot::RobotModel& model, bool closed) {
  vision::LoadRequest request;
  request.scale.workspace_radius_m = model.workspace.radius_m;
  if (options.width_mm > 0.0) request.scale.picture_width_m = options.width_mm * 1e-3;
  const bool drawn = image.rfind("outline-", 0) == 0;
  const std::string file = drawn ? image : find_resource("pictures", image, ".png").string();
  const auto load = [&] {
    return drawn ? vision::contours_of(irregular_outline(std::stoull(image.substr(8))), request)
                 : vision::load_contours(file, request);
  };
  const auto found = load();
  if (!found) throw Refusal(fmt::format("{}: {}", file, found.error()));
  const auto wanted = [&](const vision::Loaded& loaded) {
    return std::find_if(loaded.contours.begin(), loaded.contours.end(),
                        [&](const geometry::Polyline& c) { return c.closed == closed; });
  };
  if (const auto first = wanted(*found); first != found->contours.end()) return *first;
  request.extract.mode = closed ? vision::Mode::kOutline : vision::Mode::kStroke;
  if (const auto again = load()) {
    if (const auto first = wanted(*again); first != again->contours.end()) return *first;
  }
  return found->contours[found->selected];
}

/// Rows of a run that a figure shows.
std::size_t stride_of(const ContourRun& run) { return std::max<std::size_t>(1, run.rows.size() / 4000); }

Line path_line(const ContourRun& run, const std::string& label, Line::Style style, int colour,
               const std::function<Vec3(const ContourRow&)>& point, const Vec2* around = nullptr,
               double reach_m = 0.0) {
  Line line{label, {}, {}, style, colour};
  const std::size_t stride = around == nullptr ? stride_of(run) : 1;
  for (std::size_t i = 0; i < run.rows.size(); i += stride) {
    const Vec3 p = point(run.rows[i]);
    const bool inside = around == nullptr || (p.head<2>() - *around).cwiseAbs().maxCoeff() < reach_m;
    line.x.push_back(inside ? p.x() * 1e3 : NAN);
    line.y.push_back(inside ? p.y() * 1e3 : NAN);
  }
  return line;
}

Line trace_line(const ContourRun& run, const std::string& label, int colour,
                const std::function<double(const ContourRow&)>& value) {
  Line line{label, {}, {}, Line::Style::kSolid, colour};
  for (std::size_t i = 0; i < run.rows.size(); i += stride_of(run)) {
    line.x.push_back(run.rows[i].t_s);
    line.y.push_back(value(run.rows[i]));
  }
  return line;
}

struct Named {
  std::string name;
  const ContourRun* run;
};

void draw(const std::string& title, const std::vector<Named>& runs, const std::filesystem::path& png) {
  const ContourRun& first = *runs.front().run;
  const auto reference = [](const ContourRow& row) { return row.reference.position_m; };
  const auto tool = [](const ContourRow& row) { return row.tool_m; };
  // Zoom: where the last run (the baseline, if there are two) is farthest off.
  const ContourRun& last = *runs.back().run;
  const auto worst = std::max_element(last.rows.begin(), last.rows.end(), [](const auto& a, const auto& b) {
    return std::abs(a.error_in_frame_m[1]) < std::abs(b.error_in_frame_m[1]);
  });
  const Vec2 place = worst->reference.position_m.head<2>();
  constexpr double kReach = 0.25e-3;

  Panel plane{.title = "contour", .x_label = "x [mm]", .y_label = "y [mm]", .equal_axes = true};
  Panel zoom{
      .title = "where the error is largest", .x_label = "x [mm]", .y_label = "y [mm]", .equal_axes = true};
  Panel speed{.title = "tangential speed", .x_label = "time [s]", .y_label = "[mm/s]"};
  Panel normal{.title = "error across the contour", .x_label = "time [s]", .y_label = "[um]"};
  plane.lines.push_back(path_line(first, "reference", Line::Style::kDashed, 7, reference));
  zoom.lines.push_back(path_line(first, "reference", Line::Style::kDashed, 7, reference, &place, kReach));
  int colour = 0;
  for (const auto& [name, run] : runs) {
    plane.lines.push_back(path_line(*run, name, Line::Style::kSolid, colour, tool));
    zoom.lines.push_back(path_line(*run, name, Line::Style::kSolid, colour, tool, &place, kReach));
    ++colour;
  }
  // The baseline lies below.
  for (std::size_t i = runs.size(); i-- > 0;) {
    const auto& [name, run] = runs[i];
    speed.lines.push_back(trace_line(*run, name, static_cast<int>(i), [](const ContourRow& row) {
      return 1e3 * row.tool_velocity_m_per_s.dot(row.reference.tangent);
    }));
    normal.lines.push_back(trace_line(*run, name, static_cast<int>(i),
                                      [](const ContourRow& row) { return 1e6 * row.error_in_frame_m[1]; }));
  }
  draw_figure({.title = title,
               .panels = {plane, zoom, speed, normal},
               .columns = 2,
               .panel_width_px = 560,
               .panel_height_px = 400},
              png);
}

/// What the beam left on the workpiece: pictures, joules, depth and kerf along the path.
ordered_json burn(const ContourRun& run, const slave::Plan& plan, const geometry::Polyline& contour,
                  const std::string& material, const std::filesystem::path& out) {
  const geometry::Box box = geometry::bounding_box(contour.points_m);
  const slave::PulsedSourceSettings source;
  slave::HeightMap map(
      {.centre_m = box.centre(), .half_width_m = 0.5 * box.size().maxCoeff() + 0.5e-3, .pixel_m = 7.5e-6},
      slave::material(material), source);
  const geometry::NearestIndex corridor(contour);
  geometry::Polyline path{{}, contour.closed};
  for (std::size_t i = 0; i + 1 < run.rows.size(); ++i) {
    const ContourRow& row = run.rows[i];
    const Vec2 from = row.tool_m.head<2>();
    map.expose(from, run.rows[i + 1].tool_m.head<2>(), row.laser_w, plan.period_s, 0.0, &corridor);
    if (row.reference.arc_length_m < plan.path.length_m()) path.points_m.push_back(from);
  }
  const slave::MarkAlongPath mark = slave::measure_mark(map, path, source.spot_radius_m);
  if (!cv::imwrite((out / "mark.png").string(), map.picture()) ||
      !cv::imwrite((out / "depth.png").string(), map.depth_picture())) {
    throw Refusal(fmt::format("{}: cannot be written", out.string()));
  }
  const auto& energy = map.energy();
  return {{"material", material},
          {"depth_um", mark.depth_m * 1e6},
          {"depth_variation_percent", 100.0 * mark.depth_variation},
          {"kerf_um", mark.kerf_m * 1e6},
          {"energy_inside_j", energy.inside_j},
          {"energy_outside_corridor_j", energy.outside_j},
          {"absorbed_j", energy.absorbed_j}};
}

ContourRunSettings run_settings(const Options& options) {
  ContourRunSettings s;
  s.plan.speed_m_per_s = options.speed_mm_s * 1e-3;
  s.plan.corner = corner_of(options.corner);
  s.plan.tolerance_m = options.tolerance_um * 1e-6;
  s.follower.loop_delay = options.loop_delay;
  s.follower.preview = !options.no_preview;
  s.follower.model_ahead = !options.no_model_ahead;
  s.follower.quiet_for(s.plan.speed_m_per_s, s.plan.corner == slave::CornerPolicy::kSlow);
  if (options.along_rad_s > 0.0) s.follower.along_rad_s = options.along_rad_s;
  if (options.across_rad_s > 0.0) s.follower.across_rad_s = options.across_rad_s;
  s.controller = kind_of(options.controller);
  s.ideal = options.plant == "ideal";
  s.mismatch = options.mismatch;
  s.seed = options.seed;
  return s;
}

ordered_json tuning(const ContourRunSettings& s) {
  return {{"along_rad_s", s.follower.along_rad_s},       {"across_rad_s", s.follower.across_rad_s},
          {"observer_rad_s", s.follower.observer_rad_s}, {"velocity_rad_s", s.follower.velocity_rad_s},
          {"model_ahead", s.follower.model_ahead},       {"preview", s.follower.preview},
          {"loop_delay", s.follower.loop_delay}};
}

ordered_json one_picture(const std::string& image, const Options& options,
                         const ContourExperiment& experiment, const std::filesystem::path& out) {
  const ContourRunSettings settings = run_settings(options);
  const geometry::Polyline contour =
      contour_of(image, options, robot::load_robot(settings.robot), experiment.closed);
  const auto plan = slave::make_plan(contour, settings.plan);
  if (!plan) throw Refusal(fmt::format("{}: {}", image, plan.error()));
  std::filesystem::create_directories(out);
  const ContourRun run = run_contour(*plan, settings);
  ordered_json result{{"experiment", experiment.name},
                      {"image", image},
                      {"length_mm", plan->path.length_m() * 1e3},
                      {"closed", contour.closed},
                      {"controller", options.controller},
                      {"corner", options.corner},
                      {"plant", options.plant},
                      {"seed", options.seed},
                      {"control_hz", settings.plan.control_hz}};
  result.update(measure(run, *plan, contour, settings));
  result["tuning"] = tuning(settings);
  result["burn"] = burn(run, *plan, contour, options.material, out);
  write_contour_trace(run, out / "trace.csv");

  std::vector<Named> runs{{options.controller, &run}};
  ContourRun baseline;
  if (experiment.closed && options.controller != "independent") {
    ContourRunSettings other = settings;
    other.controller = slave::ControllerKind::kIndependent;
    baseline = run_contour(*plan, other);
    runs.push_back({"independent", &baseline});
    const auto measured = measure(baseline, *plan, contour, other);
    result["independent"] = {{"normal_error_um", measured["normal_error_um"]},
                             {"tangential_speed", measured["tangential_speed"]}};
    result["normal_error_ratio"] =
        result["normal_error_um"]["rms"].get<double>() / measured["normal_error_um"]["rms"].get<double>();
  }
  draw(fmt::format("{} at {:g} mm/s", image, options.speed_mm_s), runs, out / "panels.png");

  if (options.sweep) {
    // Contour error against speed.
    Line rms{"rms", {}, {}}, max{"max", {}, {}};
    ordered_json rows = ordered_json::array();
    for (const double speed : {1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0}) {
      Options faster = options;
      faster.speed_mm_s = speed;
      const ContourRunSettings s = run_settings(faster);
      const auto p = slave::make_plan(contour, s.plan);
      if (!p) throw Refusal(p.error());
      const auto m = measure(run_contour(*p, s), *p, contour, s);
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

void write_json(const std::filesystem::path& file, const ordered_json& json) {
  std::ofstream stream(file);
  stream << json.dump(2) << "\n";
  if (!stream.flush()) throw Refusal(fmt::format("{}: cannot be written", file.string()));
}

int run(Options& options, const ContourExperiment& experiment) {
  options.settings.fill();
  const std::filesystem::path out = options.out;
  std::error_code failed;
  std::filesystem::create_directories(out, failed);
  if (failed) throw Refusal(fmt::format("--out {}: {}", options.out, failed.message()));
  ordered_json result;
  if (!options.image.empty()) {
    result = one_picture(options.image, options, experiment, out);
  } else {
    // All pictures: each in its folder; the top level repeats the first one's measures and lists all.
    ordered_json all = ordered_json::array();
    for (const auto& picture : experiment.pictures) {
      all.push_back(one_picture(picture, options, experiment, out / picture));
      write_json(out / picture / "result.json", all.back());
    }
    result = all.front();
    std::filesystem::copy_file(out / experiment.pictures.front() / "trace.csv", out / "trace.csv",
                               std::filesystem::copy_options::overwrite_existing);
    result["pictures"] = all;
  }
  write_json(out / "result.json", result);
  fmt::print("{}\n", result.dump(2));
  return 0;
}

}  // namespace

void add_contour_experiment(CLI::App& app, Action& action, const ContourExperiment& experiment) {
  auto* command = app.add_subcommand(experiment.name, experiment.help);
  auto o = std::make_shared<Options>();
  o->speed_mm_s = experiment.speed_mm_s;
  o->out = "out/" + experiment.name;
  auto& s = o->settings;
  s.add("image", o->image, "picture: a shipped name or a file; none: the thesis' set");
  s.add("width_mm", o->width_mm, {.min = 0, .max = 1000},
        "width of the whole picture, 0: fitted to the workspace");
  s.add("speed_mm_s", o->speed_mm_s, {.min = 0.1, .max = 300}, "tangential speed");
  s.add("controller", o->controller, "law", {"auto", "independent", "preview", "contouring"});
  s.add("corner", o->corner, "what to do at corners", {"exact", "rounded", "slow"});
  s.add("tolerance_um", o->tolerance_um, {.min = 0, .max = 1000}, "rounding of corners");
  s.add("plant", o->plant, "full: friction, mismatch, Hall sensors; ideal: none of them", {"full", "ideal"});
  s.add("material", o->material, "what the beam meets", slave::material_names());
  s.add("mismatch", o->mismatch, {.min = 0, .max = 0.5}, "how far the plant is off its file, as a share");
  s.add("loop_delay", o->loop_delay, {.min = 0, .max = slave::kMostLoopDelay},
        "samples from a reading to the effect of its currents");
  s.add("no_preview", o->no_preview, "accelerations of the same sample, as if the loop had no delay");
  s.add("no_model_ahead", o->no_model_ahead, "no force of the model sent ahead, only the observer");
  s.add("along_rad_s", o->along_rad_s, {.min = 0, .max = 500}, "bandwidth along the path, 0: by speed");
  s.add("across_rad_s", o->across_rad_s, {.min = 0, .max = 500}, "contouring: across it, 0: the usual one");
  s.add("sweep", o->sweep, "contour error against speed, 1 to 100 mm/s");
  s.add("seed", o->seed, {.min = 0, .max = 1e15}, "of everything random");
  s.add("out", o->out, "folder for the results");
  s.attach(*command);
  command->callback([o, experiment, &action] { action = [o, experiment] { return run(*o, experiment); }; });
}

}  // namespace telekerf::experiments
