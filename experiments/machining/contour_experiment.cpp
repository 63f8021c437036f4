// SPDX-License-Identifier: Apache-2.0
#include "experiments/machining/contour_experiment.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <random>

#include "common/geometry/cutting_order.h"
#include "common/reporting/plot.h"
#include "common/runtime/resources.h"
#include "common/runtime/results.h"
#include "common/runtime/settings.h"
#include "common/runtime/startup_error.h"
#include "common/vision/load.h"
#include "common/workpiece/material.h"
#include "experiments/machining/contour_run.h"
#include "experiments/machining/independent_baselines.h"

namespace telekerf::experiments {
namespace {

using nlohmann::ordered_json;

struct Options {
  std::string image;
  std::string robot = "slave-keops";
  double width_mm = 0.0;
  double speed_mm_s = 8.0;
  machining::ControllerKind controller = machining::ControllerKind::kAuto;
  machining::CornerPolicy corner = machining::CornerPolicy::kRounded;
  bool ideal = false;
  const workpiece::Material* material = &workpiece::kWood;
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

struct Source {
  geometry::Polyline contour;
  cv::Mat picture;  ///< empty for vector drawings
};

/// What the lines enclose, holes taken out.
double area_m2(const std::vector<geometry::Polyline>& contours) {
  double sum = 0.0;
  for (const auto& inner : contours) {
    if (!inner.closed) continue;
    const auto around = std::count_if(contours.begin(), contours.end(), [&](const geometry::Polyline& outer) {
      return &outer != &inner && outer.closed && geometry::encloses(outer, inner);
    });
    sum += (around % 2 == 0 ? 1.0 : -1.0) * std::abs(geometry::signed_area_m2(inner));
  }
  return sum;
}

/// The largest contour of the expected kind; if the picture shows none at first sight, it is looked at as
/// strokes or as outlines. Failing that the largest contour is taken as it is (`closed` in the result).
Source contour_of(const std::string& image, const Options& options, const robot::RobotModel& model,
                  bool closed) {
  vision::LoadRequest request;
  request.scale.workspace_radius_m = model.workspace.radius_m;
  if (options.width_mm > 0.0) request.scale.picture_width_m = options.width_mm * 1e-3;
  constexpr std::string_view kDrawn = "outline-";
  const bool drawn = image.starts_with(kDrawn) && image.size() > kDrawn.size() && image.size() < 25 &&
                     image.find_first_not_of("0123456789", kDrawn.size()) == image.npos;
  const std::string file = drawn ? image : find_resource("pictures", image, ".png").string();
  const auto load = [&] {
    return drawn ? vision::contours_of(irregular_outline(std::stoull(image.substr(kDrawn.size()))), request)
                 : vision::load_contours(file, request);
  };
  const auto found = load();
  if (!found) throw StartupError(drawn ? fmt::format("{}: {}", file, found.error()) : found.error());
  const auto wanted = [&](const vision::LoadedContours& loaded) {
    return std::find_if(loaded.contours.begin(), loaded.contours.end(),
                        [&](const geometry::Polyline& c) { return c.closed == closed; });
  };
  if (const auto first = wanted(*found); first != found->contours.end()) return {*first, found->picture};
  if (found->mode != "vector") {
    request.extraction.mode = closed ? vision::ExtractionMode::kOutline : vision::ExtractionMode::kStroke;
    if (const auto again = load()) {
      // The middle of a region is no stroke: that is four times as long as it is wide, at least.
      const double least_m = closed ? 0.0 : 2.0 * std::sqrt(std::max(0.0, area_m2(found->contours)));
      const auto first = wanted(*again);
      if (first != again->contours.end() && geometry::length_m(*first) >= least_m)
        return {*first, again->picture};
    }
  }
  return {found->contours[found->selected], found->picture};
}

/// Rows of a run that a figure shows.
std::size_t stride_of(const ContourRun& run) { return std::max<std::size_t>(1, run.pass.rows.size() / 4000); }

Line path_line(const ContourRun& run, const std::string& label, Line::Style style, int colour,
               const std::function<Vec3(const machining::PassRow&)>& point, const Vec2* around = nullptr,
               double reach_m = 0.0) {
  Line line{label, {}, {}, style, colour};
  const std::size_t stride = around == nullptr ? stride_of(run) : 1;
  for (std::size_t i = 0; i < run.pass.rows.size(); i += stride) {
    const Vec3 p = point(run.pass.rows[i]);
    const bool inside = around == nullptr || (p.head<2>() - *around).cwiseAbs().maxCoeff() < reach_m;
    line.x.push_back(inside ? p.x() * 1e3 : NAN);
    line.y.push_back(inside ? p.y() * 1e3 : NAN);
  }
  return line;
}

Line trace_line(const ContourRun& run, const std::string& label, int colour,
                const std::function<double(const machining::PassRow&)>& value) {
  Line line{label, {}, {}, Line::Style::kSolid, colour};
  for (std::size_t i = 0; i < run.pass.rows.size(); i += stride_of(run)) {
    line.x.push_back(static_cast<double>(i) * run.pass.plan->period_s);
    line.y.push_back(value(run.pass.rows[i]));
  }
  return line;
}

/// The picture that the contour came from, to the left of the finished panels (A of the thesis' figures).
void put_beside(const cv::Mat& picture, const std::filesystem::path& png) {
  if (picture.empty()) return;
  const cv::Mat panels = cv::imread(png.string(), cv::IMREAD_COLOR);
  const int side = panels.rows / 2;
  const double scale = static_cast<double>(side) / std::max(picture.cols, picture.rows);
  cv::Mat small, colour;
  cv::resize(picture, small, {}, scale, scale, scale < 1.0 ? cv::INTER_AREA : cv::INTER_LINEAR);
  if (small.channels() == 1) {
    cv::cvtColor(small, colour, cv::COLOR_GRAY2BGR);
  } else if (small.channels() == 4) {
    cv::cvtColor(small, colour, cv::COLOR_BGRA2BGR);
  } else {
    colour = small;
  }
  cv::Mat all(panels.rows, panels.cols + side + 40, CV_8UC3, cv::Scalar::all(255));
  colour.copyTo(all(
      cv::Rect(20 + (side - colour.cols) / 2, (panels.rows - colour.rows) / 2, colour.cols, colour.rows)));
  cv::putText(all, "source picture", {20, (panels.rows - side) / 2 - 12}, cv::FONT_HERSHEY_SIMPLEX, 0.5,
              cv::Scalar::all(40), 1, cv::LINE_AA);
  panels.copyTo(all(cv::Rect(side + 40, 0, panels.cols, panels.rows)));
  if (!cv::imwrite(png.string(), all)) throw StartupError(fmt::format("{}: cannot be written", png.string()));
}

struct Named {
  std::string name;
  const ContourRun* run;
};

void draw(const std::string& title, const std::vector<Named>& runs, const std::filesystem::path& png) {
  const ContourRun& first = *runs.front().run;
  const auto reference = [](const machining::PassRow& row) { return row.reference.position_m; };
  const auto tool = [](const machining::PassRow& row) { return row.tool_m; };
  // Zoom: where the last run (the baseline, if there are two) is farthest off.
  const ContourRun& last = *runs.back().run;
  const auto worst =
      std::max_element(last.pass.rows.begin(), last.pass.rows.end(), [](const auto& a, const auto& b) {
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
    speed.lines.push_back(trace_line(*run, name, static_cast<int>(i), [](const machining::PassRow& row) {
      return 1e3 * row.tool_velocity_m_per_s.dot(row.reference.tangent);
    }));
    normal.lines.push_back(trace_line(*run, name, static_cast<int>(i), [](const machining::PassRow& row) {
      return 1e6 * row.error_in_frame_m[1];
    }));
  }
  draw_figure({.title = title,
               .panels = {plane, zoom, speed, normal},
               .columns = 2,
               .panel_width_px = 560,
               .panel_height_px = 400},
              png);
}

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
  s.follower.tune_for_speed(s.plan.speed_m_per_s, s.plan.corner == machining::CornerPolicy::kSlow);
  if (options.along_rad_s > 0.0) s.follower.along_rad_s = options.along_rad_s;
  if (options.across_rad_s > 0.0) s.follower.across_rad_s = options.across_rad_s;
  s.controller = options.controller;
  s.ideal = options.ideal;
  s.mismatch = options.mismatch;
  s.seed = options.seed;
  return s;
}

ordered_json one_picture(const std::string& image, const Options& options,
                         const ContourExperiment& experiment, const std::filesystem::path& out) {
  const robot::RobotModel model = robot::load_robot(options.robot);
  const ContourRunSettings settings = run_settings(options, model);
  const Source source = contour_of(image, options, model, experiment.closed);
  const geometry::Polyline& contour = source.contour;
  const auto plan = machining::make_timed_path(contour, settings.plan);
  if (!plan) throw StartupError(fmt::format("{}: {}", image, plan.error()));
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
                      {"seed", options.seed},
                      {"control_hz", settings.plan.control_hz}};
  result.update(measure(run, settings));
  result["tuning"] = tuning(settings);
  result["burn"] = machining::burn({&run.pass, 1}, *options.material, out);
  write_contour_trace(run, out / "trace.csv");

