// SPDX-License-Identifier: Apache-2.0
// telekerf-experiment closed-contour: thesis 8.2, outlines by contouring control beside independent joints.
#include "experiments/machining/contour_experiment.h"

namespace telekerf::experiments {
namespace {

/// A column of figure 8.4, whose rows are A to C, D to F, G to I and J to L.
constexpr PanelLetters in_figure_4(char column) {
  const auto row = [&](int n) { return static_cast<char>('A' + column + 3 * n); };
  return {.picture = row(0), .tracking = row(1), .zoom = row(2), .across = row(3)};
}

/// The same of figure 8.5.
constexpr PanelLetters in_figure_5(char column) {
  const auto row = [&](int n) { return static_cast<char>('A' + column + 3 * n); };
  return {.picture = row(0), .model = row(1), .speed = row(3), .mark = row(2)};
}

}  // namespace

void add_closed_contour_command(Program& program) {
  add_contour_experiment(
      program, {.name = "closed-contour",
                .help = "Thesis 8.2: outlines by contouring control; result.json, trace.csv, figures",
                .subjects = {{.picture = "eight-leg-cam", .letters = in_figure_4(0)},
                             {.picture = "gear", .letters = in_figure_4(1)},
                             {.picture = "octagon", .letters = in_figure_4(2)},
                             {"melanoma-like", &workpiece::kFibreglass, in_figure_5(0)},
                             {"tissue-like", &workpiece::kFibreglass, in_figure_5(1)},
                             {.picture = "hand-drawn", .letters = in_figure_5(2)}},
                .speed_mm_s = 8.0,
                .closed = true});
}

}  // namespace telekerf::experiments
