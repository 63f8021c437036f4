// SPDX-License-Identifier: Apache-2.0
// telekerf-experiment open-contour: thesis 8.1, letters by preview control.
#include "experiments/machining/contour_experiment.h"

namespace telekerf::experiments {
namespace {

/// Figures 8.1 and 8.2; the third stroke is in 8.3 alone.
constexpr PanelLetters kLetters{.picture = 'A', .tracking = 'B', .speed = 'C', .speed_error = 'D'};

}  // namespace

void add_open_contour_command(Program& program) {
  add_contour_experiment(
      program, {.name = "open-contour",
                .help = "Thesis 8.1: drawn strokes by preview control; result.json, trace.csv, figures",
                .subjects = {{.picture = "letter-e", .letters = kLetters},
                             {.picture = "letter-s", .letters = kLetters},
                             {.picture = "script-e"}},
                .speed_mm_s = 2.0,
                .closed = false});
}

}  // namespace telekerf::experiments