  std::vector<Named> runs{{std::string(machining::kControllers.word(options.controller)), &run}};
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
  draw(fmt::format("{} at {:g} mm/s", image, options.speed_mm_s), runs, out / "panels.png");
  put_beside(source.picture, out / "panels.png");

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
      if (!p) throw StartupError(p.error());
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
  fmt::print("{}\n", json_text(result));
  return 0;
}

void add_parameters(Options& o, Settings& s) {
  s.add("image", o.image, kPicture, "picture: a shipped name or a file; none: the thesis' set");
  s.add("robot", o.robot, kRobot, "that machines: a shipped name or a file");
  s.add("width_mm", o.width_mm, {.min = 0, .max = 1000, .unit = "mm"},
        "width of the whole picture, 0: fitted to the workspace");
  s.add("speed_mm_s", o.speed_mm_s, {.min = 0.1, .max = 300, .unit = "mm/s"}, "tangential speed");
  s.add("controller", o.controller, machining::kControllers, "how the robot is kept on the path");
  s.add("corner", o.corner, machining::kCorners, "what to do at corners");
  s.add("tolerance_um", o.tolerance_um, {.min = 0, .max = 1000, .unit = "um"}, "rounding of corners");
  s.add("plant", o.ideal, kPlants, "what is machined with");
  s.add("material", o.material, workpiece::kMaterials, "what the beam meets");
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
  s.add("out", o.out, kFolder, "folder for the results");
}

}  // namespace

void add_contour_experiment(Program& program, const ContourExperiment& experiment) {
  Options options;
  options.speed_mm_s = experiment.speed_mm_s;
  options.out = "out/" + experiment.name;
  program.add(experiment.name, experiment.help, options, add_parameters,
              [experiment](const Options& o) { return run(o, experiment); });
}

}  // namespace telekerf::experiments
