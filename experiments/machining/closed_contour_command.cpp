// SPDX-License-Identifier: Apache-2.0
// telekerf-experiment closed-contour: thesis 8.2, outlines by contouring control beside independent joints.
#include "experiments/machining/contour_experiment.h"

namespace telekerf::experiments {

void add_closed_contour_command(Program& program) {
  add_contour_experiment(
      program, {.name = "closed-contour",
                .help = "Thesis 8.2: outlines by contouring control; result.json, trace.csv, figures",
                .subjects = {{"eight-leg-cam"},
                             {"gear"},
                             {"octagon"},
                             {"melanoma-like", &workpiece::kFibreglass},
                             {"tissue-like", &workpiece::kFibreglass},
                             {"hand-drawn"}},
                .speed_mm_s = 8.0,
                .closed = true});
}

}  // namespace telekerf::experiments
