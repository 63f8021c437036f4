// SPDX-License-Identifier: Apache-2.0
// telekerf-inspect contour: what a picture or drawing becomes, as numbers and as files.
#include <fmt/format.h>

#include <filesystem>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

#include "common/geometry/cutting_order.h"
#include "common/geometry/elliptic_fourier.h"
#include "common/runtime/resources.h"
#include "common/runtime/results.h"
#include "common/runtime/startup_error.h"
#include "common/vision/export/csv.h"
#include "common/vision/export/gcode.h"
#include "common/vision/export/overlay.h"
#include "common/vision/export/svg.h"
#include "common/vision/load.h"
#include "tools/inspect/commands.h"

namespace telekerf::inspect {
namespace {

struct Options {
  std::string input;
  std::string mode = "auto";
  std::vector<double> start;
  std::vector<double> end;
  double width_mm = 0.0;
  double height_mm = 0.0;
  double workspace_mm = 20.0;
  std::string anchor = "box";
  std::string harmonics = "auto";
  double tolerance_mm = 0.05;
  std::size_t select = 0;
  std::string out;
};

/// A number of harmonics, or 0 for "auto".
std::size_t harmonics_of(const std::string& text) {
  if (text == "auto") return 0;
  std::size_t used = 0;
  int value = 0;
  try {
    value = std::stoi(text, &used);
  } catch (const std::exception&) {
    used = 0;
  }
  if (used != text.size() || value < 1 || value > 4096) {
    throw StartupError(fmt::format("--harmonics {}: must be auto or a whole number within [1, 4096]", text));
  }
  return static_cast<std::size_t>(value);
}

vision::LoadRequest request_of(const Options& o) {
  vision::LoadRequest request;
  request.extraction.mode = *vision::kExtractionModes.find(o.mode);
  if (!o.start.empty()) request.extraction.start_px = Vec2(o.start[0], o.start[1]);
  if (!o.end.empty()) request.extraction.end_px = Vec2(o.end[0], o.end[1]);
  if (o.width_mm > 0.0) request.scale.picture_width_m = 1e-3 * o.width_mm;
  if (o.height_mm > 0.0) request.scale.picture_height_m = 1e-3 * o.height_mm;
  request.scale.workspace_radius_m = 1e-3 * o.workspace_mm;
  request.scale.anchor = *vision::kAnchorModes.find(o.anchor);
  request.select = o.select;
  return request;
}

nlohmann::json descriptors_of(const geometry::Polyline& line, const Options& o) {
  nlohmann::json json{{"harmonics", nullptr}, {"efd_max_deviation_m", nullptr}};
  const std::size_t asked = harmonics_of(o.harmonics);
  if (!line.closed) return json;  // only closed contours have descriptors
  tl::expected<geometry::ChosenHarmonics, std::string> chosen;
  if (asked == 0) {
    chosen = geometry::choose_harmonics(line, 1e-3 * o.tolerance_mm);
  } else if (auto fit = geometry::fit_elliptic_fourier(line, asked)) {
    chosen = geometry::ChosenHarmonics{*fit, geometry::largest_deviation_m(*fit, line), true};
  } else {
    chosen = tl::unexpected(fit.error());
  }
  if (!chosen) throw StartupError(fmt::format("{}: {}", o.input, chosen.error()));
  json["harmonics"] = chosen->curve.harmonics.size();
  json["efd_max_deviation_m"] = chosen->largest_deviation_m;
  return json;
}

int inspect(const Options& o) {
  const std::string file = find_resource("pictures", o.input, ".png").string();
  const auto loaded = vision::load_contours(file, request_of(o));
  if (!loaded) throw StartupError(loaded.error());
  const geometry::Polyline& line = loaded->contours[loaded->selected];
  const geometry::Box box = geometry::bounding_box(line.points_m);
  const vision::GCode gcode = vision::to_gcode(loaded->contours);

  nlohmann::json json = descriptors_of(line, o);
  json["input"] = std::filesystem::path(file).filename().string();
  json["mode"] = loaded->mode;
  json["why"] = loaded->why;
  json["closed"] = line.closed;
  json["points"] = line.size();
  json["length_m"] = geometry::length_m(line);
  json["width_m"] = box.size().x();
  json["height_m"] = box.size().y();
  json["contours"] = loaded->contours.size();
  json["selected"] = loaded->selected;
  json["order"] = geometry::cutting_order(loaded->contours).order;
  json["contrast"] = loaded->contrast;
  json["picture_noise"] = loaded->picture_noise;
  json["noise_m"] = loaded->noise_m[loaded->selected];
  json["metres_per_pixel"] =
      loaded->metres_per_pixel > 0.0 ? nlohmann::json(loaded->metres_per_pixel) : nlohmann::json();
  json["cutting_time_s"] = gcode.cutting_time_s;
  json["travel_m"] = gcode.travel_m;

  const std::filesystem::path out(o.out);
  make_folder("--out", out);
  write_atomically(out / "contour.csv", vision::to_csv(line));
  write_atomically(out / "contour.svg", vision::to_svg(loaded->contours));
  write_atomically(out / "contour.ngc", gcode.text);
  const cv::Mat overlay = vision::overlay_of(*loaded);
  if (overlay.empty() || !cv::imwrite((out / "overlay.png").string(), overlay)) {
    throw StartupError(fmt::format("{}: cannot be written", (out / "overlay.png").string()));
  }
  std::cout << json_text(json) << '\n';
  return 0;
}

}  // namespace

void add_contour_command(CLI::App& app, Action& action) {
  auto o = std::make_shared<Options>();
  auto* sub = app.add_subcommand(
      "contour", "Turns a picture or drawing into an ordered path, with its size and quality");
  sub->add_option("INPUT", o->input, "PNG, JPEG, ... , SVG or DXF file, or the name of a shipped picture")
      ->required();
  sub->add_option("--mode", o->mode, "how pixels become points")
      ->check(CLI::IsMember({"auto", "thesis", "outline", "stroke"}))
      ->capture_default_str();
  const CLI::Validator pixels = within(-1e6, 1e6);
  sub->add_option("--start", o->start, "where the path starts, pixels X,Y")
      ->delimiter(',')
      ->expected(2)
      ->check(pixels);
  sub->add_option("--end", o->end, "where an open path ends, pixels X,Y")
      ->delimiter(',')
      ->expected(2)
      ->check(pixels);
  const CLI::Validator length_mm = within(1e-3, 1e6);
  auto* width =
      sub->add_option("--width-mm", o->width_mm, "true width of the whole picture")->check(length_mm);
  sub->add_option("--height-mm", o->height_mm, "and its true height, where pixels are not square")
      ->check(length_mm)
      ->needs(width);
  sub->add_option("--workspace-mm", o->workspace_mm,
                  "without --width-mm the contour fills 60 % of this radius")
      ->check(length_mm)
      ->capture_default_str();
  sub->add_option("--anchor", o->anchor, "what lies on the workpiece's origin")
      ->check(CLI::IsMember({"box", "first", "image"}))
      ->capture_default_str();
  sub->add_option("--harmonics", o->harmonics,
                  "elliptic Fourier descriptors of a closed contour: a number or auto")
      ->capture_default_str();
  sub->add_option("--tolerance-mm", o->tolerance_mm, "largest deviation that auto allows")
      ->check(within(1e-6, 1e3))
      ->capture_default_str();
  sub->add_option("--select", o->select, "which contour, 0 is the largest")
      ->check(whole_number())
      ->capture_default_str();
  sub->add_option("--out", o->out, "folder for contour.csv, contour.svg, contour.ngc and overlay.png")
      ->required();
  sub->callback([o, &action] { action = [o] { return inspect(*o); }; });
}

}  // namespace telekerf::inspect
