// SPDX-License-Identifier: Apache-2.0
#include "slave/slave_node.h"

#include <algorithm>
#include <cmath>

namespace telekerf::slave {
namespace {

/// Missing samples are bridged at constant velocity this long, then the tool slows down to a stop.
constexpr double kBridgeS = 0.032;
constexpr double kSettledM = 20e-6;

std::int64_t period_ns(const SlaveSettings& settings) noexcept {
  return std::llround(1e9 / settings.control_hz);
}

control::DisturbanceObserver::Gains gains_of(const SlaveSettings& settings) noexcept {
  return {.period_s = 1.0 / settings.control_hz,
          .bandwidth_rad_per_s = settings.observer_rad_s,
          .velocity_bandwidth_rad_per_s = 2.5 * settings.observer_rad_s};
}

}  // namespace

SlaveNode::SlaveNode(const robot::RobotModel& model, const SlaveSettings& settings, std::uint32_t epoch)
    : model_(model),
      kinematics_(model.geometry),
      settings_(settings),
      acceleration_(control::AccelerationControl::settings_for(model, gains_of(settings))),
      friction_(model.friction, gains_of(settings)),
      dt_s_(1.0 / settings.control_hz),
      intake_({.playout = settings.playout,
               .stale_s = settings.stale_s,
               .max_acceleration_m_per_s2 = model.limits.acceleration_m_per_s2,
               .control_period_ns = period_ns(settings)}),
      joiner_(settings.joiner),
      states_({.positions = settings.feedback,
               .forces = settings.force,
               .ticks_per_sample = static_cast<int>(std::lround(settings.control_hz / settings.stream_hz)),
               .control_period_ns = period_ns(settings)},
              epoch) {}

void SlaveNode::heed(std::span<const EventMessage> events) noexcept {
  // Engaging and the like come with the stream itself.
  for (const auto& event : events) {
    if (event.kind == EventMessage::Kind::kStop) mode_ = SlaveMode::kStopped;
    if (event.kind == EventMessage::Kind::kClearStop && mode_ == SlaveMode::kStopped)
      mode_ = SlaveMode::kWaiting;
  }
}

void SlaveNode::rejoin(const KinematicState& source) noexcept {
  // What the reference would be now, had its source gone on.
  joiner_.rejoin(advanced(reference_, dt_s_), source);
  rejoined_ = true;
}

KinematicState SlaveNode::choose_source(std::int64_t now_ns, const KinematicState& tool,
                                        SlaveOutputs& out) noexcept {
  const Played played = intake_.play(now_ns, tool);
  const StreamSample* sample = played.sample;
  if (played.cursor && (sample == nullptr || sample->bridged) && mode_ == SlaveMode::kFollowing)
    ++missed_ticks_;
  button_ = sample != nullptr && sample->button;
  if (sample != nullptr && !sample->engaged) tripped_ = false;

  bool follows = false;
  if (mode_ == SlaveMode::kStopped) {
    // Latched: whatever the stream says.
  } else if (sample != nullptr && sample->engaged) {
    mode_ = SlaveMode::kFollowing;
    if (sample->law == Law::kRemoteAcceleration) tripped_ = tripped_ || !obeys_limits(played.motion);
    follows = !tripped_;
  } else if (!played.fresh && mode_ == SlaveMode::kFollowing) {
    mode_ = SlaveMode::kHolding;
  } else if (sample != nullptr) {
    mode_ = SlaveMode::kWaiting;
  }

  if (!follows) {
    intake_.pass();
    return hold_on();
  }
  out.applied_tick = *played.cursor * intake_.header().ticks_per_sample;
  if (!sample->bridged) intake_.acknowledge(played.index);
  if (played.seam) source_block_ = 0;
  return follow(*sample, played.motion);
}

bool SlaveNode::obeys_limits(const KinematicState& motion) const noexcept {
  const double speed = motion.velocity_m_per_s.norm();
  Vec3 rest_m = motion.position_m;
  if (speed > 0.0) rest_m += (kBridgeS + joiner_.way_to_rest_m(speed) / speed) * motion.velocity_m_per_s;
  return rest_m.head<2>().norm() < model_.workspace.radius_m &&
         std::abs(rest_m.z()) < 0.5 * model_.workspace.height_m && speed < model_.limits.velocity_m_per_s;
}

KinematicState SlaveNode::follow(const StreamSample& sample, const KinematicState& found) noexcept {
  const bool new_source = source_generation_ != sample.generation || source_law_ != sample.law;
  source_generation_ = sample.generation;
  source_law_ = sample.law;
  if (sample.law == Law::kRemoteAcceleration) {
    // The tool itself is the reference; step() pulls it nowhere, the acceleration is all there is.
    if (new_source) rejoin(found);
    return found;
  }
  // From one anchor to the next, over a corrected clock, after a gap: go on from where the reference is.
  if (new_source || source_block_ == 0 || (sample.law == Law::kAnchored && source_block_ != sample.block)) {
    rejoin(found);
  }
  source_block_ = sample.block;
  return found;
}

KinematicState SlaveNode::hold_on() noexcept {
  if (mode_ == SlaveMode::kFollowing && !tripped_ && intake_.applied_age() * dt_s_ < kBridgeS) {
    if (source_generation_ != 0) {
      hold_ = reference_;
      hold_.acceleration_m_per_s2.setZero();
      source_generation_ = 0;
      hold_ = advanced(hold_, dt_s_);
      rejoin(hold_);
      return hold_;
    }
    hold_ = advanced(hold_, dt_s_);
    return hold_;
  }
  if (source_generation_ != 0 || !hold_.velocity_m_per_s.isZero()) {
    hold_ = KinematicState{.position_m = reference_.position_m};
    source_generation_ = 0;
    rejoin(hold_);
  }
  return hold_;
}

void SlaveNode::keep_inside(KinematicState& motion) const noexcept {
  const double radius_m = model_.workspace.radius_m;
  const double distance_m = motion.position_m.head<2>().norm();
  if (distance_m > radius_m) {
    const Vec2 outward = motion.position_m.head<2>() / distance_m;
    motion.position_m.head<2>() = radius_m * outward;
    const double speed = outward.dot(motion.velocity_m_per_s.head<2>());
    if (speed > 0.0) motion.velocity_m_per_s.head<2>() -= speed * outward;
    motion.acceleration_m_per_s2.setZero();
  }
  const double height_m = 0.5 * model_.workspace.height_m;
  if (std::abs(motion.position_m.z()) > height_m) {
    motion.position_m.z() = std::clamp(motion.position_m.z(), -height_m, height_m);
    motion.velocity_m_per_s.z() = 0.0;
    motion.acceleration_m_per_s2.z() = 0.0;
  }
}

SlaveOutputs SlaveNode::step(std::int64_t now_ns, const SlaveInputs& inputs) noexcept {
  SlaveOutputs out;
  if (!reference_known_ && inputs.joints.valid) acceleration_.reset(inputs.joints.joints_m);
  acceleration_.observe(inputs.joints);
  const auto state = kinematics_.state(acceleration_.joints_m(), acceleration_.joint_velocity_m_per_s());
  KinematicState tool;
  if (state) {
    tool.position_m = model_.in_workpiece(state->tool_m);
    tool.velocity_m_per_s = state->tool_velocity_m_per_s;
  } else {
    tool = reference_;
  }
  if (!reference_known_ && state && inputs.joints.valid) {
    reference_ = hold_ = KinematicState{.position_m = tool.position_m};
    reference_known_ = true;
  }

  heed(inputs.events);
  std::optional<std::uint32_t> contour_id;
  if (inputs.corridor != nullptr) contour_id = inputs.corridor->contour_id;
  for (const auto& command : inputs.commands) intake_.receive(command, contour_id);

  rejoined_ = false;
  const KinematicState source = choose_source(now_ns, tool, out);
  reference_ = joiner_.join(source, rejoined_ ? 0.0 : dt_s_);
  keep_inside(reference_);

  // Eq. 87 in operational space: error dynamics e'' + 2 w e' + w^2 e = 0, within the robot's acceleration.
  const double w = settings_.bandwidth_rad_s;
  Vec3 wanted = reference_.acceleration_m_per_s2 +
                2.0 * w * (reference_.velocity_m_per_s - tool.velocity_m_per_s) +
                w * w * (reference_.position_m - tool.position_m);
  const double limit = model_.limits.acceleration_m_per_s2;
  if (source_generation_ != 0 && source_law_ == Law::kRemoteAcceleration)
    wanted = source.acceleration_m_per_s2;
  if (wanted.norm() > limit) wanted *= limit / wanted.norm();
  // A pose without kinematics (it cannot be reached by following): the joints are braked where they are.
  const Vec3 joint_acceleration =
      state ? state->joint_acceleration(wanted) : Vec3(-2.0 * w * acceleration_.joint_velocity_m_per_s());
  if (state) inertia_kg_ = robot::joint_inertia(model_, *state);
  friction_.update(acceleration_.joint_velocity_m_per_s());
  if (state) {
    out.force_n = control::reaction_force(model_, kinematics_, *state, acceleration_.disturbance_n(),
                                          friction_.seen_n());
  }
  out.currents_a = acceleration_.currents(joint_acceleration, inertia_kg_,
                                          acceleration_.disturbance_n() + friction_.missing_n());

  const Corridor* corridor = inputs.corridor;
  const bool following = mode_ == SlaveMode::kFollowing && source_generation_ != 0;
  out.interlock = laser::evaluate_interlock(
      {.stopped = mode_ == SlaveMode::kStopped,
       .contour_known =
           corridor != nullptr && intake_.heard() && intake_.header().contour_id == corridor->contour_id,
       .engaged = mode_ == SlaveMode::kFollowing,
       .fresh = following && state.has_value() && inputs.joints.valid,
       .inside_workspace = tool.position_m.head<2>().norm() <= model_.workspace.radius_m,
       .contour_distance_m =
           corridor == nullptr ? 1.0 : corridor->contour.find(tool.position_m.head<2>()).distance_m,
       .speed_m_per_s = tool.velocity_m_per_s.norm(),
       .tracking_error_m = (tool.position_m - reference_.position_m).norm() + joiner_.offset_m()},
      settings_.interlock);
  out.laser_w = out.interlock == Interlock::kReady && button_ ? settings_.laser_w : 0.0;
  out.mode = mode_;
  out.settled = following && joiner_.offset_m() < kSettledM;
  out.reference = reference_;
  out.tool_m = tool.position_m;

  out.state = states_.step(now_ns, tick_,
                           {.tool_m = tool.position_m,
                            .velocity_m_per_s = tool.velocity_m_per_s,
                            .force_n = out.force_n,
                            .laser_on = out.laser_w > 0.0});
  if (out.state) {
    out.state->contour_id = contour_id.value_or(0);
    out.state->interlock = out.interlock;
    intake_.describe(*out.state);
  }
  ++tick_;
  return out;
}

}  // namespace telekerf::slave
