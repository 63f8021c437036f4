// SPDX-License-Identifier: Apache-2.0
// The vectors that everything else is written in; units and frames stand in the names of what they hold.
#pragma once

#include <Eigen/Core>

namespace telekerf {

using Vec2 = Eigen::Vector2d;
using Vec3 = Eigen::Vector3d;

}  // namespace telekerf
