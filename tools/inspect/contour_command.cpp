// SPDX-License-Identifier: Apache-2.0
// telekerf-inspect contour: what a picture or drawing becomes, as numbers and as files.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <nlohmann/json.hpp>

#include "common/geometry/cutting_order.h"
#include "common/geometry/elliptic_fourier.h"
#include "common/reporting/picture_file.h"
#include "common/runtime/resources.h"
#include "common/runtime/results.h"
#include "common/runtime/startup_error.h"
#include "common/vision/export/csv.h"
#include "common/vision/export/dxf.h"
#include "common/vision/export/gcode.h"
#include "common/vision/export/overlay.h"
#include "common/vision/export/svg.h"
#include "common/vision/load.h"
#include "common/vision/picture_flags.h"
#include "tools/inspect/commands.h"

namespace telekerf::inspect {
namespace {

struct ContourOptions {
  std::string input;
  vision::ExtractionMode mode = vision::ExtractionMode::kAuto;
  std::vector<double> start;
  std::vector<double> end;
  vision::PictureFlags picture;
  std::optional<double> width_mm;
  std::optional<double> height_mm;
  double workspace_mm = 20.0;
  vision::AnchorMode anchor = vision::AnchorMode::kBoundingBox;
  std::string harmonics = "auto";
  double tolerance_mm = 0.05;
  std::size_t select = 0;
  vision::GCodeSettings gcode;
  double speed_mm_s = 8.0;
  double travel_mm_s = 50.0;
  double overlap_mm = 0.2;
  double kerf_um = 0.0;
  std::vector<double> origin_mm;
  double join_mm = 0.01;
  std::optional<double> dpi;
  vision::LengthUnit units = vision::LengthUnit::kFile;
  std::vector<std::string> layers;
  std::vector<std::string> colours;
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
    throw usage_error(fmt::format("--harmonics {}: must be auto or a whole number within [1, 4096]", text));
  }
  return static_cast<std::size_t>(value);
}

vision::LoadRequest request_of(const ContourOptions& o) {
  vision::LoadRequest request;
  request.extraction.mode = o.mode;
  if (!o.start.empty()) request.extraction.start_px = Vec2(o.start[0], o.start[1]);
  if (!o.end.empty()) request.extraction.end_px = Vec2(o.end[0], o.end[1]);
  if (o.height_mm && !o.width_mm) throw usage_error("--height-mm needs --width-mm");
  if (o.width_mm) request.scale.picture_width_m = 1e-3 * *o.width_mm;
  if (o.height_mm) request.scale.picture_height_m = 1e-3 * *o.height_mm;
  request.scale.workspace_radius_m = 1e-3 * o.workspace_mm;
  request.scale.anchor = o.anchor;
  request.select = o.select;
  o.picture.apply_to(request);
  request.drawing.join_m = 1e-3 * o.join_mm;
  request.drawing.dpi = o.dpi;
  request.drawing.unit_m = vision::metres_of(o.units);
  request.drawing.layers = o.layers;
  request.drawing.colours = o.colours;
  return request;
}

nlohmann::json descriptors_of(const geometry::Polyline& line, const ContourOptions& o) {
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
  if (!chosen) throw input_error(fmt::format("{}: {}", o.input, chosen.error()));
  json["harmonics"] = chosen->curve.harmonics.size();
  json["efd_max_deviation_m"] = chosen->largest_deviation_m;
  return json;
}

/// All contours by their numbers; those that are left out have none, and the reason.
nlohmann::json list_of(const vision::LoadedContours& loaded) {
  nlohmann::json out = nlohmann::json::array();
  const std::vector<bool> holes = geometry::holes(loaded.contours);
  for (std::size_t i = 0; i < loaded.contours.size(); ++i) {
    const geometry::Polyline& line = loaded.contours[i];
    out.push_back(
        {{"number", i}, {"length_m", geometry::length_m(line)}, {"closed", line.closed}, {"hole", holes[i]}});
    const bool labelled = i < loaded.labels.size();
    out.back()["layer"] = labelled ? loaded.labels[i].layer : "";
    out.back()["colour"] = labelled ? loaded.labels[i].colour : "";
    out.back()["left_out_why"] = nullptr;
  }
  for (std::size_t i = 0; i < loaded.left_out.size(); ++i) {
    const geometry::Polyline& line = loaded.left_out[i];
    const vision::ContourLabel& label = loaded.left_out_labels[i];
    out.push_back({{"number", nullptr},
                   {"length_m", geometry::length_m(line)},
                   {"closed", line.closed},
                   {"hole", false},
                   {"layer", label.layer},
                   {"colour", label.colour},
                   {"left_out_why", label.left_out_why}});
  }
  return out;
}

int inspect_contour(const ContourOptions& o) {
  const std::string file = find_resource("pictures", o.input, ".png").string();
  const auto loaded = vision::load_contours(file, request_of(o));
  if (!loaded) throw input_error(loaded.error());
  const geometry::Polyline& line = loaded->contours[loaded->selected];
  const geometry::Box box = geometry::bounding_box(line.points_m);
  vision::GCodeSettings settings = o.gcode;
  settings.cutting_speed_m_per_s = 1e-3 * o.speed_mm_s;
  settings.travel_speed_m_per_s = 1e-3 * o.travel_mm_s;
  settings.overlap_m = 1e-3 * o.overlap_mm;
  settings.kerf_m = 1e-6 * o.kerf_um;
  if (!o.origin_mm.empty()) settings.origin_m = 1e-3 * Vec2(o.origin_mm[0], o.origin_mm[1]);
  const auto gcode = vision::to_gcode(loaded->contours, settings);
  if (!gcode) throw input_error(fmt::format("{}: {}", o.input, gcode.error()));
  for (const std::string& warning : gcode->warnings) std::cerr << "warning: " << warning << '\n';
  const auto open = std::count_if(loaded->contours.begin(), loaded->contours.end(),
                                  [](const geometry::Polyline& contour) { return !contour.closed; });
  if (o.kerf_um > 0.0 && open > 0) {
    std::cerr << fmt::format("warning: {} of {} contours are open, which --kerf-um does not move\n", open,
                             loaded->contours.size());
  }

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
  json["size_from"] = loaded->size_from;
  json["list"] = list_of(*loaded);
  json["cutting_time_s"] = gcode->cutting_time_s;
  json["travel_m"] = gcode->travel_m;
  json["warnings"] = gcode->warnings;

  const std::filesystem::path out(o.out);
  make_folder("--out", out);
  write_atomically(out / "contour.csv", vision::to_csv(loaded->contours, loaded->selected));
  write_atomically(out / "contour.dxf", vision::to_dxf(loaded->contours));
  write_atomically(out / "contour.svg", vision::to_svg(loaded->contours));
  write_atomically(out / "contour.ngc", gcode->text);
  reporting::write_picture(out / "overlay.png", vision::overlay_of(*loaded));
  std::cout << json_text(json) << '\n';
  return 0;
}

void add_contour_parameters(ContourOptions& o, Settings& s) {
  const Bounds pixels{.min = -1e6, .max = 1e6, .unit = "pixels"};
  const Bounds length_mm{.min = 1e-3, .max = 1e6, .unit = "mm"};
  s.add("input", o.input, kPicture, "PNG, JPEG, ..., SVG or DXF file, or the name of a shipped picture")
      .as_argument();
  s.add("mode", o.mode, vision::kExtractionModes, "how pixels become points");
  s.add("start", o.start, 2, pixels, "X,Y: where the path starts");
  s.add("end", o.end, 2, pixels, "X,Y: where an open path ends");
  o.picture.add_parameters(s);
  s.add("width_mm", o.width_mm, length_mm, "true width of the whole picture; without it: see workspace_mm");
  s.add("height_mm", o.height_mm, length_mm, "and its true height, where pixels are not square");
  s.add("workspace_mm", o.workspace_mm, length_mm, "without width_mm the contour fills 60 % of this radius");
  s.add("anchor", o.anchor, vision::kAnchorModes, "what lies on the workpiece's origin");
  s.add("harmonics", o.harmonics, TextForm{"auto|NUMBER"},
        "elliptic Fourier descriptors of a closed contour");
  s.add("tolerance_mm", o.tolerance_mm, {.min = 1e-6, .max = 1e3, .unit = "mm"},
        "largest deviation that harmonics = auto allows");
  s.add("select", o.select, {.min = 0, .max = 1e9},
        "the one contour that is anchored, fitted and measured, by its number in list; 0 is the largest");
  s.add("speed_mm_s", o.speed_mm_s, {.min = 0.01, .max = 1000, .unit = "mm/s"},
        "of cutting, for contour.ngc");
  s.add("travel_mm_s", o.travel_mm_s, {.min = 0.01, .max = 10000, .unit = "mm/s"},
        "between contours, for contour.ngc");
  s.add("power", o.gcode.full_power, {.min = 0, .max = 100000}, "the S word of contour.ngc");
  s.add("passes", o.gcode.passes, {.min = 1, .max = 100}, "how often contour.ngc cuts each contour");
  s.add("overlap_mm", o.overlap_mm, {.min = 0, .max = 100, .unit = "mm"},
        "how far a closed cut of contour.ngc runs on beyond its start");
  s.add("kerf_um", o.kerf_um, {.min = 0, .max = 2000, .unit = "um"},
        "width of the cut that contour.ngc compensates: closed contours are moved by half of it, holes "
        "inwards");
  s.add("origin_mm", o.origin_mm, 2, {.min = -1e6, .max = 1e6, .unit = "mm"},
        "X,Y: the place on the workpiece that contour.ngc calls 0,0");
  s.add("arcs", o.gcode.arcs, "circular moves (G2, G3) in contour.ngc where they need fewer lines");
  s.add("join_mm", o.join_mm, {.min = 0, .max = 10, .unit = "mm"},
        "ends of a drawing's lines as near as this are joined");
  s.add("dpi", o.dpi, {.min = 1, .max = 100000, .unit = "pixels an inch"},
        "of a scan, or of an SVG file in pixels; without it: what the file says");
  s.add("units", o.units, vision::kLengthUnits, "a unit of an SVG or DXF file");
  s.add("layers", o.layers, TextForm{"NAME"}, "these layers of a drawing alone, with those within them");
  s.add("colours", o.colours, TextForm{"COLOUR"},
        "these colours of a drawing alone: #rrggbb, a name, or a DXF number");
  s.add("out", o.out, kFolder, "for contour.csv, contour.svg, contour.dxf, contour.ngc and overlay.png")
      .must_be_given();
}

}  // namespace

void add_contour_command(Program& program) {
  program.add("contour", "Turns a picture or drawing into an ordered path, with its size and quality",
              ContourOptions{}, add_contour_parameters, inspect_contour);
}

}  // namespace telekerf::inspect
