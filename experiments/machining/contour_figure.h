// SPDX-License-Identifier: Apache-2.0
// Runs along one contour side by side, as in the thesis' figures 8.1 to 8.5.
#pragma once

#include <filesystem>
#include <opencv2/core.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "experiments/machining/contour_run.h"

namespace telekerf::experiments {

struct NamedRun {
  std::string name;
  const ContourRun* run;
};

/// Letters that the thesis' figure has for the panels; 0: it has no such panel.
struct PanelLetters {
  char picture = 0;
  char tracking = 0;
  char model = 0;
  char zoom = 0;
  char speed = 0;
  char speed_error = 0;
  char across = 0;
  char mark = 0;
};

/// The picture, unless it is empty, which is left beside as source.png; tracking in the plane, of a closed
/// contour the detected points and the descriptors fitted to them, the place where the last run is farthest
/// off, tangential velocity and its error, error across the contour, and `mark`, a picture of what the laser
/// left. The first run's reference is drawn. Throws StartupError.
void draw_runs(const std::string& title, const std::vector<NamedRun>& runs, const cv::Mat& picture,
               const std::filesystem::path& mark, const PanelLetters& letters,
               const std::filesystem::path& png);

/// Figure 8.3: source.png of each folder, and below them the marks.
void draw_pictures_and_marks(const std::vector<std::filesystem::path>& folders, std::string_view material,
                             const std::filesystem::path& png);

}  // namespace telekerf::experiments
