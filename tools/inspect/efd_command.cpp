// SPDX-License-Identifier: Apache-2.0
// telekerf-inspect efd: elliptic Fourier descriptors of a closed polygon, in the file's own units.
#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "common/geometry/elliptic_fourier.h"
#include "common/runtime/results.h"
#include "common/runtime/startup_error.h"
#include "common/vision/export/csv.h"
#include "tools/inspect/commands.h"

namespace telekerf::inspect {
namespace {

struct EfdOptions {
  std::string points;
  std::size_t harmonics = 20;
};

int inspect_points(const std::string& path, std::size_t harmonics) {
  std::ifstream file(path, std::ios::binary);
  if (!file || !std::filesystem::is_regular_file(path))
    throw input_error(fmt::format("{}: cannot be read", path));
  const std::string text{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  const auto points = vision::points_from_csv(text);
  if (!points) throw input_error(fmt::format("{}: {}", path, points.error()));
  const geometry::Polyline polygon{*points, true};
  const auto fit = geometry::fit_elliptic_fourier(polygon, harmonics);
  if (!fit) throw input_error(fmt::format("{}: {}", path, fit.error()));

  nlohmann::json json{{"points", points->size()}, {"harmonics", harmonics}};
  json["center"] = {fit->centre.x(), fit->centre.y()};
  json["coefficients"] = nlohmann::json::array();
  for (const auto& h : fit->harmonics) json["coefficients"].push_back({h.a, h.b, h.c, h.d});
  json["max_deviation"] = geometry::largest_deviation_m(*fit, polygon);
  for (const auto& h : fit->harmonics) {
    if (!std::isfinite(h.a + h.b + h.c + h.d))
      throw input_error(fmt::format("{}: its numbers are too large to calculate with", path));
  }
  std::cout << json_text(json) << '\n';
  return 0;
}

}  // namespace

void add_efd_command(Program& program) {
  program.add(
      "efd", "Prints the elliptic Fourier descriptors of a closed polygon", EfdOptions{},
      [](EfdOptions& o, Settings& s) {
        s.add("points", o.points, kFile, "CSV with x,y a line").as_argument();
        s.add("harmonics", o.harmonics, {.min = 1, .max = 4096}, "how many");
      },
      [](const EfdOptions& o) { return inspect_points(o.points, o.harmonics); });
}

}  // namespace telekerf::inspect
