// SPDX-License-Identifier: Apache-2.0
// The settings of every program that looks at pictures, declared once.
#pragma once

#include <optional>
#include <vector>

#include "common/runtime/settings.h"
#include "common/vision/load.h"

namespace telekerf::vision {

struct PictureFlags {
  std::vector<double> at;    ///< x, y, x, y, ...: pixels
  std::vector<double> away;  ///< likewise
  std::vector<double> box;   ///< x, y, width, height
  std::optional<double> smallest_mm;
  std::optional<double> level;  ///< see ExtractionSettings
  Paper paper = Paper::kNone;

  void add_parameters(Settings& settings);
  /// Throws StartupError: half a point, or --not without anything that is pointed at.
  void apply_to(LoadRequest& request) const;
};

}  // namespace telekerf::vision
