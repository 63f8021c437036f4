// SPDX-License-Identifier: Apache-2.0
#include "slave/slave_node.h"

#include <cmath>
#include <utility>

namespace telekerf::slave {
namespace {

constexpr double kSettled_m = 2e-6;

std::int64_t period_ns(const SlaveSettings& settings) noexcept {
  return std::llround(1e9 / settings.control_hz);
}

laser::InterlockSettings limits_of(const robot::RobotModel& model, const SlaveSettings& settings) noexcept {
  laser::InterlockSettings limits = settings.interlock;
  limits.workspace_radius_m = model.workspace.radius_m;
  limits.max_speed_m_per_s = model.limits.velocity_m_per_s;
  limits.max_power_w = settings.laser_w;
  return limits;
}

}  // namespace

SlaveNode::SlaveNode(const robot::RobotModel& model, const SlaveSettings& settings, std::uint32_t epoch)
    : model_(model),
      settings_(settings),
      bandwidths_(control::design_loop(control::loop_conditions(model, settings.control_hz),
                                       settings.bandwidth_rad_s, settings.observer_rad_s)),
      law_(control::sampled_gains(bandwidths_.law_rad_per_s, 1.0, 1.0 / settings.control_hz)),
      joints_(model, control::joints_of(model, bandwidths_, settings.control_hz)),
      dt_s_(1.0 / settings.control_hz),
      commands_({.playout = settings.playout,
                 .timeout_s = settings.command_timeout_s,
                 .max_acceleration_m_per_s2 = model.limits.acceleration_m_per_s2,
                 .control_period_ns = period_ns(settings)}),
      selector_(model, settings.transfer, dt_s_, settings.bare_accelerations),
      interlock_(limits_of(model, settings), period_ns(settings)),
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

Vec3 SlaveNode::track(const Selected& selected, const KinematicState& tool) const noexcept {
  // A pose without kinematics (it cannot be reached by following): the joints are braked where they are.
  if (!joints_.posed()) return joints_.braking_m_per_s2(bandwidths_.law_rad_per_s);
  const Vec3 wanted = selected.bare ? selected.acceleration_m_per_s2
                                    : control::tracking_acceleration(selected.reference, tool, law_);
  return joints_.state().joint_acceleration(control::limited(wanted, model_.limits.acceleration_m_per_s2));
}

laser::InterlockInputs SlaveNode::judged(const SlaveInputs& inputs, const Selected& selected,
                                         const KinematicState& tool) const noexcept {
  const Corridor* corridor = inputs.corridor;
  const Vec2 place = tool.position_m.head<2>();
  const bool known =
      corridor != nullptr && commands_.heard() && commands_.header().contour_id == corridor->contour_id;
  const double distance_m = corridor == nullptr ? laser::kAbsent : corridor->contour.find(place).distance_m;
  return {.stopped = selector_.mode() == SlaveMode::kStopped,
          .fault = false,
          .contour_known = known,
          .engaged = selector_.mode() == SlaveMode::kFollowing,
          .armed = true,
          .button_armed = true,
          .fresh = selected.following && joints_.posed() && inputs.joints.valid,
          .unlit = true,
          .on_time = true,
          .emission_agrees = true,
          .monitor_agrees = true,
          .command_age_s = 0.0,
          .radius_m = place.norm(),
          .height_m = std::abs(tool.position_m.z()),
          .contour_distance_m = distance_m,
          .arc_gap_m = 0.0,
          .predicted_distance_m = 0.0,
          .speed_m_per_s = tool.velocity_m_per_s.norm(),
          .tracking_error_m = (tool.position_m - selected.source_m).norm(),
          .offset_m = selector_.offset_m(),
          .power_w = settings_.laser_w,
          .dose_j = 0.0,
          .area_dose_j_per_mm2 = 0.0};
}

SlaveOutputs SlaveNode::step(std::int64_t now_ns, const SlaveInputs& inputs) noexcept {
  SlaveOutputs out;
  const KinematicState tool = observe(inputs.joints);
  handle_events(inputs.events);
  std::optional<std::uint32_t> contour_id;
  if (inputs.corridor != nullptr) contour_id = inputs.corridor->contour_id;
  for (const auto& command : inputs.commands) commands_.receive(command, contour_id, now_ns);
  const Selected selected = selector_.step(commands_.play(now_ns, tool));

  if (joints_.posed()) out.force_n = joints_.reaction_force_n();
  out.currents_a = joints_.currents(track(selected, tool));

  auto [judgement, permit] = interlock_.decide(now_ns, judged(inputs, selected, tool));
  out.interlock = judgement.reason();
  out.forbidden = judgement.forbidden;
  out.permit = std::move(permit);
  out.laser_w = judgement.permits() && selected.button ? settings_.laser_w : 0.0;
  out.mode = selector_.mode();
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
                            .contour_id = contour_id.value_or(0)},
                           commands_, selected.acknowledgement);
  return out;
}

}  // namespace telekerf::slave
