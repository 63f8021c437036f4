// SPDX-License-Identifier: Apache-2.0
// What somebody who sees the picture says of what is meant in it, while vision runs.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <tl/expected.hpp>
#include <vector>

#include "slave/vision/contour_source.h"

namespace telekerf::vision_process {

/// The picture as it was seen last: places on the workpiece <-> pixels of the file or the camera's frame.
struct Sight {
  vision::Scale scale;
  double reduction = 1.0;  ///< pixels of the file for one of the picture that was looked at
  bool pixels = false;     ///< a drawing has none
};

/// One of (docs/reference/contours.md)
///   at X,Y     the thing there: one of the contours that were found, or else what GrabCut makes of it
///   start X,Y  where the contour begins        end X,Y  and where it ends
///   mode WORD  from pixels to points, the words of --mode
///   level SHARE  where borders lie on the way from background to drawing, as --level; "level" alone: found
///   by itself anew       as the program was started
/// with X and Y in metres on the workpiece. `now` is what was asked for the last time, `shown` the contours
/// of then. The error is one sentence: no such word, or not of this picture.
tl::expected<ContourRequest, std::string> looked_at(std::string_view words, const ContourRequest& started,
                                                    ContourRequest now, const ContourMessage& shown,
                                                    const Sight& sight);

/// "X,Y X,Y ...": places, metres; none of what is none.
std::optional<std::vector<Vec2>> places_in(std::string_view words);

}  // namespace telekerf::vision_process
