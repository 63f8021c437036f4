// SPDX-License-Identifier: Apache-2.0
#include "slave/slave_node.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace telekerf::slave {
namespace {

static_assert(laser::guard_bit("button") == kButtonGuard);

constexpr double kSettled_m = 2e-6;

std::int64_t period_ns(const SlaveSettings& settings) noexcept {
  return std::llround(1e9 / settings.control_hz);
}

laser::InterlockSettings limits_of(const robot::RobotModel& model, const SlaveSettings& settings) noexcept {
  laser::InterlockSettings limits = settings.interlock;
  limits.workspace_radius_m = model.workspace.radius_m;
  limits.max_speed_m_per_s = model.limits.velocity_m_per_s;
  limits.min_cut_speed_m_per_s = settings.beam_power.floor_m_per_s;
  limits.max_power_w = laser::BeamPowerSettings::kMost * settings.laser_w;
  return limits;
}

control::JointAccelerationSettings joints_of(const robot::RobotModel& model,
                                             const control::LoopBandwidths& bandwidths,
                                             const SlaveSettings& settings) {
  control::JointAccelerationSettings joints = control::joints_of(model, bandwidths, settings.control_hz);
  joints.judged = !settings.touched;
  return joints;
}

}  // namespace

SlaveNode::SlaveNode(const robot::RobotModel& model, const SlaveSettings& settings, std::uint32_t epoch)
    : model_(model),
      settings_(settings),
      bandwidths_(control::design_loop(control::loop_conditions(model, settings.control_hz),
                                       settings.bandwidth_rad_s, settings.observer_rad_s)),
      law_(control::sampled_gains(bandwidths_.law_rad_per_s, 1.0, 1.0 / settings.control_hz)),
      joints_(model, joints_of(model, bandwidths_, settings)),
      standstill_(model.sensor, 1.0 / settings.control_hz),
      dt_s_(1.0 / settings.control_hz),
      commands_({.playout = settings.playout,
                 .timeout_s = settings.command_timeout_s,
                 .max_acceleration_m_per_s2 = model.limits.acceleration_m_per_s2,
                 .control_period_ns = period_ns(settings),
                 .beam_age_s = settings.interlock.beam_age_s}),
      selector_(model, settings.transfer, dt_s_, settings.bare_accelerations,
                {.beam_age_s = settings.interlock.beam_age_s, .follow_age_s = settings.follow_age_s}),
      interlock_(limits_of(model, settings), period_ns(settings)),
      cut_speed_(dt_s_),
      dose_(model.workspace.radius_m),
      punctuality_(period_ns(settings)),
      report_({.positions = settings.feedback,
               .forces = settings.force,
               .ticks_per_sample = static_cast<int>(std::lround(settings.control_hz / settings.stream_hz)),
               .control_period_ns = period_ns(settings)},
              epoch) {}

KinematicState SlaveNode::observe(const robot::JointReading& joints) noexcept {
  if (!located_ && joints.valid) joints_.reset(joints.joints_m);
  if (!joints_.observe(joints)) return selector_.reference();
  const robot::DeltaState& pose = joints_.state();
  KinematicState tool{.position_m = model_.in_workpiece(pose.tool_m),
                      .velocity_m_per_s = pose.tool_velocity_m_per_s};
  if (!located_ && joints.valid) {
    selector_.rest_at(tool.position_m);
    located_ = true;
  }
  return tool;
}

Vec3 SlaveNode::track(const Selected& selected, const KinematicState& tool,
                      const robot::JointReading& read) noexcept {
  // A pose without kinematics (it cannot be reached by following): the joints are braked where they are.
  if (!joints_.posed()) return joints_.braking_m_per_s2(bandwidths_.law_rad_per_s);
  const Vec3 wanted = selected.bare ? selected.acceleration_m_per_s2
                                    : control::tracking_acceleration(selected.reference, tool, law_);
  const Vec3 asked =
      joints_.state().joint_acceleration(control::limited(wanted, model_.limits.acceleration_m_per_s2));
  const Vec3 error_m = joints_.state().inverse_jacobian * (selected.reference.position_m - tool.position_m);
  return selected.bare ? asked : standstill_.step(selected.reference, error_m, read, asked);
}

