// SPDX-License-Identifier: Apache-2.0
#include "master/operator/operator_disturbance.h"

#include <cmath>
#include <numbers>

namespace telekerf::master {

Vec3 disturbed(std::span<const OperatorDisturbance> disturbances, double since_s, const Vec2& tangent,
               const Vec3& work_n) noexcept {
  Vec3 force = work_n;
  for (const OperatorDisturbance& now : disturbances) {
    const double u = (since_s - now.at_s) / now.for_s;
    if (!(u >= 0.0 && u < 1.0)) continue;
    Vec3 own;
    own.head<2>() = now.force_n * Vec2(-tangent.y(), tangent.x()) + now.along_n * tangent;
    own.z() = now.upwards_n;
    switch (now.kind) {
      case OperatorDisturbance::Kind::kPush:
        force += std::sin(std::numbers::pi * u) * own;
        break;
      case OperatorDisturbance::Kind::kSlip:
        force += (1.0 - u) * own;
        break;
      case OperatorDisturbance::Kind::kLetGo:
        force.setZero();
        break;
      case OperatorDisturbance::Kind::kFight:
        force = own;
        break;
    }
  }
  return force;
}

}  // namespace telekerf::master
