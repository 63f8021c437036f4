// SPDX-License-Identifier: Apache-2.0
#include "slave/machining/tuning.h"

#include <algorithm>
#include <cmath>

#include "common/control/loop_design.h"
#include "common/robot/sensor_noise.h"

namespace telekerf::machining {
namespace {

constexpr double kAcross_rad_per_s = 240.0;
/// Below, weight and friction come too late; above, nothing is gained any more that noise does not take
/// across the path.
constexpr control::ObserverBounds kObserver{60.0, 500.0};

/// What a joint's shaking makes of the tool's along a path in the plane, on average over its directions;
/// joints shake independently of each other.
double tool_per_joint(const robot::RobotModel& model) {
  const robot::DeltaKinematics kinematics(model.geometry);
  const auto joints = kinematics.inverse(model.in_base(Vec3::Zero()));
  if (!joints) return 1.0;
  const auto pose = kinematics.state(*joints, Vec3::Zero());
  return pose ? pose->jacobian.topRows<2>().norm() / std::sqrt(2.0) : 1.0;
}

}  // namespace

PathFollowerSettings tuned_for_speed(PathFollowerSettings settings, const robot::RobotModel& model,
                                     double speed_m_per_s, double ripple) {
  const double period_s = 1.0 / settings.control_hz;
  const control::LoopConditions conditions{.period_s = period_s,
                                           .delay_s = settings.loop_delay * period_s,
                                           .noise_m = robot::reading_noise_m(model.sensor)};
  settings.along_rad_s = std::clamp(20.0 + 17.5e3 * speed_m_per_s, 50.0, 70.0);
  settings.across_rad_s = std::min(kAcross_rad_per_s, control::design_loop(conditions).law_rad_per_s);
  const control::LoopBandwidths loop = control::design_even_loop(
      conditions, settings.along_rad_s, ripple * speed_m_per_s / tool_per_joint(model), kObserver);
  settings.observer_rad_s = loop.observer_rad_per_s;
  settings.velocity_rad_s = loop.velocity_rad_per_s;
  return settings;
}

}  // namespace telekerf::machining
