// SPDX-License-Identifier: Apache-2.0
#include "common/streaming/jitter_buffer.h"

#include <algorithm>

namespace telekerf::streaming {
namespace {

/// By how long the block with sample `index` may have begun before the newest one: the samples in between,
/// and what its sender lost meanwhile.
std::optional<std::int64_t> before_newest_ns(const PacketSamples& samples, std::int64_t index,
                                             const CommandHeader& header, const LostTime& lost) noexcept {
  const int age = samples.age(index);
  if (age == 0) return 0;
  const std::int64_t begins = samples.first() - age * samples.size();
  const auto lost_ns = lost.since_ns(begins * header.sample_period_ns);
  if (!lost_ns) return std::nullopt;
  return age * samples.size() * header.sample_period_ns + *lost_ns;
}

StreamSample sample_of(const PacketSamples& samples, std::int64_t index, const CommandHeader& header,
                       std::uint32_t generation, const LostTime& lost) noexcept {
  const int age = samples.age(index);
  const auto before_ns = before_newest_ns(samples, index, header, lost);
  StreamSample sample;
  sample.law = header.law;
  sample.block = header.sequence - static_cast<std::uint32_t>(age);
  sample.button = samples.button(index);
  sample.engaged = age == 0 ? header.engaged : age <= 7 && ((header.engaged_before >> (age - 1)) & 1U) != 0;
  sample.generation = generation;
  sample.engage = header.engage;
  if (LostTime::possible(header.echo_sent_ns) && before_ns) {
    sample.echo_sequence = header.echo_sequence;
    sample.echo_sent_ns = header.echo_sent_ns - *before_ns;
  }
  (header.law == Law::kLocal ? sample.value : sample.acceleration_m_per_s2) = samples.at(index);
  return sample;
}

StreamSample at_state(StreamSample sample, const KinematicState& state) noexcept {
  sample.value = state.position_m;
  sample.velocity_m_per_s = state.velocity_m_per_s;
  return sample;
}

}  // namespace

void JitterBuffer::clear() noexcept {
  for (auto& slot : slots_) slot.index = -1;
}

void JitterBuffer::store(std::int64_t index, const StreamSample& sample) noexcept {
  if (index < 0) return;
  slots_[static_cast<std::size_t>(index) % kSize] = {index, sample};
}

const StreamSample* JitterBuffer::find(std::int64_t index) const noexcept {
  if (index < 0) return nullptr;
  const Slot& slot = slots_[static_cast<std::size_t>(index) % kSize];
  return slot.index == index ? &slot.sample : nullptr;
}

std::optional<std::int64_t> JitterBuffer::first_from(std::int64_t index, std::int64_t newest) const noexcept {
  for (std::int64_t at = std::max(index, newest - static_cast<std::int64_t>(kSize)); at <= newest; ++at)
    if (find(at) != nullptr) return at;
  return std::nullopt;
}

void JitterBuffer::store(const PacketSamples& samples, const CommandHeader& header,
                         std::uint32_t generation) noexcept {
  const double period_s = header.sample_period_ns * 1e-9;
  const auto put = [&](std::int64_t index, const StreamSample& sample) {
    const StreamSample* known = find(index);
    if (known == nullptr || known->concealed) store(index, sample);
  };
  lost_.arrived(header.epoch, samples.last() * header.sample_period_ns, header.sent_ns);
  // The newest block: the accelerations integrated from the anchor are the master's model, bit for bit.
  const KinematicState anchor{header.anchor.position_m, header.anchor.velocity_m_per_s, Vec3::Zero()};
  KinematicState state = anchor;
  for (std::int64_t index = samples.first(); index <= samples.last(); ++index) {
    StreamSample sample = sample_of(samples, index, header, generation, lost_);
    if (header.law == Law::kAnchored) {
      sample = at_state(sample, state);
      state.acceleration_m_per_s2 = sample.acceleration_m_per_s2;
      state = advanced(state, period_s);
    }
    put(index, sample);
  }
  // Copies of older blocks come without their anchors: integrated backwards from the newest one.
  state = anchor;
  for (std::int64_t index = samples.first() - 1; index >= samples.oldest(); --index) {
    StreamSample sample = sample_of(samples, index, header, generation, lost_);
    if (header.law == Law::kAnchored) {
      state = control::preceding(state, sample.acceleration_m_per_s2, period_s);
      sample = at_state(sample, state);
    }
    put(index, sample);
  }
}

}  // namespace telekerf::streaming
