// SPDX-License-Identifier: Apache-2.0
#include "common/control/loop_design.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/robot/dynamics.h"
#include "common/robot/sensor_noise.h"
#include "common/runtime/startup_error.h"

namespace telekerf::control {
namespace {

/// Of the acceleration by the motors' peak force, what the sensor's noise may ask for.
constexpr double kNoiseShare = 0.03;

bool good(const LoopConditions& conditions, const LoopBandwidths& bandwidths) {
  const LoopMargins nominal = loop_margins(conditions, bandwidths);
  if (!nominal.stable || nominal.max_sensitivity > kMaxSensitivity ||
      nominal.noise_m_per_s2 > conditions.max_noise_m_per_s2) {
    return false;
  }
  const LoopMargins worst = loop_margins(conditions, bandwidths, kWorstInertiaRatio);
  return worst.stable && worst.max_sensitivity <= kMaxSensitivityWorst;
}

}  // namespace

LoopBandwidths design_loop(const LoopConditions& conditions, double law_rad_per_s,
                           double observer_rad_per_s) {
  const auto with = [&](double law) {
    const double observer = observer_rad_per_s > 0.0 ? observer_rad_per_s : kObserverOverLaw * law;
    return LoopBandwidths{law, observer, kVelocityOverObserver * observer};
  };
  if (law_rad_per_s > 0.0) return with(law_rad_per_s);
  // Slower is always safer; what even the slowest loop does not bear is left to the user.
  double slow = 0.01 / conditions.period_s;
  double fast = 1.0 / conditions.period_s;
  for (int i = 0; i < 10; ++i) {
    const double middle = std::sqrt(slow * fast);
    (good(conditions, with(middle)) ? slow : fast) = middle;
  }
  return with(slow);
}

LoopBandwidths design_even_loop(const LoopConditions& conditions, double law_rad_per_s,
                                double max_noise_m_per_s, const ObserverBounds& bounds) {
  const auto with = [&](double observer) {
    return LoopBandwidths{law_rad_per_s, observer, kEvenVelocityOverObserver * observer};
  };
  const auto even = [&](double observer) {
    return good(conditions, with(observer)) &&
           loop_margins(conditions, with(observer)).noise_m_per_s <= max_noise_m_per_s;
  };
  double slow = bounds.min_rad_per_s, fast = bounds.max_rad_per_s;
  if (even(fast)) return with(fast);
  for (int i = 0; i < 10; ++i) {
    const double middle = std::sqrt(slow * fast);
    (even(middle) ? slow : fast) = middle;
  }
  return with(slow);
}

LoopConditions loop_conditions(const robot::RobotModel& model, double control_hz) {
  LoopConditions out{.period_s = 1.0 / control_hz, .delay_s = model.drive_delay_s};
  out.noise_m = robot::reading_noise_m(model.sensor);
  const robot::DeltaKinematics kinematics(model.geometry);
  const auto joints = kinematics.inverse(model.in_base(Vec3::Zero()));
  if (!joints) return out;
  const auto pose = kinematics.state(*joints, Vec3::Zero());
  if (!pose) return out;
  const double inertia_kg = robot::joint_inertia(model, *pose).diagonal().maxCoeff();
  out.max_noise_m_per_s2 = kNoiseShare * model.motor.peak_force_n / inertia_kg;
  return out;
}

void require_short_delay(const LoopConditions& conditions, const char* rate) {
  if (conditions.delay_s <= (kMaxLoopDelay + 1e-9) * conditions.period_s) return;
  throw configuration_error(fmt::format(
      "drive_delay_s = {:g} of the robot is more than {} control periods at {} = {:g}; lower the rate",
      conditions.delay_s, kMaxLoopDelay, rate, 1.0 / conditions.period_s));
}

void require_stable(const LoopConditions& conditions, const LoopBandwidths& bandwidths, const char* law,
                    const char* observer) {
  require_short_delay(conditions);
  // With the file's own inertia the predicted loop is stable at any speed; no robot is quite its file.
  if (loop_margins(conditions, bandwidths, kWorstInertiaRatio).stable) return;
  throw configuration_error(
      fmt::format("{} = {:g} and {} = {:g} make a loop that is not stable at control_hz = {:g} with a drive "
                  "delay of {:g} ms on a robot that is 30 % off its file; leave both 0 and they are chosen",
                  law, bandwidths.law_rad_per_s, observer, bandwidths.observer_rad_per_s,
                  1.0 / conditions.period_s, conditions.delay_s * 1e3));
}

JointAccelerationSettings joints_of(const robot::RobotModel& model, const LoopBandwidths& bandwidths,
                                    double control_hz) {
  return {.observer = {.period_s = 1.0 / control_hz,
                       .bandwidth_rad_per_s = bandwidths.observer_rad_per_s,
                       .velocity_bandwidth_rad_per_s = bandwidths.velocity_rad_per_s,
                       .loop_delay = model.drive_delay_s * control_hz},
          .present = true};
}

AbruptForce letting_go(const LoopConditions& conditions) {
  const double peak_m_per_s2 = conditions.max_noise_m_per_s2 / kNoiseShare;
  const double sample_m = 0.5 * peak_m_per_s2 * conditions.period_s * conditions.period_s;
  return {.min_m = std::max(0.2 * sample_m, 12.0 * conditions.noise_m), .max_m = 2.0 * 4.0 * sample_m};
}

}  // namespace telekerf::control
