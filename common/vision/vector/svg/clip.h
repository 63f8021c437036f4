// SPDX-License-Identifier: Apache-2.0
// What of a line can be seen through a hole.
#pragma once

#include <vector>

#include "common/geometry/polyline.h"

namespace telekerf::vision {

enum class Clipped {
  kInside,   ///< all of it
  kOutside,  ///< nothing of it, nor of the area within it
  kCut,      ///< a part
};

/// `hole`: closed lines, what lies in any of them is seen. The border itself counts as inside.
Clipped clipped(const geometry::Polyline& line, const std::vector<geometry::Polyline>& hole);

}  // namespace telekerf::vision
