// SPDX-License-Identifier: Apache-2.0
// Rational B-splines of vector files -> chords.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/vision/vector/curve_writer.h"

namespace telekerf::vision {

/// A piecewise polynomial of `degree` 1 to 10 over the knots, one more than degree and control points
/// together.
struct Spline {
  int degree = 3;
  std::vector<double> knots;  ///< never falling
  std::vector<Vec2> control;
  std::vector<double> weights;  ///< of the control points, positive; none: all alike
};

/// What is wrong with it, one sentence.
std::optional<std::string> complaint_of(const Spline& spline);

/// Draws the whole of a spline that is without complaint, within the writer's chord error; the writer moves
/// to its start if it has no point yet.
void draw(const Spline& spline, CurveWriter& writer);

}  // namespace telekerf::vision
