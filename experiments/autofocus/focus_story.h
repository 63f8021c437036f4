// SPDX-License-Identifier: Apache-2.0
// The two experiments of thesis 8.5, picture by picture.
#pragma once

#include <cstdint>
#include <filesystem>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "experiments/autofocus/virtual_unit.h"
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
  bool passed_on = false;        ///< as in focus; the printed law cannot say so
};

struct StoryRun {
  std::vector<StoryFrame> frames;
  std::vector<cv::Mat> strip;        ///< some of the pictures,
  std::vector<double> strip_time_s;  ///< and when they were taken
};

StoryRun run_story(FocusStory story, imaging::FocusLaw law, std::uint64_t seed);

/// The unit of these experiments over a coin-like relief; its focus is so many depths of field off.
VirtualUnit story_unit(std::uint64_t seed, double magnification_m, double defocus_dof);

/// Writes figure-8.11.png, figure-8.12.png, figure-8.12-c.png.
void draw_stories(std::uint64_t seed, const std::filesystem::path& folder);

}  // namespace telekerf::experiments