laser::InterlockInputs SlaveNode::judged(const SlaveInputs& inputs, const Selected& selected,
                                         const KinematicState& tool, bool on_time) noexcept {
  const Corridor* corridor = inputs.corridor;
  const laser::InterlockSettings& limits = interlock_.settings();
  const Vec2 place = tool.position_m.head<2>();
  const Vec3& led_m_per_s = selected.reference.velocity_m_per_s;
  const bool known =
      corridor != nullptr && commands_.heard() && commands_.header().contour_id == corridor->contour_id;
  const bool dark =
      !known || !selected.following || !selected.button || selector_.offset_m() > limits.max_offset_m;
  laser::ContourPlace::Place on_contour{laser::kAbsent, laser::kAbsent};
  double predicted_m = laser::kAbsent;
  if (corridor != nullptr) {
    on_contour = contour_place_.step(corridor->contour, selected.source_m.head<2>(), place, dark);
    predicted_m = contour_place_.predicted_distance_m(
        corridor->contour, on_contour, place, tool.velocity_m_per_s.head<2>(), led_m_per_s.head<2>(),
        model_.limits.acceleration_m_per_s2, limits.reaction_s, limits.corridor_m - limits.measurement_m);
  }
  const double cut_speed = cut_speed_.step(tool.velocity_m_per_s);
  const double power_w = settings_.laser_w * laser::power_fraction(settings_.beam_power, cut_speed);
  const laser::DoseBook::Dose dose = dose_.at(place);
  // As long as a permit lasts.
  const double more_j = dose.kept ? 2.0 * dt_s_ * power_w : laser::kAbsent;
  return {.stopped = stop_ != 0,
          .fault = inputs.fault,
          .contour_known = known,
          .engaged = selector_.mode() == SlaveMode::kFollowing,
          .armed = selector_.arming().armed(),
          .button_armed = selector_.arming().button_armed(),
          .fresh = selected.following && joints_.posed() && joints_.measured() && led_m_per_s.allFinite(),
          .unlit = unlit(selected),
          .on_time = on_time,
          .emission_agrees = inputs.emission_agrees,
          .monitor_agrees = inputs.monitor_agrees,
          .command_age_s = selected.due_age_s >= 0.0 ? selected.due_age_s : laser::kAbsent,
          .look_age_s = inputs.look_age_s,
          .radius_m = place.norm(),
          .height_m = std::abs(tool.position_m.z()),
          .contour_distance_m = on_contour.distance_m,
          .arc_gap_m = on_contour.arc_gap_m,
          .predicted_distance_m = predicted_m,
          .speed_m_per_s = std::max(tool.velocity_m_per_s.norm(), led_m_per_s.norm()),
          // A resting tool's noise is no speed: it must be led, too.
          .cut_speed_m_per_s = std::min(cut_speed, led_m_per_s.head<2>().norm()),
          .tracking_error_m = (tool.position_m - selected.source_m).norm(),
          .offset_m = selector_.offset_m(),
          .power_w = power_w,
          .dose_j = dose.place_j + more_j,
          .area_dose_j_per_mm2 = dose.area_j_per_mm2 + more_j};
}

bool SlaveNode::unlit(const Selected& selected) const noexcept {
  return selected.applied_tick < 0.0 || commands_.header().epoch != lit_sample_.master_epoch ||
         selected.applied_tick > lit_sample_.tick;
}

void SlaveNode::book(std::int64_t now_ns) noexcept {
  // A beam that nobody has told anything any more ends with its permit.
  const std::int64_t lasted_ns = std::clamp(now_ns - lit_.time_ns, std::int64_t{0}, 2 * period_ns(settings_));
  dose_.add(lit_.place_m, lit_.power_w * static_cast<double>(lasted_ns) * 1e-9);
}

SlaveOutputs SlaveNode::step(std::int64_t now_ns, const SlaveInputs& inputs) noexcept {
  SlaveOutputs out;
  const KinematicState tool = observe(inputs.joints);
  std::optional<std::uint32_t> contour_id;
  if (inputs.corridor != nullptr) contour_id = inputs.corridor->contour_id;
  const double silent_s = commands_.heard() ? commands_.silent_s(now_ns) : 0.0;
  for (const auto& command : inputs.commands) commands_.receive(command, contour_id, now_ns);
  const bool heard = commands_.heard();
  const std::uint32_t stop = inputs.stop.in_force(heard ? commands_.header().stop : 0);
  if (stop != stop_) stop_tick_ = tick_;
  stop_ = stop;
  const Selected selected =
      selector_.step(commands_.play(now_ns, tool), {.stopped = stop_ != 0,
                                                    .heard = heard,
                                                    .master_epoch = heard ? commands_.header().epoch : 0,
                                                    .contour_id = contour_id.value_or(0),
                                                    .newest_engage = heard ? commands_.header().engage : 0,
                                                    .silent_s = silent_s});

  if (joints_.posed()) out.force_n = joints_.reaction_force_n();
  out.currents_a = joints_.currents(track(selected, tool, inputs.joints));

  book(now_ns);
  const laser::InterlockInputs now = judged(inputs, selected, tool, punctuality_.step(now_ns));
  auto [judgement, permit] = interlock_.decide(now_ns, now);
  out.interlock = judgement.reason();
  out.forbidden = judgement.forbidden;
  out.permit = std::move(permit);
  out.laser_w = judgement.permits() && selected.button ? now.power_w : 0.0;
  lit_ = {now_ns, tool.position_m.head<2>(), out.laser_w};
  if (out.laser_w > 0.0) lit_sample_ = {commands_.header().epoch, selected.applied_tick};
  out.mode = selector_.mode();
  out.reason = selector_.reason();
  out.stop = stop_;
  out.command_age_s = selected.age_s;
  out.button = selected.button;
  out.settled = selected.following && selector_.offset_m() < kSettled_m;
  out.applied_tick = selected.applied_tick;
  out.reference = selected.reference;
  out.tool_m = tool.position_m;
  out.state = report_.step(now_ns, tick_++,
                           {.tool_m = tool.position_m,
                            .velocity_m_per_s = tool.velocity_m_per_s,
                            .force_n = out.force_n,
                            .laser_on = out.laser_w > 0.0,
                            .interlock = out.interlock,
                            .contour_id = contour_id.value_or(0),
                            .mode = out.mode,
                            .reason = out.reason,
                            .engage_spent = selector_.arming().spent(),
                            .stop = stop_,
                            .stop_tick = stop_tick_,
                            .guards = out.forbidden | (settings_.real_laser ? kRealLaser : 0U),
                            .command_age_s = selected.due_age_s},
                           commands_, selected.acknowledgement);
  if (out.state) commands_.state_sent(out.state->sequence, out.state->sent_ns);
  return out;
}

}  // namespace telekerf::slave
