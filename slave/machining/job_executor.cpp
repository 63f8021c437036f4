// SPDX-License-Identifier: Apache-2.0
#include "slave/machining/job_executor.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace telekerf::machining {
namespace {

constexpr double kMaxPower =
    1.25 * 1.5;  ///< of laser_w: beside a corner (EvenBurn), times faster than planned

laser::InterlockSettings limits_of(const robot::RobotModel& model,
                                   const JobExecutorSettings& settings) noexcept {
  laser::InterlockSettings limits = settings.interlock;
  limits.workspace_radius_m = model.workspace.radius_m;
  limits.max_speed_m_per_s = model.limits.velocity_m_per_s;
  limits.max_power_w = kMaxPower * settings.laser_w;
  return limits;
}

}  // namespace

JobExecutor::JobExecutor(const robot::RobotModel& nominal, const Job& job,
                         const JobExecutorSettings& settings)
    : job_(job),
      corridors_(job.lines.begin(), job.lines.end()),
      controllers_{make_controller(settings.controller, false, settings.follower),
                   make_controller(settings.controller, true, settings.follower)},
      settings_(settings),
      period_ns_(std::llround(1e9 / settings.follower.control_hz)),
      interlock_(limits_of(nominal, settings), period_ns_),
      unknown_m_(0.5 * nominal.limits.acceleration_m_per_s2 * settings.interlock.reaction_s *
                 settings.interlock.reaction_s),
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
  const Vec2 place = out.tool_m.head<2>();
  const double reaction_s = settings_.interlock.reaction_s;
  const auto distance_m = [&](const Vec2& at) noexcept { return corridors_[contour_].find(at).distance_m; };
  const double predicted_m =
      distance_m(place + reaction_s * out.tool_velocity_m_per_s.head<2>()) + unknown_m_;
  const double power_w = reference.beam ? settings_.laser_w * follower_.beam_power(reference) : 0.0;
  out.time_ns = ++steps_ * period_ns_;
  auto [judgement, permit] = interlock_.decide(
      out.time_ns, {.stopped = stopped_,
                    .fault = false,
                    .contour_known = true,
                    .engaged = out.phase == JobPhase::kCut,
                    .armed = true,
                    .button_armed = true,
                    .fresh = reading.valid,
                    .unlit = true,
                    .on_time = true,
                    .emission_agrees = true,
                    .monitor_agrees = true,
                    .command_age_s = 0.0,
                    .radius_m = place.norm(),
                    .height_m = std::abs(out.tool_m.z()),
                    .contour_distance_m = distance_m(place),
                    .arc_gap_m = 0.0,
                    .predicted_distance_m = predicted_m,
                    .speed_m_per_s = std::max(out.tool_velocity_m_per_s.norm(), reference.speed_m_per_s),
                    .cut_speed_m_per_s = out.tool_velocity_m_per_s.norm(),
                    .tracking_error_m = (out.tool_m - reference.position_m).norm(),
                    .offset_m = 0.0,
                    .power_w = power_w,
                    .dose_j = 0.0,
                    .area_dose_j_per_mm2 = 0.0});
  out.interlock = judgement.reason();
  out.permit = std::move(permit);
  if (judgement.permits()) out.laser_w = power_w;
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
