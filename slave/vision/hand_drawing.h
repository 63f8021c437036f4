// SPDX-License-Identifier: Apache-2.0
// A contour that somebody draws over the picture (thesis 3.1.1: "in case of highly complicated image").
#pragma once

#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "common/protocol/messages.h"

namespace telekerf::vision_process {

/// Collects the places that a pen passed, and makes of them a line that a machine can follow.
class HandDrawing {
 public:
  static constexpr std::size_t kMostPlaces = 20'000;
  static constexpr double kShortest_m = 1e-3;  ///< a slip of the pen is no contour
  static constexpr double kSpacing_m = 5e-5;   ///< of the points that come of it
  /// A hand trembles at some 8 Hz while it draws some 10 to 30 mm a second: less than this is not meant.
  static constexpr double kTremor_m = 4e-4;

  void forget() { places_m_.clear(); }
  /// Metres on the workpiece. False: these are too many.
  bool add(const std::vector<Vec2>& places_m);
  /// The contour, smooth but for its bends; `closed`: back to where it began. Its id is its digest. The error
  /// is one sentence: too short, or it leaves the workspace.
  tl::expected<ContourMessage, std::string> contour(bool closed, double workspace_radius_m) const;

 private:
  std::vector<Vec2> places_m_;
};

}  // namespace telekerf::vision_process
