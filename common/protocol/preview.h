// SPDX-License-Identifier: Apache-2.0
// What the camera shows, small enough to be looked at from afar.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace telekerf {

inline constexpr std::size_t kMaxPreviewBytes = 262'144;

/// A picture and where it lies on the workpiece, in the frame of a contour: y upwards, metres.
struct PreviewMessage {
  std::uint32_t contour_id = 0;  ///< 0: none has been found in it
  double left_m = 0.0;
  double top_m = 0.0;
  double width_m = 0.0;
  double height_m = 0.0;
  std::vector<std::uint8_t> jpeg;
};

}  // namespace telekerf
