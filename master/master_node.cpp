// SPDX-License-Identifier: Apache-2.0
#include "master/master_node.h"

#include <algorithm>
#include <cmath>

#include "master/constraint/reach.h"

namespace telekerf::master {

namespace {

control::DisturbanceObserver::Gains gains_of(const MasterSettings& settings) {
  return {.period_s = 1.0 / settings.control_hz,
          .bandwidth_rad_per_s = settings.observer_rad_s,
          .velocity_bandwidth_rad_per_s = 3.0 * settings.observer_rad_s};
}

ConstraintSettings constraint_of(const MasterSettings& settings) {
  ConstraintSettings constraint = settings.constraint;
  constraint.period_s = 1.0 / settings.control_hz;
  return constraint;
}

}  // namespace

MasterNode::MasterNode(const robot::RobotModel& model, const MasterSettings& settings, std::uint32_t epoch)
    : model_(model),
      kinematics_(model.geometry),
      settings_(settings),
      acceleration_(control::AccelerationControl::settings_for(model, gains_of(settings))),
      friction_(model.friction, gains_of(settings)),
      dt_s_(1.0 / settings.control_hz),
      constraint_(constraint_of(settings)),
      stream_(settings.command, epoch) {}

void MasterNode::heed(std::span<const EventMessage> events) noexcept {
  for (const auto& event : events) {
    if (event.kind == EventMessage::Kind::kStop) mode_ = MasterMode::kStopped;
    if (event.kind == EventMessage::Kind::kClearStop && mode_ == MasterMode::kStopped)
      mode_ = MasterMode::kIdle;
  }
}

void MasterNode::choose_mode(std::int64_t now_ns, const MasterInputs& inputs, const Tool& tool) noexcept {
  const MasterMode before = mode_;
  heed(inputs.events);
  if (mode_ != before) hold_m_ = tool.position_m;
  if (mode_ == MasterMode::kStopped) {
    guide_ = inputs.guide;  // the one before may be gone by the next step
    return;
  }
  if (inputs.guide != guide_ || (mode_ == MasterMode::kIdle && inputs.guide != nullptr)) {
    guide_ = inputs.guide;
    constraint_.enter();
    if (guide_ == nullptr) {
      if (mode_ != MasterMode::kIdle) hold_m_ = tool.position_m;
      mode_ = MasterMode::kIdle;
      return;
    }
    // To the nearest point of the curve and the working plane, along a straight line.
    const Vec2 goal = guide_->curve.find(tool.position_m.head<2>()).point_m;
    approach_from_m_ = tool.position_m;
    approach_to_m_ = Vec3(goal.x(), goal.y(), 0.0);
    approach_s_ = 0.0;
    approach_duration_s_ =
        std::max(0.5, (approach_to_m_ - approach_from_m_).norm() / settings_.approach_m_per_s);
    mode_ = MasterMode::kApproach;
    return;
  }
  const bool slave_alive =
      link_.states() > 0 && static_cast<double>(now_ns - slave_heard_ns_) * 1e-9 < settings_.stale_s &&
      guide_ != nullptr && slave_.contour_id == guide_->contour_id && slave_.interlock != Interlock::kStopped;
  switch (mode_) {
    case MasterMode::kApproach:
      // Half a second to come to rest after the planned motion.
      if (approach_s_ > approach_duration_s_ + 0.5) mode_ = MasterMode::kGuiding;
      break;
    case MasterMode::kGuiding:
      if (inputs.engage && slave_alive) mode_ = MasterMode::kEngaged;
      break;
    case MasterMode::kEngaged:
      if (!inputs.engage || !slave_alive) mode_ = MasterMode::kGuiding;
      break;
    case MasterMode::kIdle:
    case MasterMode::kStopped:
      break;
  }
}

Vec3 MasterNode::held(const Tool& tool, const Vec3& goal_m, const Vec3& goal_velocity,
                      const Vec3& goal_acceleration) const noexcept {
  const double w = settings_.constraint.bandwidth_rad_s;
  return goal_acceleration + 2.0 * w * (goal_velocity - tool.velocity_m_per_s) +
         w * w * (goal_m - tool.position_m);
}

Vec3 MasterNode::approach(const Tool& tool) noexcept {
  // Minimum-jerk polynomial in normalised time.
  approach_s_ += dt_s_;
  const double duration = approach_duration_s_;
  const double u = std::min(approach_s_ / duration, 1.0);
  const Vec3 way = approach_to_m_ - approach_from_m_;
  const double place = u * u * u * (10.0 + u * (-15.0 + 6.0 * u));
  const double speed = 30.0 * u * u * (1.0 - u) * (1.0 - u) / duration;
  const double acceleration = 60.0 * u * (1.0 - u) * (1.0 - 2.0 * u) / (duration * duration);
  return held(tool, approach_from_m_ + place * way, speed * way, acceleration * way);
}

MasterOutputs MasterNode::step(std::int64_t now_ns, const MasterInputs& inputs) noexcept {
  MasterOutputs out;
  if (!started_ && inputs.joints.valid) acceleration_.reset(inputs.joints.joints_m);
  acceleration_.observe(inputs.joints);
  const auto state = kinematics_.state(acceleration_.joints_m(), acceleration_.joint_velocity_m_per_s());
  Tool tool;
  if (state) {
    tool.position_m = model_.in_workpiece(state->tool_m);
    tool.velocity_m_per_s = state->tool_velocity_m_per_s;
    inertia_kg_ = robot::joint_inertia(model_, *state);
    friction_.update(state->joint_velocity_m_per_s);
    out.hand_n = control::reaction_force(model_, kinematics_, *state, acceleration_.disturbance_n(),
                                         friction_.seen_n());
  }
  if (!started_ && state && inputs.joints.valid) {
    hold_m_ = tool.position_m;
    started_ = true;
  }

  for (const auto& received : inputs.states) {
    slave_ = received.value;
    slave_heard_ns_ = received.received_ns;
    link_.received(received.value, received.received_ns);
    stream_.received(received.value);
    force_.received(received.value);
  }
  choose_mode(now_ns, inputs, tool);

  Vec3 wanted = Vec3::Zero();
  switch (mode_) {
    case MasterMode::kIdle:
    case MasterMode::kStopped:
      wanted = held(tool, hold_m_, Vec3::Zero(), Vec3::Zero());
      break;
    case MasterMode::kApproach:
      wanted = approach(tool);
      break;
    case MasterMode::kGuiding:
    case MasterMode::kEngaged: {
      if (inputs.form) constraint_.choose(*inputs.form);
      wanted = constraint_.step(*guide_, {tool.position_m, tool.velocity_m_per_s, out.hand_n}, dt_s_);
      out.active = constraint_.active();
      out.corridor_m = constraint_.form().corridor_m;
      out.constraint_n =
          -out.active.piece.shape.gradient(tool.position_m.head<2>()).dot(out.hand_n.head<2>());
      break;
    }
  }
  const Vec3 joint_acceleration =
      state ? within_strokes(model_.geometry, state->joints_m, state->joint_velocity_m_per_s,
                             state->joint_acceleration(wanted))
            : Vec3(-2.0 * settings_.constraint.bandwidth_rad_s * acceleration_.joint_velocity_m_per_s());
  // All of the disturbance is put back, the hand's part of it included; along the curve the hand's force
  // comes back through the virtual mass in `wanted`, so the pen is stiff across and free along.
  out.currents_a = acceleration_.currents(joint_acceleration, inertia_kg_,
                                          acceleration_.disturbance_n() + friction_.missing_n());
  out.saturated = acceleration_.saturated();
  out.mode = mode_;
  out.tool_m = tool.position_m;
  out.velocity_m_per_s = tool.velocity_m_per_s;
  out.acceleration_m_per_s2 = wanted;
  if (guide_ != nullptr && state) {
    out.command = stream_.step(now_ns, tick_,
                               {.tool = {tool.position_m, tool.velocity_m_per_s, wanted},
                                .beta = guide_->beta,
                                .contour_id = guide_->contour_id,
                                .button = inputs.button,
                                .engaged = mode_ == MasterMode::kEngaged});
    if (out.command) link_.sent(*out.command);
  }
  out.observed = stream_.observed();
  out.slave_force = force_.step(dt_s_);
  ++tick_;
  return out;
}

}  // namespace telekerf::master
