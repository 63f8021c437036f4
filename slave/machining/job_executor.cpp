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
      max_m_per_s2_(nominal.limits.acceleration_m_per_s2),
      dose_(nominal.workspace.radius_m),
      dt_s_(1.0 / settings.follower.control_hz),
      follower_(nominal, joint_settings(settings.controller, settings.follower), controllers_[0],
                model_use(settings.controller, settings.follower)),
      hold_({Reference{}}) {
  turn_to(0);
}

void JobExecutor::turn_to(std::size_t contour) noexcept {
  contour_ = contour;
  follower_.use(controllers_[job_.plans[contour].path.closed() ? 1 : 0]);
}

laser::InterlockInputs JobExecutor::judged(const JobExecutorOutputs& now, const Reference& reference,
                                           bool valid, const DeviceState& devices) noexcept {
  const laser::InterlockSettings& limits = interlock_.settings();
  const Vec2 place = now.tool_m.head<2>();
  const Vec2 velocity = now.tool_velocity_m_per_s.head<2>();
  const Vec2 planned = (stopped_ ? Vec3(Vec3::Zero()) : reference.velocity_m_per_s).head<2>();
  const geometry::NearestIndex& contour = corridors_[contour_];
  const laser::ContourPlace::Place on_contour =
      contour_place_.step(contour, reference.position_m.head<2>(), place, lit_.power_w <= 0.0);
  const double power_w = reference.beam ? settings_.laser_w * follower_.beam_power(reference) : 0.0;
  const laser::DoseBook::Dose dose = dose_.at(place);
  // As long as a permit lasts.
  const double more_j = dose.kept ? 2.0 * dt_s_ * power_w : laser::kAbsent;
  return {.stopped = stopped_,
          .fault = devices.fault,
          .contour_known = true,
          .engaged = now.phase == JobPhase::kCut,
          // Whoever starts the program asks for the work, once; no job goes on after a stop or a fault.
          .armed = true,
          .button_armed = true,
          .fresh = valid,
          .unlit = !lit_tick_ || tick_ > *lit_tick_,
          .on_time = devices.on_time,
          .emission_agrees = devices.emission_agrees,
          .monitor_agrees = devices.monitor_agrees,
          .command_age_s = 0.0,  // the plan is its own
          .radius_m = place.norm(),
          .height_m = std::abs(now.tool_m.z()),
          .contour_distance_m = on_contour.distance_m,
          .arc_gap_m = on_contour.arc_gap_m,
          .predicted_distance_m = contour_place_.predicted_distance_m(
              contour, on_contour, place, velocity, planned, max_m_per_s2_, limits.reaction_s,
              limits.corridor_m - limits.measurement_m),
          .speed_m_per_s = std::max(now.tool_velocity_m_per_s.norm(), reference.speed_m_per_s),
          .cut_speed_m_per_s = now.tool_velocity_m_per_s.norm(),
          .tracking_error_m = (now.tool_m - reference.position_m).norm(),
          .offset_m = 0.0,  // its reference never changes its source
          .power_w = power_w,
          .dose_j = dose.place_j + more_j,
          .area_dose_j_per_mm2 = dose.area_j_per_mm2 + more_j};
}

JobExecutorOutputs JobExecutor::step(const robot::JointReading& reading, bool stop,
                                     const DeviceState& devices) noexcept {
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
  dose_.add(lit_.place_m, lit_.power_w * dt_s_);
  out.time_ns = ++steps_ * period_ns_;
  const laser::InterlockInputs now = judged(out, reference, reading.valid, devices);
  auto [judgement, permit] = interlock_.decide(out.time_ns, now);
  out.interlock = judgement.reason();
  out.permit = std::move(permit);
  out.forbidden = judgement.forbidden;
  if (judgement.permits()) out.laser_w = now.power_w;
  lit_ = {out.tool_m.head<2>(), out.laser_w};
  if (out.laser_w > 0.0) lit_tick_ = tick_;
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
