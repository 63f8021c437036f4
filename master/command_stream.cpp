// SPDX-License-Identifier: Apache-2.0
#include "master/command_stream.h"

#include <algorithm>
#include <cmath>

#include "common/protocol/wire_precision.h"

namespace telekerf::master {
namespace {

constexpr double kJoinedM = 20e-6;
/// A slave that has heeded no command for this long is let go for that long.
constexpr double kUnheededS = 0.3;
constexpr double kLetGoS = 0.2;
/// Further from the goal than this, the slave is approached anew instead of pulled with all force.
constexpr double kLostM = 2e-3;

KinematicState scaled(const KinematicState& motion, double factor) {
  return {factor * motion.position_m, factor * motion.velocity_m_per_s,
          factor * motion.acceleration_m_per_s2};
}

/// Velocity at sample n of a block: differences, one-sided of second order at the ends.
Vec3 velocity_at(std::span<const Vec3> p, std::size_t n, double period_s, const Vec3& otherwise) {
  const std::size_t last = p.size() - 1;
  if (last < 2) return otherwise;
  if (n == 0) return (-1.5 * p[0] + 2.0 * p[1] - 0.5 * p[2]) / period_s;
  if (n == last) return (1.5 * p[last] - 2.0 * p[last - 1] + 0.5 * p[last - 2]) / period_s;
  return (p[n + 1] - p[n - 1]) / (2.0 * period_s);
}

}  // namespace

CommandStream::CommandStream(const CommandStreamSettings& settings, std::uint32_t epoch)
    : settings_(settings),
      epoch_(epoch),
      period_s_(settings.codec.sample_period_ns * 1e-9),
      encoder_(settings.codec),
      observer_(settings.law,
                [&] {
                  ObserverSettings observer = settings.observer;
                  observer.period_s = settings.codec.sample_period_ns * 1e-9;
                  return observer;
                }()),
      samples_(codec::kMaxBlock, Vec3::Zero()),
      approach_(settings.approach) {
  samples_.resize(static_cast<std::size_t>(settings.codec.block));
  arrived_.reserve(static_cast<std::size_t>(codec::kMaxBlocks) * 64);
}

void CommandStream::received(const StateBlock& state) noexcept {
  if (state.epoch != slave_epoch_) {
    slave_epoch_ = state.epoch;
    state_number_ = 0;
    slave_index_ = -1;
    decoder_.reset();
  }
  if (state.sequence <= state_number_ || state.sample_period_ns == 0 || state.ticks_per_sample == 0) return;
  if (state.sample_period_ns != state_period_ns_ || state.ticks_per_sample != state_ticks_) {
    state_period_ns_ = state.sample_period_ns;
    state_ticks_ = state.ticks_per_sample;
    slave_index_ = -1;
  }
  const double period_s = state.sample_period_ns * 1e-9;
  const auto decoded = decoder_.decode(state.payload.view(),
                                       {state.anchor.position_m, state.anchor.velocity_m_per_s * period_s});
  if (!decoded) return;
  state_number_ = state.sequence;
  const codec::DecodedPacket& packet = **decoded;
  const auto first = static_cast<std::int64_t>(state.first_tick / state.ticks_per_sample);
  const auto applied =
      static_cast<std::int64_t>(state.applied_tick) / static_cast<std::int64_t>(settings_.ticks_per_sample);
  const auto age = static_cast<std::int64_t>(state.applied_age_ticks / state.ticks_per_sample);
  const std::int64_t last = first + packet.block_size - 1;
  const bool ours = state.master_epoch == epoch_;
  arrived_.clear();
  for (int b = packet.blocks - 1; b >= 0; --b) {
    const auto& part = packet.blocks_newest_first[static_cast<std::size_t>(b)];
    for (int n = 0; n < packet.block_size; ++n) {
      const std::int64_t slave_index = first - static_cast<std::int64_t>(b) * packet.block_size + n;
      if (slave_index <= slave_index_ || arrived_.size() == arrived_.capacity()) continue;
      slave_index_ = slave_index;
      const auto at = static_cast<std::size_t>(n);
      SlaveSample sample;
      sample.position_m = part.samples[at];
      sample.velocity_m_per_s = velocity_at(part.samples, at, period_s, state.anchor.velocity_m_per_s);
      // Before the newest applied one, one sample back is one index back; after it nothing was applied.
      const std::int64_t back = last - slave_index;
      sample.index = applied + age - back;
      sample.time = slave_index;
      const std::int64_t bit = back - age;
      sample.applied = ours && bit >= 0 && (bit >= 64 || ((state.applied_bitmap >> bit) & 1U) != 0);
      slave_at_m_ = sample.position_m;
      if (!ours) continue;
      arrived_.push_back(sample);
      if (sample.applied) {
        unheeded_ = 0;
      } else if (sample.index > engaged_index_) {
        ++unheeded_;
      }
    }
  }
  observer_.measured(arrived_);
}

void CommandStream::change(const codec::StreamSettings& codec) {
  next_codec_ = codec.validated();
  next_codec_->sample_period_ns = settings_.codec.sample_period_ns;
  next_codec_->anchored = settings_.codec.anchored;
}

/// A loop of bandwidth w closed across the delay D bears an error t of the assumed timing while
/// t (2 w + w^2 D) < 1 (observer.md's mismatch rule); designed to half of it.
double CommandStream::bandwidth() const noexcept {
  if (settings_.law != Law::kRemoteAcceleration) return settings_.tracking_rad_s;
  const double delay_s = std::max(observer_.delay_s(), period_s_);
  const double w = (std::sqrt(1.0 + 0.5 * delay_s / settings_.timing_error_s) - 1.0) / delay_s;
  return std::min(settings_.tracking_rad_s, w);
}

Vec3 CommandStream::command(const KinematicState& goal) const noexcept {
  // Eq. 96 in operational space and with eq. 79's scaling corrected: eps = beta x_m - x_s.
  const double w = bandwidth();
  Vec3 u = goal.acceleration_m_per_s2 + 2.0 * w * (goal.velocity_m_per_s - observed_.slave.velocity_m_per_s) +
           w * w * (goal.position_m - observed_.slave.position_m) - observer_.disturbance_m_per_s2();
  const double size = u.norm();
  if (!(size <= settings_.max_acceleration_m_per_s2)) {
    u = std::isfinite(size) ? Vec3(u * (settings_.max_acceleration_m_per_s2 / size)) : Vec3::Zero();
  }
  return u;
}

void CommandStream::begin_block(std::int64_t index, const MasterMotion& master) noexcept {
  block_index_ = index;
  buttons_ = 0;
  if (next_codec_) {
    settings_.codec = *next_codec_;
    encoder_.change(settings_.codec);
    samples_.resize(static_cast<std::size_t>(settings_.codec.block));
    next_codec_.reset();
  }
  const bool rescaled = master.beta != beta_;
  beta_ = master.beta;
  if (rescaled) engaged_before_ = 0;
  const KinematicState source = scaled(master.tool, beta_);
  if (settings_.law == Law::kLocal) {
    if (master.engaged && !engaged_) observer_.begin(index, source);
    engaged_ = master.engaged;
    anchor_ = to_wire_precision(Anchor{source.position_m, source.velocity_m_per_s});
    return;
  }
  if (engaged_ && unheeded_ * period_s_ > kUnheededS) {
    // It holds, for it was led astray or cut off: let go, and take hold of it again where it rests.
    resume_index_ = index + static_cast<std::int64_t>(kLetGoS / period_s_);
    unheeded_ = 0;
  }
  const bool follow = master.engaged && slave_at_m_.has_value() && index >= resume_index_;
  if (!follow) {
    // The slave rests; so does the model, where the slave was last seen.
    model_ = KinematicState{.position_m = slave_at_m_.value_or(source.position_m)};
    observer_.begin(index, model_);
  } else if (!engaged_) {
    model_ = KinematicState{.position_m = *slave_at_m_ + settings_.wrong_position_m,
                            .velocity_m_per_s = settings_.wrong_velocity_m_per_s};
    observer_.begin(index, model_);
    engaged_index_ = index;
    unheeded_ = 0;
    approach_.rejoin(model_, source);
    seated_ = true;
  } else if (rescaled) {
    approach_.rejoin(observer_.prediction(model_), source);
    seated_ = true;
  }
  engaged_ = follow;
  model_.position_m += observer_.take_correction();
  const KinematicState carried = settings_.law == Law::kAnchored ? model_ : observer_.prediction(model_);
  anchor_ = to_wire_precision(Anchor{carried.position_m, carried.velocity_m_per_s});
  if (settings_.law == Law::kAnchored) {
    model_.position_m = anchor_.position_m;
    model_.velocity_m_per_s = anchor_.velocity_m_per_s;
  }
  block_model_ = model_;
}

std::optional<CommandBlock> CommandStream::step(std::int64_t now_ns, Tick tick,
                                                const MasterMotion& master) noexcept {
  const auto between = static_cast<int>(tick % static_cast<Tick>(settings_.ticks_per_sample));
  if (between != 0) {
    observed_.slave = advanced(commanded_, period_s_ * between / settings_.ticks_per_sample);
    return std::nullopt;
  }
  const auto index = static_cast<std::int64_t>(tick / static_cast<Tick>(settings_.ticks_per_sample));
  if (filled_ == 0) begin_block(index, master);

  const KinematicState source = scaled(master.tool, beta_);
  Vec3 u = Vec3::Zero();
  if (settings_.law == Law::kLocal) {
    model_ = source;
    u = source.acceleration_m_per_s2;
    samples_[filled_] = source.position_m;
    observed_.slave = observer_.prediction(model_);
    observed_.joined = engaged_;
  } else {
    observed_.slave = observer_.prediction(model_);
    observed_.joined = false;
    if (engaged_) {
      KinematicState goal = approach_.join(source, seated_ ? 0.0 : period_s_);
      seated_ = false;
      if (!((goal.position_m - observed_.slave.position_m).norm() < kLostM)) {
        approach_.rejoin(observed_.slave, source);
        goal = approach_.join(source, 0.0);
      }
      u = command(goal);
      observed_.joined = approach_.offset_m() < kJoinedM;
    }
    samples_[filled_] = u;
  }
  commanded_ = observed_.slave;
  commanded_.acceleration_m_per_s2 = u;
  observer_.sent(index, model_, u);
  model_.acceleration_m_per_s2 = u;
  model_ = advanced(model_, period_s_);
  observed_.disturbance_m_per_s2 = observer_.disturbance_m_per_s2();
  observed_.innovation_m = observer_.innovation_m();
  observed_.delay_s = observer_.delay_s();

  if (master.button && engaged_ && observed_.joined) buttons_ |= std::uint64_t{1} << filled_;
  if (++filled_ < samples_.size()) return std::nullopt;
  filled_ = 0;
  return finish_block(now_ns, master);
}

std::optional<CommandBlock> CommandStream::finish_block(std::int64_t now_ns,
                                                        const MasterMotion& master) noexcept {
  std::optional<CommandBlock> out;
  CommandBlock& block = out.emplace();
  block.sequence = ++number_;
  block.epoch = epoch_;
  block.first_tick = static_cast<Tick>(block_index_) * static_cast<Tick>(settings_.ticks_per_sample);
  block.sample_period_ns = settings_.codec.sample_period_ns;
  block.ticks_per_sample = static_cast<std::uint16_t>(settings_.ticks_per_sample);
  block.contour_id = master.contour_id;
  block.beta = to_wire_precision(beta_);
  block.law = settings_.law;
  block.engaged = engaged_ && master.engaged;
  block.engaged_before = engaged_before_;
  engaged_before_ = static_cast<std::uint8_t>((engaged_before_ << 1U) | (block.engaged ? 1U : 0U)) & 0x7FU;
  block.button = buttons_;
  block.anchor = anchor_;
  block.sent_ns = now_ns;
  codec::Trend trend;
  if (settings_.codec.anchored) {
    trend = {anchor_.position_m, anchor_.velocity_m_per_s * period_s_};
  }
  const auto bytes = encoder_.encode(samples_, buttons_, trend, block.payload.room());
  if (!bytes) return std::nullopt;  // not sent; the next block stands alone
  block.payload.size = static_cast<std::uint16_t>(*bytes);
  if (settings_.law != Law::kLocal) {
    model_ = observer_.coded(block_index_, block_model_, encoder_.decoded());
  }
  return out;
}

}  // namespace telekerf::master
