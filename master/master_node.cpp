// SPDX-License-Identifier: Apache-2.0
#include "master/master_node.h"

#include <cmath>

#include "common/control/tracking_law.h"
#include "master/constraint/reach.h"

namespace telekerf::master {

namespace {

/// The observer answers a push across the curve as fast as it can; what the hand does along the curve need
/// not be known so fast, and is told from the sensor's noise the better.
constexpr double kHand_rad_per_s = 400.0;

constexpr const char* kClockWrong =
    "the slave is let go: it answered before it was asked, so one of the two clocks is wrong; engage anew";

MasterSettings with_bandwidth(MasterSettings settings, const control::LoopBandwidths& bandwidths) {
  settings.constraint.period_s = 1.0 / settings.control_hz;
  settings.constraint.bandwidth_rad_s = bandwidths.law_rad_per_s;
  return settings;
}

control::JointAccelerationSettings joints_in_a_hand(const robot::RobotModel& model,
                                                    const control::LoopBandwidths& bandwidths,
                                                    double control_hz) {
  control::JointAccelerationSettings joints = control::joints_of(model, bandwidths, control_hz);
  joints.observer.abrupt = control::letting_go(control::loop_conditions(model, control_hz));
  return joints;
}

}  // namespace

MasterNode::MasterNode(const robot::RobotModel& model, const MasterSettings& settings, std::uint32_t epoch)
    : model_(model),
      bandwidths_(control::design_loop(control::loop_conditions(model, settings.control_hz),
                                       settings.constraint_rad_s, settings.observer_rad_s)),
      settings_(with_bandwidth(settings, bandwidths_)),
      joints_(model, joints_in_a_hand(model, bandwidths_, settings.control_hz)),
      approach_law_(control::sampled_gains(bandwidths_.law_rad_per_s, 1.0, 1.0 / settings.control_hz)),
      hand_share_(1.0 - std::exp(-kHand_rad_per_s / settings.control_hz)),
      dt_s_(1.0 / settings.control_hz),
      modes_(settings.approach_m_per_s, dt_s_),
      constraint_(settings_.constraint),
      stream_(std::make_unique<CommandStream>(settings.command, epoch)),
      states_(settings.stale_s, epoch, settings.command.ticks_per_sample),
      epoch_(epoch),
      dead_man_(dt_s_) {}

KinematicState MasterNode::observe(const robot::JointReading& joints) noexcept {
  if (!located_ && joints.valid) joints_.reset(joints.joints_m);
  if (!joints_.observe(joints)) return {};
  const robot::DeltaState& pose = joints_.state();
  KinematicState tool{.position_m = model_.in_workpiece(pose.tool_m),
                      .velocity_m_per_s = pose.tool_velocity_m_per_s};
  if (!located_ && joints.valid) {
    modes_.rest_at(tool.position_m);
    located_ = true;
  }
  return tool;
}

bool MasterNode::receive(std::span<const Received<StateBlock>> states) noexcept {
  bool clocks_right = true;
  for (const auto& received : states) {
    const streaming::Feedback& feedback = states_.receive(received);
    if (feedback.kind == streaming::Arrival::Kind::kRefused) continue;
    clocks_right = link_.received(received.value, received.received_ns) && clocks_right;
    stream_->received(feedback);
    if (feedback.kind != streaming::Arrival::Kind::kNew) continue;
    force_.received(feedback, states_.header());
  }
  return clocks_right;
}

const char* MasterNode::hindrance(std::int64_t now_ns, const GuidePath* guide) const noexcept {
  if (!states_.heard() || slave_gone(now_ns))
    return stood_still_ ? "the slave is let go: the master's process stood still meanwhile; engage anew"
                        : "the slave is let go: it is not heard any more; engage anew when it is there";
  if (guide == nullptr || states_.header().contour_id != guide->contour_id)
    return "the slave is let go: it does not work on this side's contour; engage anew when it does";
  if (states_.header().stop != 0) return "the slave is let go: it is stopped; engage anew when that is cleared";
  // Nobody knows yet whose states will be heard; an engagement that holds is nobody else's to end.
  if (modes_.mode() == MasterMode::kEngaged ? spent(engage_) : states_.contested(now_ns))
    return "the slave is let go: it was stopped, started anew or without commands meanwhile; engage anew";
  return nullptr;
}

bool MasterNode::spent(std::uint32_t engage) const noexcept {
  return states_.header().master_epoch == epoch_ &&
         static_cast<std::int32_t>(engage - states_.header().engage) <= 0;
}

Vec3 MasterNode::wanted(const KinematicState& tool, const std::optional<ConstraintMode>& mode, bool button,
                        MasterOutputs& out) noexcept {
  if (!guided()) {
    return control::tracking_acceleration(modes_.goal(), tool, approach_law_);
  }
  if (mode) constraint_.set_mode(*mode);
  Vec3 wanted = constraint_.step(*modes_.guide(), tool, out.hand_n, dt_s_,
                                 button && modes_.mode() == MasterMode::kEngaged);
  out.active = constraint_.active();
  out.corridor_m = constraint_.mode().corridor_m;
  out.constraint_n = -out.active.piece.shape.gradient(tool.position_m.head<2>()).dot(out.hand_n.head<2>());
  return wanted;
}

bool MasterNode::off_line(const Vec2& tool_m, double corridor_m) noexcept {
  off_line_s_ -= dt_s_;
  const bool judged = guided() && corridor_m == 0.0;
  if (judged && modes_.guide()->beta * modes_.guide()->contour.find(tool_m).distance_m > settings_.max_off_line_m)
    off_line_s_ = settings_.back_on_line_s;
  return judged && off_line_s_ > 0.0;
}

void MasterNode::begin_engagement() noexcept {
  // One that the slave does not take for an old one.
  if (spent(engage_ + 1)) engage_ = states_.header().engage;
  ++engage_;
  button_seen_ = false;
}

MasterOutputs MasterNode::step(std::int64_t now_ns, const MasterInputs& inputs) noexcept {
  MasterOutputs out;
  const KinematicState tool = observe(inputs.joints);
  if (joints_.posed()) hand_n_ += hand_share_ * (joints_.reaction_force_n() - hand_n_);
  out.hand_n = hand_n_;
  stood_still_ = stepped_ns_ != 0 && static_cast<double>(now_ns - stepped_ns_) * 1e-9 >= settings_.stale_s;
  stepped_ns_ = now_ns;
  const bool clock_wrong = !receive(inputs.states);
  out.stop = inputs.stop.in_force(states_.heard() ? states_.header().stop : 0);
  const char* const hindrance = clock_wrong ? kClockWrong : this->hindrance(now_ns, inputs.guide);
  const Situation situation{.guide = inputs.guide,
                            .tool_m = tool.position_m,
                            .stopped = out.stop != 0,
                            .engage = inputs.engage,
                            .slave_ready = hindrance == nullptr};
  const bool was_engaged = modes_.mode() == MasterMode::kEngaged;
  if (modes_.step(situation)) constraint_.enter();
  out.engage_spent = modes_.engage_spent();
  if (modes_.mode() == MasterMode::kEngaged && !was_engaged) begin_engagement();
  const bool lost = was_engaged && modes_.mode() == MasterMode::kGuiding && inputs.engage;
  if (clock_wrong || lost) out.let_go = hindrance;
  const bool felt = dead_man_.step(inputs.button, hand_n_.head<2>().norm());
  const bool button = inputs.pedal ? inputs.button : felt;
  button_seen_ = button_seen_ || !button;

  const Vec3 wanted = this->wanted(tool, inputs.constraint, button && button_seen_, out);
  out.off_line = off_line(tool.position_m.head<2>(), out.corridor_m);
  // The hand's force is rejected with the rest of the disturbance; along the curve it comes back through the
  // virtual mass in `wanted`, so the pen is stiff across and free along.
  const robot::DeltaState& pose = joints_.state();
  out.currents_a = joints_.currents(
      joints_.posed() ? within_strokes(model_.geometry, pose.joints_m, pose.joint_velocity_m_per_s,
                                       pose.joint_acceleration(wanted))
                      : joints_.braking_m_per_s2(settings_.constraint.bandwidth_rad_s));
  out.saturated = joints_.saturated();
  out.mode = modes_.mode();
  out.tool_m = tool.position_m;
  out.velocity_m_per_s = tool.velocity_m_per_s;
  // The slave is to follow the curve, not the way back to it from where the hand has pushed the pen.
  out.acceleration_m_per_s2 = guided() ? Vec3(wanted - constraint_.correction_m_per_s2()) : wanted;
  if (modes_.guide() != nullptr && joints_.posed()) {
    out.command = stream_->step(now_ns, tick_,
                                {.tool = {tool.position_m, tool.velocity_m_per_s, out.acceleration_m_per_s2},
                                 .beta = modes_.guide()->beta,
                                 .contour_id = modes_.guide()->contour_id,
                                 .button = button && button_seen_ && !out.off_line,
                                 .engaged = out.mode == MasterMode::kEngaged,
                                 .engage = engage_,
                                 .stop = out.stop,
                                 .echo_sequence = states_.heard() ? states_.header().sequence : 0,
                                 .echo_sent_ns = states_.heard() ? states_.header().sent_ns : 0});
    if (out.command) link_.sent(*out.command, stream_->copies());
  }
  out.observed = stream_->observed();
  out.slave_force = force_.step(dt_s_);
  ++tick_;
  return out;
}

}  // namespace telekerf::master
