// SPDX-License-Identifier: Apache-2.0
// Line plots by gnuplot: several panels with axes, ticks, labels and legend.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace telekerf::reporting {

struct Line {
  enum class Style { kSolid, kDashed, kPoints };
  std::string label = {};  ///< empty: not in the legend
  std::vector<double> x = {};
  std::vector<double> y = {};  ///< as long as x; a NaN leaves a gap
  Style style = Style::kSolid;
  int colour = -1;  ///< 0..7 of the palette; -1: the line's place in the panel
};

struct Panel {
  std::string title = {};
  std::string x_label = {};
  std::string y_label = {};
  std::vector<Line> lines = {};
  std::optional<std::array<double, 2>> x_range = {};  ///< default: the data's
  std::optional<std::array<double, 2>> y_range = {};
  bool log_x = false;
  bool log_y = false;
  bool axes = true;                    ///< false: a legend, whose lines stand for no values
  bool equal_axes = false;             ///< one unit is as long in x as in y (paths in the plane)
  /// A PNG instead of lines; with x_range and y_range its edges are there, without them it has no axes.
  std::filesystem::path picture = {};
};

struct Figure {
  std::string title = {};
  std::vector<Panel> panels = {};  ///< row by row
  int columns = 1;
  int panel_width_px = 480;
  int panel_height_px = 320;
};

/// Writes the figure, the same as SVG, and what it shows as CSV: NAME.png, NAME.svg, NAME.csv; the folder
/// must exist. The same figure leaves the same bytes. Throws StartupError, with what gnuplot said, if it is
/// missing or a file is not drawn to its end.
void draw_figure(const Figure& figure, const std::filesystem::path& png);

/// What gnuplot is told, all but the data's drawing surface (terminal and output).
std::string gnuplot_script(const Figure& figure);

/// A row a point: panel, labels of its axes, line, x, y.
std::string figure_csv(const Figure& figure);

}  // namespace telekerf::reporting
