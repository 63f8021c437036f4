// SPDX-License-Identifier: Apache-2.0
// What open-contour and closed-contour share: options, runs, result.json, trace.csv and the panels of figures
// 8.1 to 8.5.
#pragma once

#include <string>
#include <vector>

#include "common/workpiece/material.h"
#include "experiments/commands.h"
#include "experiments/machining/contour_figure.h"

namespace telekerf::experiments {

struct ContourExperiment {
  std::string name;  ///< of the subcommand
  std::string help;
  struct Subject {
    std::string picture;
    const workpiece::Material* material = &workpiece::kWood;
    PanelLetters letters = {};  ///< of the thesis' figure
  };
  std::vector<Subject> subjects;  ///< without --image
  double speed_mm_s = 8.0;
  bool closed = true;  ///< what kind of contour is expected
};

void add_contour_experiment(Program& program, const ContourExperiment& experiment);

}  // namespace telekerf::experiments
