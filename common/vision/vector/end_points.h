// SPDX-License-Identifier: Apache-2.0
// The ends of lines, those that are near each other taken as one point.
#pragma once

#include <cstddef>
#include <vector>

#include "common/runtime/vectors.h"

namespace telekerf::vision {

struct EndPoints {
  std::vector<std::size_t> node_of;  ///< one an end that was given
  std::vector<Vec2> at;              ///< of each node: the middle of its ends
};

/// `ends`: first and last point of line after line. Those within `tolerance` of each other, directly or
/// through others, are one node, the nearest first; but the two ends of a line of `lengths` up to twice the
/// tolerance never are, unless they are the same point: a curve drawn as very short lines stays a curve. A
/// node is at most twice the tolerance wide.
EndPoints merged(const std::vector<Vec2>& ends, const std::vector<double>& lengths, double tolerance);

}  // namespace telekerf::vision
