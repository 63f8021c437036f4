// SPDX-License-Identifier: Apache-2.0
#include "master/command_stream.h"

#include <algorithm>

#include "common/protocol/wire_precision.h"

namespace telekerf::master {
namespace {

KinematicState scaled(const KinematicState& state, double factor) {
  return {factor * state.position_m, factor * state.velocity_m_per_s, factor * state.acceleration_m_per_s2};
}

ObserverSettings observer_of(const CommandStreamSettings& settings) {
  ObserverSettings observer = settings.observer;
  observer.period_s = settings.codec.sample_period_ns * 1e-9;
  return observer;
}

/// The slave waits for copies: a loop that spans the delay would lose more by that than by the losses. And
/// single samples have none.
streaming::RedundancySettings redundancy_of(const CommandStreamSettings& settings,
                                            const codec::StreamSettings& codec) {
  const bool predicted = settings.law == Law::kAnchored && settings.observer.estimator == &make_predictor;
  const bool fixed = (settings.law != Law::kLocal && !predicted) || codec.block == 1;
  return {.min = codec.redundancy,
          .max = fixed ? codec.redundancy : std::max(codec.redundancy, settings.max_redundancy)};
}

}  // namespace

CommandStream::CommandStream(const CommandStreamSettings& settings, std::uint32_t epoch)
    : settings_(settings),
      period_s_(settings.codec.sample_period_ns * 1e-9),
      observer_(settings.law, observer_of(settings)),
      engagement_(settings.approach, period_s_),
      packets_({.codec = settings.codec,
                .ticks_per_sample = settings.ticks_per_sample,
                .sample_period_ns = settings.codec.sample_period_ns,
                .epoch = epoch}),
      redundancy_(redundancy_of(settings, settings.codec)) {}

void CommandStream::change(const codec::StreamSettings& codec) {
  packets_.change(codec);
  redundancy_ = streaming::RedundancyControl(redundancy_of(settings_, codec));
}

void CommandStream::received(const streaming::Feedback& feedback) noexcept {
  if (feedback.kind == streaming::Arrival::Kind::kRefused) return;
  bursts_.received(feedback.number, feedback.begins);
  engagement_.received(feedback.samples, feedback.ours);
  if (!feedback.ours) return;
  observer_.correct(feedback.samples);
  gaps_.received(feedback.samples, engaged_from_);
}

void CommandStream::place_model(std::int64_t index, Engagement::Phase phase, bool rescaled,
                                const KinematicState& source) noexcept {
  switch (phase) {
    case Engagement::Phase::kApart:
      // The slave rests; so does the model, where the slave was last seen.
      model_ = KinematicState{.position_m = engagement_.slave_m().value_or(source.position_m)};
      observer_.reset(index, model_);
      break;
    case Engagement::Phase::kBegins:
      model_ = KinematicState{.position_m = *engagement_.slave_m() + settings_.wrong_position_m,
                              .velocity_m_per_s = settings_.wrong_velocity_m_per_s};
      observer_.reset(index, model_);
      engagement_.approach(model_, source);
      engaged_from_ = index;
      break;
    case Engagement::Phase::kHolds:
      if (rescaled) engagement_.approach(observer_.predicted_state(model_), source);
      break;
  }
  model_.position_m += observer_.take_correction_m();
}

void CommandStream::begin_block(std::int64_t index, const MasterSample& master) noexcept {
  const bool rescaled = master.beta != beta_;
  beta_ = master.beta;
  if (rescaled || master.engage != engage_) engagement_.forget_blocks();
  engage_ = master.engage;
  echo_sequence_ = master.echo_sequence;
  echo_sent_ns_ = master.echo_sent_ns;
  const KinematicState source = scaled(master.tool, beta_);
  if (!streams_accelerations(settings_.law)) {
    const auto phase = engagement_.begin_block_unaided(master.engaged);
    if (phase == Engagement::Phase::kBegins) {
      observer_.reset(index, source);
      engaged_from_ = index;
    }
    packets_.begin(index, to_wire_precision(Anchor{source.position_m, source.velocity_m_per_s}));
    return;
  }
  place_model(index, engagement_.begin_block(index, master.engaged), rescaled, source);
  const bool anchored = settings_.law == Law::kAnchored;
  const KinematicState carried = anchored ? model_ : observer_.predicted_state(model_);
  const Anchor anchor = to_wire_precision(Anchor{carried.position_m, carried.velocity_m_per_s});
  if (anchored) {
    model_.position_m = anchor.position_m;
    model_.velocity_m_per_s = anchor.velocity_m_per_s;
  }
  block_model_ = model_;
  packets_.begin(index, anchor);
}

Vec3 CommandStream::command(const KinematicState& source) noexcept {
  if (!engagement_.engaged()) return Vec3::Zero();
  const KinematicState goal = engagement_.goal(source, observed_.slave);
  observed_.aligned = engagement_.aligned();
  const double w = law_bandwidth(settings_, std::max(observer_.delay_s(), period_s_));
  return commanded_acceleration(settings_, w, goal, observed_.slave, observer_.disturbance_m_per_s2());
}

std::optional<CommandBlock> CommandStream::step(std::int64_t now_ns, Tick tick,
                                                const MasterSample& master) noexcept {
  const auto between = static_cast<int>(tick % static_cast<Tick>(settings_.ticks_per_sample));
  if (between != 0) {
    observed_.slave = advanced(commanded_, period_s_ * between / settings_.ticks_per_sample);
    return std::nullopt;
  }
  const auto index = static_cast<std::int64_t>(tick / static_cast<Tick>(settings_.ticks_per_sample));
  if (next_index_ >= 0 && index != next_index_) {
    // Samples were left out (the robot had no pose): what is filled and the copies do not lead up to this
    // one.
    packets_.abandon();
    engagement_.forget_blocks();
  }
  next_index_ = index + 1;
  if (packets_.at_beginning()) begin_block(index, master);

  const KinematicState source = scaled(master.tool, beta_);
  const bool accelerations = streams_accelerations(settings_.law);
  if (!accelerations) model_ = source;
  observed_.slave = observer_.predicted_state(model_);
  observed_.aligned = !accelerations && engagement_.engaged();
  const Vec3 u = accelerations ? command(source) : source.acceleration_m_per_s2;
  commanded_ = observed_.slave;
  commanded_.acceleration_m_per_s2 = u;
  observer_.predict(index, model_, u);
  model_.acceleration_m_per_s2 = u;
  model_ = advanced(model_, period_s_);
  observed_.disturbance_m_per_s2 = observer_.disturbance_m_per_s2();
  observed_.innovation_m = observer_.innovation_m();
  observed_.delay_s = observer_.delay_s();

  const double error_m = (observed_.slave.position_m - source.position_m).norm();
  const bool button =
      master.button && engagement_.engaged() && observed_.aligned && error_m < settings_.max_button_error_m;
  if (!packets_.add(accelerations ? u : source.position_m, button)) return std::nullopt;
  return finish_block(now_ns, master);
}

std::optional<CommandBlock> CommandStream::finish_block(std::int64_t now_ns,
                                                        const MasterSample& master) noexcept {
  std::optional<CommandBlock> out;
  CommandBlock& block = out.emplace();
  block.contour_id = master.contour_id;
  block.beta = to_wire_precision(beta_);
  block.law = settings_.law;
  block.engaged = engagement_.engaged() && master.engaged && master.engage == engage_;
  block.engage = engage_;
  block.stop = master.stop;
  block.echo_sequence = echo_sequence_;
  block.echo_sent_ns = echo_sent_ns_;
  block.engaged_before = engagement_.engaged_before();
  engagement_.finish_block(block.engaged);
  block.button = packets_.buttons();
  packets_.repeat(redundancy_.step(
      {gaps_.take(), bursts_.take()},
      {packets_.index(), packets_.block(), static_cast<double>(packets_.block()) * period_s_}));
  if (!packets_.pack(now_ns, block)) return std::nullopt;
  if (streams_accelerations(settings_.law)) {
    model_ = observer_.revise(packets_.index(), block_model_, packets_.decoded());
  }
  return out;
}

}  // namespace telekerf::master
