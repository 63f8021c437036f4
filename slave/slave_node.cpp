// SPDX-License-Identifier: Apache-2.0
#include "slave/slave_node.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "slave/reference.h"

namespace telekerf::slave {
namespace {

/// A stamp further ahead than this of what the elapsed time allows is a broken or hostile clock.
constexpr double kFutureS = 1.0;
/// Missing samples are bridged at constant velocity this long, then the tool slows down to a stop.
constexpr double kBridgeS = 0.032;
/// Gaps up to this many samples are bridged where both ends are known.
constexpr int kReach = 400;
constexpr double kSettledM = 20e-6;

/// Accelerations have no straight line through them; their anchor is for the reference.
codec::Trend trend_of(const CommandBlock& block) noexcept {
  if (block.law != Law::kLocal) return {};
  return {block.anchor.position_m, block.anchor.velocity_m_per_s * (block.sample_period_ns * 1e-9)};
}

/// Samples of both are counted alike.
bool same_count(const CommandBlock& a, const CommandBlock& b) noexcept {
  return a.sample_period_ns == b.sample_period_ns && a.ticks_per_sample == b.ticks_per_sample;
}

/// Samples of both are comparable.
bool same_source(const CommandBlock& a, const CommandBlock& b) noexcept {
  return a.beta == b.beta && a.law == b.law;
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
      epoch_(epoch),
      dt_s_(1.0 / settings.control_hz),
      period_ns_(std::llround(1e9 / settings.control_hz)),
      ring_(std::make_unique<SampleRing>()),
      clock_(settings.playout),
      joiner_(settings.joiner),
      encoder_(settings.feedback),
      force_encoder_(settings.force),
      samples_(codec::kMaxBlock, Vec3::Zero()),
      forces_n_(codec::kMaxBlock, Vec3::Zero()),
      ticks_per_sample_(static_cast<int>(std::lround(settings.control_hz / settings.stream_hz))) {
  samples_.resize(static_cast<std::size_t>(settings.feedback.block));
  forces_n_.resize(samples_.size());
}

void SlaveNode::change(const codec::StreamSettings& feedback, const codec::StreamSettings& force) {
  next_feedback_.emplace(feedback.validated(), force.validated());
  auto& [next, next_force] = *next_feedback_;
  next.sample_period_ns = settings_.feedback.sample_period_ns;
  next_force.sample_period_ns = next.sample_period_ns;
  next_force.block = next.block;
}

void SlaveNode::take_up_changes() noexcept {
  if (!next_feedback_) return;
  std::tie(settings_.feedback, settings_.force) = *next_feedback_;
  next_feedback_.reset();
  encoder_.change(settings_.feedback);
  force_encoder_.change(settings_.force);
  samples_.resize(static_cast<std::size_t>(settings_.feedback.block));
  forces_n_.resize(samples_.size());
}

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
  const double period_s = block.sample_period_ns * 1e-9;
  if (heard_ && block.sequence <= number_) {
    if (!catch_up(received)) ++counters_.stale;
    return;
  }
  const auto first = static_cast<std::int64_t>(block.first_tick / block.ticks_per_sample);
  // Another sample rate is another count of samples: the stream begins anew.
  const bool afresh = !heard_ || !same_count(block, header_);
  if (!afresh) {
    const double elapsed_s = static_cast<double>(received.received_ns - last_arrival_ns_) * 1e-9;
    if (static_cast<double>(first - newest_index_) * period_s > elapsed_s + kFutureS) {
      ++counters_.refused;
      return;
    }
  }
  const auto decoded = decoder_.decode(block.payload.view(), trend_of(block));
  if (!decoded) {
    ++counters_.refused;
    return;
  }

  if (afresh) {
    first_number_ = block.sequence;
    master_epoch_ = block.epoch;
    ring_->clear();
    clock_.reset();
    newest_index_ = -1;
    applied_index_ = -1;
    applied_bitmap_ = 0;
    cursor_.reset();
    ++generation_;
  } else if (!same_source(block, header_)) {
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
  store(packet, block);
  newest_index_ = std::max(newest_index_, first + packet.block_size - 1);
  clock_.arrived(received.received_ns, first + packet.block_size - 1, packet.block_size,
                 block.sample_period_ns, missing > 0);
}

bool SlaveNode::catch_up(const Received<CommandBlock>& received) noexcept {
  const CommandBlock& block = received.value;
  // What was sent before the stream was joined was never counted as lost.
  if (block.sequence < first_number_ || !same_count(block, header_) || !same_source(block, header_))
    return false;
  const auto first = static_cast<std::int64_t>(block.first_tick / block.ticks_per_sample);
  const std::int64_t last = first + codec::kMaxBlock - 1;
  if (cursor_ && static_cast<double>(last) < *cursor_) return false;
  const auto decoded = decoder_.decode(block.payload.view(), trend_of(block));
  if (!decoded) return false;  // also what comes twice
  --counters_.lost;
  ++counters_.blocks;
  store(**decoded, block);
  const int size = (*decoded)->block_size;
  clock_.arrived(received.received_ns, first + size - 1, size, block.sample_period_ns, false);
  return true;
}

void SlaveNode::store(const codec::DecodedPacket& packet, const CommandBlock& block) noexcept {
  const auto newest = static_cast<std::int64_t>(block.first_tick / block.ticks_per_sample);
  const double period_s = block.sample_period_ns * 1e-9;
  const auto sample_of = [&](int age, int n) {
    const codec::DecodedBlock& part = packet.blocks_newest_first[static_cast<std::size_t>(age)];
    StreamSample sample;
    sample.law = block.law;
    sample.block = block.sequence - static_cast<std::uint32_t>(age);
    sample.button = ((part.button >> n) & 1U) != 0;
    sample.engaged = age == 0 ? block.engaged : age <= 7 && ((block.engaged_before >> (age - 1)) & 1U) != 0;
    sample.generation = generation_;
    (block.law == Law::kLocal ? sample.value : sample.acceleration_m_per_s2) =
        part.samples[static_cast<std::size_t>(n)];
    return sample;
  };
  const auto put = [&](std::int64_t index, const StreamSample& sample) {
    const StreamSample* known = ring_->find(index);
    if (known == nullptr || known->bridged) ring_->store(index, sample);
  };
  const auto at_state = [](StreamSample sample, const Motion& state) {
    sample.value = state.position_m;
    sample.velocity_m_per_s = state.velocity_m_per_s;
    return sample;
  };
  // The newest block: the accelerations integrated from the anchor are the master's model, bit for bit.
  const Motion anchor{block.anchor.position_m, block.anchor.velocity_m_per_s, Vec3::Zero()};
  Motion state = anchor;
  for (int n = 0; n < packet.block_size; ++n) {
    StreamSample sample = sample_of(0, n);
    if (block.law == Law::kAnchored) {
      sample = at_state(sample, state);
      state.acceleration_m_per_s2 = sample.acceleration_m_per_s2;
      state = advanced(state, period_s);
    }
    put(newest + n, sample);
  }
  // Copies of older blocks come without their anchors: integrated backwards from the newest one.
  state = anchor;
  std::int64_t index = newest;
  for (int age = 1; age < packet.blocks; ++age) {
    for (int n = packet.block_size - 1; n >= 0; --n) {
      StreamSample sample = sample_of(age, n);
      if (block.law == Law::kAnchored) {
        state = control::preceding(state, sample.acceleration_m_per_s2, period_s);
        sample = at_state(sample, state);
      }
      put(--index, sample);
    }
  }
}

std::optional<Motion> SlaveNode::sample_at(double cursor, const Motion& tool) const noexcept {
  const double period_s = header_.sample_period_ns * 1e-9;
  if (header_.law == Law::kLocal) return reference_at(*ring_, cursor, period_s);
  // Commands are held from their sample to the next.
  const double whole = std::floor(cursor + 1e-6);
  const StreamSample* sample = ring_->find(static_cast<std::int64_t>(whole));
  if (sample == nullptr || sample->law != header_.law) return std::nullopt;
  if (header_.law == Law::kRemoteAcceleration) {
    return Motion{tool.position_m, tool.velocity_m_per_s, sample->acceleration_m_per_s2};
  }
  const Motion state{sample->value, sample->velocity_m_per_s, sample->acceleration_m_per_s2};
  return advanced(state, (cursor - whole) * period_s);
}

void SlaveNode::rejoin(const Motion& source) noexcept {
  // What the reference would be now, had its source gone on.
  joiner_.rejoin(advanced(reference_, dt_s_), source);
  rejoined_ = true;
}

Motion SlaveNode::choose_source(std::int64_t now_ns, const Motion& tool, SlaveOutputs& out) noexcept {
  // What the play-out waits for stragglers is not silence yet.
  const double silent_s = static_cast<double>(now_ns - last_arrival_ns_) * 1e-9 - clock_.wait_s();
  const bool fresh = heard_ && silent_s < settings_.stale_s;
  std::optional<Motion> found;
  const StreamSample* sample = nullptr;
  std::int64_t index = -1;
  bool seam = true;  // the stream's time did not go on by one step, as it should
  if (fresh) {
    if (const auto cursor = clock_.advance(now_ns, period_ns_, starving_)) {
      index = header_.law == Law::kLocal ? std::llround(*cursor)
                                         : static_cast<std::int64_t>(std::floor(*cursor + 1e-6));
      if (header_.law != Law::kLocal && ring_->find(index) == nullptr) {
        bridge_gap(*ring_, index, header_.sample_period_ns * 1e-9, kReach,
                   model_.limits.acceleration_m_per_s2);
      }
      found = sample_at(*cursor, tool);
      if (found) {
        sample = ring_->find(index);
        out.applied_tick = *cursor * header_.ticks_per_sample;
      }
      starving_ = !found;
      if ((starving_ || sample->bridged) && mode_ == SlaveMode::kFollowing) ++counters_.missed_ticks;
      const double step = dt_s_ * 1e9 / header_.sample_period_ns;
      seam = !cursor_ || std::abs(*cursor - *cursor_ - step) > 1e-3;
      cursor_ = *cursor;
    }
  }
  button_ = sample != nullptr && sample->button;
  if (sample != nullptr && !sample->engaged) tripped_ = false;

  if (mode_ == SlaveMode::kStopped) {
    found.reset();
  } else if (found && sample->engaged) {
    mode_ = SlaveMode::kFollowing;
    if (sample->law == Law::kRemoteAcceleration) tripped_ = tripped_ || !obeys_limits(*found);
    if (tripped_) found.reset();
  } else if (!fresh && mode_ == SlaveMode::kFollowing) {
    mode_ = SlaveMode::kHolding;
  } else if (found) {
    mode_ = SlaveMode::kWaiting;
    found.reset();
  }

  if (mode_ == SlaveMode::kFollowing && found) {
    if (!sample->bridged) acknowledge(index);
    if (seam) source_block_ = 0;
    return follow(*sample, *found);
  }
  ++applied_age_;
  out.applied_tick = -1.0;
  return hold_on();
}

bool SlaveNode::obeys_limits(const Motion& motion) const noexcept {
  const double speed = motion.velocity_m_per_s.norm();
  Vec3 rest_m = motion.position_m;
  if (speed > 0.0) rest_m += (kBridgeS + joiner_.way_to_rest_m(speed) / speed) * motion.velocity_m_per_s;
  return rest_m.head<2>().norm() < model_.workspace.radius_m &&
         std::abs(rest_m.z()) < 0.5 * model_.workspace.height_m && speed < model_.limits.velocity_m_per_s;
}

void SlaveNode::acknowledge(std::int64_t index) noexcept {
  applied_age_ = 0;
  if (index <= applied_index_) return;  // the clock waited: the same sample twice
  const auto shift = index - applied_index_;
  applied_bitmap_ = (shift < 64 ? applied_bitmap_ << shift : 0) | 1U;
  applied_index_ = index;
}

Motion SlaveNode::follow(const StreamSample& sample, const Motion& found) noexcept {
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

Motion SlaveNode::hold_on() noexcept {
  if (mode_ == SlaveMode::kFollowing && !tripped_ && applied_age_ * dt_s_ < kBridgeS) {
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
    hold_ = Motion{.position_m = reference_.position_m};
    source_generation_ = 0;
    rejoin(hold_);
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

  rejoined_ = false;
  const Motion source = choose_source(now_ns, tool, out);
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
      take_up_changes();
      block_tick_ = tick_;
      block_anchor_ = rounded({tool.position_m, tool.velocity_m_per_s});
      laser_mask_ = 0;
    }
    if (out.laser_w > 0.0) laser_mask_ |= std::uint64_t{1} << filled_;
    forces_n_[filled_] = out.force_n;
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
  if (!bytes) {
    out.state.reset();  // a block that cannot be coded is not sent; the next one stands alone
    return;
  }
  block.payload.size = static_cast<std::uint16_t>(*bytes);
  const auto force_bytes = force_encoder_.encode(forces_n_, 0, {}, block.force.room());
  block.force.size = static_cast<std::uint16_t>(force_bytes.value_or(0));
  ++counters_.states;
  counters_.position_bytes += block.payload.size;
  counters_.force_bytes += block.force.size;
}

}  // namespace telekerf::slave
