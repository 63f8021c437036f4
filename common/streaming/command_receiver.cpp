// SPDX-License-Identifier: Apache-2.0
#include "common/streaming/command_receiver.h"

#include <algorithm>
#include <cmath>

#include "common/streaming/reference.h"

namespace telekerf::slave {
namespace {

/// A stamp further ahead than this of what the elapsed time allows is a broken or hostile clock.
constexpr double kFutureS = 1.0;
/// Gaps up to this many samples are bridged where both ends are known.
constexpr int kReach = 400;

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

std::int64_t first_index(const CommandBlock& block) noexcept {
  return static_cast<std::int64_t>(block.first_tick / block.ticks_per_sample);
}

}  // namespace

CommandReceiver::CommandReceiver(const CommandReceiverSettings& settings)
    : settings_(settings), ring_(std::make_unique<JitterBuffer>()), clock_(settings.playout) {}

void CommandReceiver::receive(const Received<CommandBlock>& received,
                              std::optional<std::uint32_t> contour_id) noexcept {
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
      (contour_id && block.contour_id != *contour_id)) {
    ++counters_.refused;
    return;
  }
  const double period_s = block.sample_period_ns * 1e-9;
  if (heard_ && block.sequence <= number_) {
    if (!catch_up(received)) ++counters_.stale;
    return;
  }
  const std::int64_t first = first_index(block);
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
    begin_afresh(block);
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

void CommandReceiver::begin_afresh(const CommandBlock& block) noexcept {
  first_number_ = block.sequence;
  master_epoch_ = block.epoch;
  ring_->clear();
  clock_.reset();
  newest_index_ = -1;
  applied_index_ = -1;
  applied_bitmap_ = 0;
  cursor_.reset();
  ++generation_;
}

bool CommandReceiver::catch_up(const Received<CommandBlock>& received) noexcept {
  const CommandBlock& block = received.value;
  // What was sent before the stream was joined was never counted as lost.
  if (block.sequence < first_number_ || !same_count(block, header_) || !same_source(block, header_))
    return false;
  const std::int64_t first = first_index(block);
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

void CommandReceiver::store(const codec::DecodedPacket& packet, const CommandBlock& block) noexcept {
  const std::int64_t newest = first_index(block);
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
  const auto at_state = [](StreamSample sample, const KinematicState& state) {
    sample.value = state.position_m;
    sample.velocity_m_per_s = state.velocity_m_per_s;
    return sample;
  };
  // The newest block: the accelerations integrated from the anchor are the master's model, bit for bit.
  const KinematicState anchor{block.anchor.position_m, block.anchor.velocity_m_per_s, Vec3::Zero()};
  KinematicState state = anchor;
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

std::optional<KinematicState> CommandReceiver::motion_at(double cursor,
                                                         const KinematicState& tool) const noexcept {
  const double period_s = header_.sample_period_ns * 1e-9;
  if (header_.law == Law::kLocal) return reference_at(*ring_, cursor, period_s);
  // Commands are held from their sample to the next.
  const double whole = std::floor(cursor + 1e-6);
  const StreamSample* sample = ring_->find(static_cast<std::int64_t>(whole));
  if (sample == nullptr || sample->law != header_.law) return std::nullopt;
  if (header_.law == Law::kRemoteAcceleration) {
    return KinematicState{tool.position_m, tool.velocity_m_per_s, sample->acceleration_m_per_s2};
  }
  const KinematicState state{sample->value, sample->velocity_m_per_s, sample->acceleration_m_per_s2};
  return advanced(state, (cursor - whole) * period_s);
}

Played CommandReceiver::play(std::int64_t now_ns, const KinematicState& tool) noexcept {
  Played out;
  // What the play-out waits for stragglers is not silence yet.
  const double silent_s = static_cast<double>(now_ns - last_arrival_ns_) * 1e-9 - clock_.wait_s();
  out.fresh = heard_ && silent_s < settings_.stale_s;
  if (!out.fresh) return out;
  out.cursor = clock_.advance(now_ns, settings_.control_period_ns, starving_);
  if (!out.cursor) return out;
  const double cursor = *out.cursor;
  const double period_s = header_.sample_period_ns * 1e-9;
  out.index = header_.law == Law::kLocal ? std::llround(cursor)
                                         : static_cast<std::int64_t>(std::floor(cursor + 1e-6));
  if (header_.law != Law::kLocal && ring_->find(out.index) == nullptr) {
    bridge_gap(*ring_, out.index, period_s, kReach, settings_.max_acceleration_m_per_s2);
  }
  if (const auto motion = motion_at(cursor, tool)) {
    out.sample = ring_->find(out.index);
    out.motion = *motion;
  }
  starving_ = out.sample == nullptr;
  const double step =
      static_cast<double>(settings_.control_period_ns) / static_cast<double>(header_.sample_period_ns);
  out.seam = !cursor_ || std::abs(cursor - *cursor_ - step) > 1e-3;
  cursor_ = cursor;
  return out;
}

void CommandReceiver::acknowledge(std::int64_t index) noexcept {
  applied_age_ = 0;
  if (index <= applied_index_) return;  // the clock waited: the same sample twice
  const auto shift = index - applied_index_;
  applied_bitmap_ = (shift < 64 ? applied_bitmap_ << shift : 0) | 1U;
  applied_index_ = index;
}

void CommandReceiver::describe(StateBlock& block) const noexcept {
  block.master_epoch = master_epoch_.value_or(0);
  block.beta = header_.beta;
  block.applied_tick = applied_index_ < 0 ? 0 : static_cast<Tick>(applied_index_) * header_.ticks_per_sample;
  block.applied_age_ticks = applied_age_;
  block.applied_bitmap = applied_bitmap_;
  block.playout_ticks = clock_.depth_samples();
  block.echo_sequence = heard_ ? number_ : 0;
  block.echo_sent_ns = header_.sent_ns;
  block.echo_received_ns = last_arrival_ns_;
}

}  // namespace telekerf::slave
