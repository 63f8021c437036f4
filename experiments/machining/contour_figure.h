// SPDX-License-Identifier: Apache-2.0
// Runs along one contour side by side, as in the thesis' figures 8.1 to 8.5.
#pragma once

#include <filesystem>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "experiments/machining/contour_run.h"

namespace telekerf::experiments {

struct NamedRun {
  std::string name;
  const ContourRun* run;
};

/// The picture, unless it is empty, which is left beside as source.png; the contour, the place where the last
/// run is farthest off, speed and error across the contour. The first run's reference is drawn. Throws
/// StartupError.
/// `mark`: a picture of what the laser left, the last panel.
void draw_runs(const std::string& title, const std::vector<NamedRun>& runs, const cv::Mat& picture,
               const std::filesystem::path& mark, const std::filesystem::path& png);

}  // namespace telekerf::experiments
