// SPDX-License-Identifier: Apache-2.0
#include "common/streaming/command_receiver.h"

#include <cmath>
#include <limits>

#include "common/streaming/concealment.h"
#include "common/streaming/reference.h"

namespace telekerf::streaming {
namespace {

/// Gaps up to this many samples are concealed where both ends are known.
constexpr int kReach = 720;

/// A step that comes later than this was no late step: the process was asleep, and what queued up meanwhile
/// says nothing about the link.
constexpr std::int64_t kAsleep_ns = 100'000'000;

/// Of the slave's largest acceleration: between two samples the step onto a concealed one takes up to twice
/// its own.
constexpr double kShareOfConcealed = 0.5;

/// Samples that are late by no more than this leave a gap; for those that are later time stands, and for long
/// enough that the tool is back where it was led last.
constexpr double kBrief_s = 0.03;
constexpr double kBack_s = 0.08;

/// Of the age at which the play-out hurries, that which is enough.
constexpr double kYoung = 0.8;

/// Commands are held from their sample to the next.
std::int64_t held_sample(double cursor) noexcept {
  return static_cast<std::int64_t>(std::floor(cursor + 1e-6));
}

}  // namespace

CommandReceiver::CommandReceiver(const CommandReceiverSettings& settings)
    : settings_(settings),
      stream_(settings.timeout_s),
      buffer_(std::make_unique<JitterBuffer>()),
      clock_(settings.playout) {}

void CommandReceiver::receive(const Received<CommandBlock>& received, std::optional<std::uint32_t> contour_id,
                              std::int64_t now_ns) noexcept {
  const std::int64_t useful_from =
      cursor_ ? static_cast<std::int64_t>(std::ceil(*cursor_)) : std::numeric_limits<std::int64_t>::min();
  const CommandHeader& header = received.value;
  const bool answers = echoes_.age_s(header.echo_sequence, header.echo_sent_ns, now_ns).has_value();
  const Arrival arrival = stream_.receive(received, useful_from, contour_id, answers);
  if (arrival.packet == nullptr) return;
  if (arrival.begins) {
    buffer_->clear();
    clock_.reset();
    cursor_.reset();
    begins_ = true;
  }
  const PacketSamples samples(*arrival.packet, arrival.first);
  buffer_->store(samples, header, stream_.generation());
  if (asleep(now_ns)) {  // of a queue, the newest alone counts
    clock_.reset();
  } else {
    keep_time(now_ns);
  }
  clock_.arrived({.now_ns = received.received_ns,
                  .sent_ns = header.sent_ns,
                  .last = samples.last(),
                  .count = static_cast<int>(samples.size()),
                  .sample_period_ns = header.sample_period_ns,
                  .copies = arrival.packet->head.redundancy,
                  .lookahead = header.law == Law::kLocal ? kHalfWindow : 0,
                  .lost = arrival.missing > 0,
                  .placed = header.law != Law::kRemoteAcceleration});
}

bool CommandReceiver::asleep(std::int64_t now_ns) const noexcept {
  return now_ns - played_ns_.value_or(now_ns) > settings_.control_period_ns + kAsleep_ns;
}

void CommandReceiver::keep_time(std::int64_t now_ns) noexcept {
  const std::int64_t lost_ns = now_ns - played_ns_.value_or(now_ns) - settings_.control_period_ns;
  if (lost_ns < settings_.control_period_ns) return;
  clock_.overslept(lost_ns);
  *played_ns_ += lost_ns;
}

std::optional<KinematicState> CommandReceiver::state_at(double cursor,
                                                        const KinematicState& tool) const noexcept {
  const double period_s = header().sample_period_ns * 1e-9;
  if (header().law == Law::kLocal) return reference_at(*buffer_, cursor, period_s);
  const std::int64_t index = held_sample(cursor);
  const StreamSample* sample = buffer_->find(index);
  if (sample == nullptr || sample->law != header().law) return std::nullopt;
  if (header().law == Law::kRemoteAcceleration) {
    return KinematicState{tool.position_m, tool.velocity_m_per_s, sample->acceleration_m_per_s2};
  }
  const KinematicState state{sample->value, sample->velocity_m_per_s, sample->acceleration_m_per_s2};
  return advanced(state, (cursor - static_cast<double>(index)) * period_s);
}

Played CommandReceiver::play(std::int64_t now_ns, const KinematicState& tool) noexcept {
  keep_time(now_ns);
  played_ns_ = now_ns;
  Played out;
  out.begins = begins_;
  begins_ = false;
  // What the play-out waits for stragglers is not silence yet.
  out.fresh = heard() && stream_.silent_s(now_ns) - clock_.wait_s() < settings_.timeout_s;
  if (!out.fresh) return out;
  out.cursor = clock_.advance(now_ns, settings_.control_period_ns);
  if (!out.cursor) return out;
  const double cursor = *out.cursor;
  out.tick = cursor * header().ticks_per_sample;
  const double period_s = header().sample_period_ns * 1e-9;
  const bool local = header().law == Law::kLocal;
  out.index = local ? std::llround(cursor) : held_sample(cursor);
  if (!local && buffer_->find(out.index) == nullptr) {
    conceal_gap(*buffer_, out.index, period_s, kReach,
                kShareOfConcealed * settings_.max_acceleration_m_per_s2);
  }
  wait_for(buffer_->find(out.index) == nullptr, out);
  if (const auto state = state_at(cursor, tool); state && !out.waits) {
    out.sample = buffer_->find(out.index);
    out.state = *state;
    if (out.sample != nullptr)
      out.age_s = echoes_.age_s(out.sample->echo_sequence, out.sample->echo_sent_ns, now_ns);
  }
  if (out.age_s && *out.age_s > settings_.beam_age_s) clock_.hurry(true);
  if (out.age_s && *out.age_s < kYoung * settings_.beam_age_s) clock_.hurry(false);
  out.discontinuity = !cursor_ || !clock_.went_on();
  keep_pace(out);
  cursor_ = out.cursor;
  return out;
}

void CommandReceiver::wait_for(bool missing, Played& out) noexcept {
  if (!clock_.went_on()) next_.reset();                  // given up, or begun anew
  if (header().law == Law::kRemoteAcceleration) return;  // what has no place cannot be gone on from
  const bool stands = pace_ == 0.0;
  if (missing || stands) missing_s_ += 1e-9 * static_cast<double>(settings_.control_period_ns);
  if (next_ && missing_s_ > kBrief_s) {
    // What is there after what could not be bridged is gone on from, at once or when it is due.
    const auto more = buffer_->first_from(*next_, stream_.newest());
    out.waits =
        stands ? missing || missing_s_ < kBrief_s + kBack_s : missing && more.value_or(*next_) <= out.index;
    if (out.waits) out.cursor = clock_.stand(static_cast<double>(more.value_or(*next_)));
  }
  if (missing || out.waits) return;
  next_ = out.index + 1;
  missing_s_ = 0.0;
}

void CommandReceiver::keep_pace(Played& out) noexcept {
  if (header().law == Law::kRemoteAcceleration) return;
  const double before = pace_;
  pace_ = out.waits ? 0.0 : 1.0;
  if (out.discontinuity || out.waits) return;
  const double step_s = 1e-9 * static_cast<double>(settings_.control_period_ns);
  pace_ = (*out.cursor - *cursor_) * 1e-9 * header().sample_period_ns / step_s;
  out.state.acceleration_m_per_s2 = pace_ * pace_ * out.state.acceleration_m_per_s2 +
                                    (pace_ - before) / step_s * out.state.velocity_m_per_s;
  out.state.velocity_m_per_s *= pace_;
}

void CommandReceiver::describe(const Acknowledgement& acknowledgement, StateHeader& out) const noexcept {
  write(acknowledgement, header().ticks_per_sample, out);
  out.master_epoch = header().epoch;
  out.beta = header().beta;
  out.playout_ticks = clock_.depth_samples();
  out.echo_sequence = heard() ? header().sequence : 0;
  out.echo_sent_ns = header().sent_ns;
  out.echo_received_ns = stream_.arrived_ns() - stream_.arrived_ns() % 1000;
}

}  // namespace telekerf::streaming
