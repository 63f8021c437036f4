// SPDX-License-Identifier: Apache-2.0
// The two experiments of thesis 8.5, picture by picture, and the sharpness over both axes (figures 7.12
// to 7.14).
#pragma once

#include <cstdint>
#include <filesystem>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "slave/vision/imaging/focus_law.h"

namespace telekerf::experiments {

enum class FocusStory : std::uint8_t {
  kZoomIn,   ///< experiment 1: a defocused system whose magnification is increased
  kZoomOut,  ///< experiment 2: a focused system that is zoomed out while the algorithm runs
};

struct StoryFrame {
  double time_s = 0.0;
  double magnification_m = 0.0;  ///< of the axis, as measured
  double sharpness = 0.0;        ///< eq. 155
  double defocus_dof = 0.0;      ///< true
};

struct StoryRun {
  std::vector<StoryFrame> frames;
  std::vector<cv::Mat> strip;        ///< some of the pictures,
  std::vector<double> strip_time_s;  ///< and when they were taken
};

StoryRun run_story(FocusStory story, imaging::FocusLaw law, std::uint64_t seed);

/// Normalised variance over a raster of both axes.
struct SharpnessSurface {
  std::vector<double> magnification_m;
  std::vector<double> focus_m;
  std::vector<std::vector<double>> sharpness;  ///< [magnification][focus]
};
SharpnessSurface sharpness_surface(std::uint64_t seed, int magnifications, int focuses);

/// Writes figure-8.11.png, figure-8.12.png, figure-8.12-c.png, figure-7.12.png, figure-7.13.png,
/// figure-7.14.png.
void draw_focus_figures(std::uint64_t seed, const std::filesystem::path& folder);

}  // namespace telekerf::experiments
