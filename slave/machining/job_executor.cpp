// SPDX-License-Identifier: Apache-2.0
#include "slave/machining/job_executor.h"

#include <algorithm>

namespace telekerf::machining {

JobExecutor::JobExecutor(const robot::RobotModel& nominal, const Job& job,
                         const JobExecutorSettings& settings)
    : job_(job),
      corridors_(job.lines.begin(), job.lines.end()),
      controllers_{make_controller(settings.controller, false, settings.follower),
                   make_controller(settings.controller, true, settings.follower)},
      settings_(settings),
      workspace_radius_m_(nominal.workspace.radius_m),
      follower_(nominal, joint_settings(settings.controller, settings.follower), controllers_[0],
                model_use(settings.controller, settings.follower)),
      hold_({Reference{}}) {
  turn_to(0);
}

void JobExecutor::turn_to(std::size_t contour) noexcept {
  contour_ = contour;
  follower_.use(controllers_[job_.plans[contour].path.closed() ? 1 : 0]);
}

JobExecutorOutputs JobExecutor::step(const robot::JointReading& reading, bool stop) noexcept {
  JobExecutorOutputs out;
  const std::size_t last = job_.trajectory.size() - 1;
  if (stop && !stopped_) {
    stopped_ = true;
    Reference rest;
    rest.position_m = job_.trajectory[tick_].position_m;
    rest.tangent = job_.trajectory[tick_].tangent;
    hold_.replace(0, rest);
  }
  const Reference& reference = stopped_ ? hold_[0] : job_.trajectory[tick_];
  out.currents_a = stopped_ ? follower_.step(reading, hold_, 0.0)
                            : follower_.step(reading, job_.trajectory, static_cast<double>(tick_));
  out.saturated = follower_.joints().saturated();
  out.tool_m = follower_.tool_m();
  out.tool_velocity_m_per_s = follower_.joints().state().tool_velocity_m_per_s;
  out.reference_m = reference.position_m;
  out.tick = tick_;
  out.phase = job_.phases[tick_];
  out.interlock = laser::evaluate_interlock(
      {.stopped = stopped_,
       .contour_known = true,
       .engaged = out.phase == JobPhase::kCut,
       .fresh = reading.valid,
       .inside_workspace = out.tool_m.head<2>().norm() <= workspace_radius_m_,
       .contour_distance_m = corridors_[contour_].find(out.tool_m.head<2>()).distance_m,
       .speed_m_per_s = reference.speed_m_per_s,
       .tracking_error_m = (out.tool_m - reference.position_m).norm()},
      settings_.interlock);
  if (out.interlock == Interlock::kReady && reference.beam)
    out.laser_w = settings_.laser_w * follower_.beam_power(reference);
  out.pilot = out.phase == JobPhase::kFraming && reading.valid && !stopped_;
  out.progress = static_cast<double>(tick_) / static_cast<double>(std::max<std::size_t>(last, 1));
  out.done = tick_ == last;
  if (!stopped_ && tick_ < last) {
    ++tick_;
    // Contours are apart by a travel, which ends at rest.
    const bool cut_ends = out.phase == JobPhase::kCut && job_.phases[tick_] != JobPhase::kCut;
    if (cut_ends && contour_ + 1 < job_.plans.size()) turn_to(contour_ + 1);
  }
  return out;
}

}  // namespace telekerf::machining
