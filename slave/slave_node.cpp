// SPDX-License-Identifier: Apache-2.0
#include "slave/slave_node.h"

#include <algorithm>
#include <cmath>

#include "slave/reference.h"

namespace telekerf::slave {
namespace {

/// A stamp further ahead than this of what the elapsed time allows is a broken or hostile clock.
constexpr double kFutureS = 1.0;
/// Missing samples are bridged at constant velocity this long, then the tool slows down to a stop.
constexpr double kBridgeS = 0.032;
constexpr double kSettledM = 20e-6;

}  // namespace

SlaveNode::SlaveNode(const robot::RobotModel& model, const SlaveSettings& settings, std::uint32_t epoch)
    : model_(model),
      kinematics_(model.geometry),
      settings_(settings),
      acceleration_(control::AccelerationControl::settings_for(
          model, {.period_s = 1.0 / settings.control_hz,
                  .bandwidth_rad_per_s = settings.observer_rad_s,
                  .velocity_bandwidth_rad_per_s = 2.5 * settings.observer_rad_s})),
      epoch_(epoch),
      dt_s_(1.0 / settings.control_hz),
      period_ns_(std::llround(1e9 / settings.control_hz)),
      ring_(std::make_unique<SampleRing>()),
      clock_(settings.playout),
      joiner_(settings.joiner),
      encoder_(settings.feedback),
      samples_(static_cast<std::size_t>(settings.feedback.block), Vec3::Zero()),
      ticks_per_sample_(static_cast<int>(std::lround(settings.control_hz / settings.stream_hz))) {}

void SlaveNode::obey(const EventMessage& event) noexcept {
  switch (event.kind) {
    case EventMessage::Kind::kStop:
      mode_ = SlaveMode::kStopped;
      break;
    case EventMessage::Kind::kClearStop:
      if (mode_ == SlaveMode::kStopped) mode_ = SlaveMode::kWaiting;
      break;
    case EventMessage::Kind::kEngage:
    case EventMessage::Kind::kDisengage:
    case EventMessage::Kind::kSetBeta:
    case EventMessage::Kind::kFinished:
    case EventMessage::Kind::kSetNetem:
      break;  // what the stream itself says counts
  }
}

void SlaveNode::receive(const Received<CommandBlock>& received, const Corridor* corridor) noexcept {
  const CommandBlock& block = received.value;
  const bool silent = static_cast<double>(received.received_ns - last_arrival_ns_) * 1e-9 > settings_.stale_s;
  if (heard_ && block.epoch != *master_epoch_) {
    if (!silent) {
      ++counters_.refused;  // another master knocks while ours is alive
      return;
    }
    heard_ = false;
    decoder_.reset();
  }
  if (block.sample_period_ns == 0 || block.ticks_per_sample == 0 ||
      (corridor != nullptr && block.contour_id != corridor->contour_id)) {
    ++counters_.refused;
    return;
  }
  if (heard_ && block.sequence <= number_) {
    ++counters_.stale;
    return;
  }
  const double period_s = block.sample_period_ns * 1e-9;
  const auto first = static_cast<std::int64_t>(block.first_tick / block.ticks_per_sample);
  if (heard_) {
    const double elapsed_s = static_cast<double>(received.received_ns - last_arrival_ns_) * 1e-9;
    if (static_cast<double>(first - newest_index_) * period_s > elapsed_s + kFutureS) {
      ++counters_.refused;
      return;
    }
  }
  const codec::Trend trend{block.anchor.position_m, block.anchor.velocity_m_per_s * period_s};
  const auto decoded = decoder_.decode(block.payload.view(), trend);
  if (!decoded) {
    ++counters_.refused;
    return;
  }

  if (!heard_) {
    master_epoch_ = block.epoch;
    ring_->clear();
    clock_.reset();
    newest_index_ = -1;
    ++generation_;
  } else if (block.beta != header_.beta || block.sample_period_ns != header_.sample_period_ns) {
    ++generation_;
  }
  const std::uint32_t missing = heard_ ? block.sequence - number_ - 1 : 0;
  counters_.lost += missing;
  ++counters_.blocks;
  number_ = block.sequence;
  header_ = block;
  heard_ = true;
  last_arrival_ns_ = received.received_ns;

  const codec::DecodedPacket& packet = **decoded;
  for (int age = 0; age < packet.blocks; ++age) {
    const codec::DecodedBlock& part = packet.blocks_newest_first[static_cast<std::size_t>(age)];
    const std::int64_t start = first - static_cast<std::int64_t>(age) * packet.block_size;
    for (int n = 0; n < packet.block_size; ++n) {
      const std::int64_t index = start + n;
      if (age > 0 && ring_->find(index) != nullptr) continue;  // the copy says nothing new
      const bool button = ((part.button >> n) & 1U) != 0;
      ring_->store(index, {part.samples[static_cast<std::size_t>(n)], button, block.engaged, generation_});
    }
  }
  newest_index_ = std::max(newest_index_, first + packet.block_size - 1);
  clock_.arrived(received.received_ns, first + packet.block_size - 1, packet.block_size,
                 block.sample_period_ns, missing > 0);
}

Motion SlaveNode::choose_source(std::int64_t now_ns, SlaveOutputs& out) noexcept {
  const bool fresh = heard_ && static_cast<double>(now_ns - last_arrival_ns_) * 1e-9 < settings_.stale_s;
  std::optional<Motion> found;
  const StreamSample* sample = nullptr;
  const double period_s = header_.sample_period_ns * 1e-9;
  if (fresh) {
    if (const auto cursor = clock_.advance(now_ns, period_ns_, starving_)) {
      const auto index = static_cast<std::int64_t>(std::llround(*cursor));
      found = reference_at(*ring_, *cursor, period_s);
      if (found) {
        sample = ring_->find(index);
        out.applied_tick = *cursor * header_.ticks_per_sample;
      }
      if (index > applied_index_) {
        const auto shift = index - applied_index_;
        applied_bitmap_ = shift < 64 ? applied_bitmap_ << shift : 0;
        if (found) applied_bitmap_ |= 1;
        applied_index_ = index;
      }
      starving_ = !found;
      if (starving_ && mode_ == SlaveMode::kFollowing) ++counters_.missed_ticks;
    }
  }
  button_ = sample != nullptr && sample->button;
  applied_age_ = found ? 0 : applied_age_ + 1;

  if (mode_ == SlaveMode::kStopped) {
    found.reset();
  } else if (found && sample->engaged) {
    mode_ = SlaveMode::kFollowing;
  } else if (!fresh && mode_ == SlaveMode::kFollowing) {
    mode_ = SlaveMode::kHolding;
  } else if (found) {
    mode_ = SlaveMode::kWaiting;
    found.reset();
  }

  if (mode_ == SlaveMode::kFollowing && found) {
    // A new source, or the same one after a gap that was bridged: go on from where the reference is.
    if (source_generation_ != sample->generation) joiner_.rejoin(reference_, *found);
    source_generation_ = sample->generation;
    return *found;
  }
  out.applied_tick = -1.0;
  if (mode_ == SlaveMode::kFollowing && applied_age_ * dt_s_ < kBridgeS) {
    if (source_generation_ != 0) {
      hold_ = reference_;
      hold_.acceleration_m_per_s2.setZero();
      joiner_.rejoin(reference_, hold_);
      source_generation_ = 0;
    }
    hold_.position_m += hold_.velocity_m_per_s * dt_s_;
    return hold_;
  }
  if (source_generation_ != 0 || !hold_.velocity_m_per_s.isZero()) {
    hold_ = Motion{.position_m = reference_.position_m};
    joiner_.rejoin(reference_, hold_);
    source_generation_ = 0;
  }
  return hold_;
}

void SlaveNode::keep_inside(Motion& motion) const noexcept {
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
  Motion tool;
  if (state) {
    tool.position_m = model_.in_workpiece(state->tool_m);
    tool.velocity_m_per_s = state->tool_velocity_m_per_s;
  } else {
    tool = reference_;
  }
  if (!reference_known_ && state && inputs.joints.valid) {
    reference_ = hold_ = Motion{.position_m = tool.position_m};
    reference_known_ = true;
  }

  for (const auto& event : inputs.events) obey(event);
  for (const auto& command : inputs.commands) receive(command, inputs.corridor);

  reference_ = joiner_.join(choose_source(now_ns, out), dt_s_);
  keep_inside(reference_);

  // Eq. 87 in operational space: error dynamics e'' + 2 w e' + w^2 e = 0, within the robot's acceleration.
  const double w = settings_.bandwidth_rad_s;
  Vec3 wanted = reference_.acceleration_m_per_s2 +
                2.0 * w * (reference_.velocity_m_per_s - tool.velocity_m_per_s) +
                w * w * (reference_.position_m - tool.position_m);
  const double limit = model_.limits.acceleration_m_per_s2;
  if (wanted.norm() > limit) wanted *= limit / wanted.norm();
  // A pose without kinematics (it cannot be reached by following): the joints are braked where they are.
  const Vec3 joint_acceleration =
      state ? state->joint_acceleration(wanted) : Vec3(-2.0 * w * acceleration_.joint_velocity_m_per_s());
  if (state) inertia_kg_ = robot::joint_inertia(model_, *state);
  out.currents_a = acceleration_.currents(joint_acceleration, inertia_kg_, acceleration_.disturbance_n());

  const Corridor* corridor = inputs.corridor;
  const bool following = mode_ == SlaveMode::kFollowing && source_generation_ != 0;
  out.interlock =
      judge({.stopped = mode_ == SlaveMode::kStopped,
             .contour_known = corridor != nullptr && heard_ && header_.contour_id == corridor->contour_id,
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

  if (tick_ % static_cast<Tick>(ticks_per_sample_) == 0) {
    if (filled_ == 0) {
      block_tick_ = tick_;
      block_anchor_ = rounded({tool.position_m, tool.velocity_m_per_s});
      laser_mask_ = 0;
    }
    if (out.laser_w > 0.0) laser_mask_ |= std::uint64_t{1} << filled_;
    samples_[filled_++] = tool.position_m;
    if (filled_ == samples_.size()) report(now_ns, corridor, out);
  }
  ++tick_;
  return out;
}

void SlaveNode::report(std::int64_t now_ns, const Corridor* corridor, SlaveOutputs& out) noexcept {
  filled_ = 0;
  StateBlock& block = out.state.emplace();
  block.sequence = ++state_number_;
  block.epoch = epoch_;
  block.master_epoch = master_epoch_.value_or(0);
  block.first_tick = block_tick_;
  block.ticks_per_sample = static_cast<std::uint16_t>(ticks_per_sample_);
  block.sample_period_ns = static_cast<std::uint32_t>(period_ns_ * ticks_per_sample_);
  block.contour_id = corridor == nullptr ? 0 : corridor->contour_id;
  block.beta = header_.beta;
  block.anchor = block_anchor_;
  block.interlock = out.interlock;
  block.laser_on = out.laser_w > 0.0;
  block.applied_tick = applied_index_ < 0 ? 0 : static_cast<Tick>(applied_index_) * header_.ticks_per_sample;
  block.applied_age_ticks = applied_age_;
  block.applied_bitmap = applied_bitmap_;
  block.playout_ticks = clock_.depth_samples();
  block.echo_sequence = heard_ ? number_ : 0;
  block.echo_sent_ns = header_.sent_ns;
  block.echo_received_ns = last_arrival_ns_;
  block.sent_ns = now_ns;
  const codec::Trend trend{block.anchor.position_m,
                           block.anchor.velocity_m_per_s * (block.sample_period_ns * 1e-9)};
  const auto bytes = encoder_.encode(samples_, laser_mask_, trend, block.payload.room());
  if (bytes) {
    block.payload.size = static_cast<std::uint16_t>(*bytes);
  } else {
    out.state.reset();  // a block that cannot be coded is not sent; the next one stands alone
  }
}

}  // namespace telekerf::slave
