// SPDX-License-Identifier: Apache-2.0
#include "slave/automatic/machinist.h"

#include <algorithm>

namespace telekerf::slave {

Machinist::Machinist(const robot::RobotModel& nominal, const Job& job, const geometry::NearestIndex& corridor,
                     bool closed, const MachinistSettings& settings) noexcept
    : job_(job),
      corridor_(corridor),
      settings_(settings),
      workspace_radius_m_(nominal.workspace.radius_m),
      follower_(nominal, drive_settings(settings.controller, closed, settings.follower),
                make_controller(settings.controller, closed, settings.follower),
                settings.follower.model_ahead),
      hold_({Reference{}}) {}

MachinistOutputs Machinist::step(const robot::JointReading& reading, bool stop) noexcept {
  MachinistOutputs out;
  const std::size_t last = job_.track.size() - 1;
  if (stop && !stopped_) {
    stopped_ = true;
    Reference rest;
    rest.position_m = job_.track[tick_].position_m;
    rest.tangent = job_.track[tick_].tangent;
    hold_.replace(0, rest);
  }
  const Reference& reference = stopped_ ? hold_[0] : job_.track[tick_];
  out.currents_a = stopped_ ? follower_.step(reading, hold_, 0.0)
                            : follower_.step(reading, job_.track, static_cast<double>(tick_));
  out.tool_m = follower_.tool_m();
  out.reference_m = reference.position_m;
  out.phase = job_.phases[tick_];
  out.interlock = judge({.stopped = stopped_,
                         .contour_known = true,
                         .engaged = out.phase == JobPhase::kCut,
                         .fresh = reading.valid,
                         .inside_workspace = out.tool_m.head<2>().norm() <= workspace_radius_m_,
                         .contour_distance_m = corridor_.find(out.tool_m.head<2>()).distance_m,
                         .speed_m_per_s = reference.speed_m_per_s,
                         .tracking_error_m = (out.tool_m - reference.position_m).norm()},
                        settings_.interlock);
  if (out.interlock == Interlock::kReady && reference.beam)
    out.laser_w = settings_.laser_w * follower_.beam_power(reference);
  out.progress = static_cast<double>(tick_) / static_cast<double>(std::max<std::size_t>(last, 1));
  out.done = tick_ == last;
  if (!stopped_ && tick_ < last) ++tick_;
  return out;
}

}  // namespace telekerf::slave
