// SPDX-License-Identifier: Apache-2.0
#include "netem/core/emulator.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "netem/core/decay.h"

namespace telekerf::netem {
namespace {

constexpr int kMaxRetransmissions = 6;  // then it gets through: a TCP connection that lives loses nothing
constexpr std::int64_t kLongAgo = std::numeric_limits<std::int64_t>::min() / 4;

/// Uniform in [0, range), by multiplication instead of division.
std::uint64_t uniform_below(std::uint64_t word, std::uint64_t range) noexcept {
  return static_cast<std::uint64_t>((static_cast<unsigned __int128>(word) * range) >> 64);
}

}  // namespace

Emulator::Emulator(const DirectionProfile& profile, const StreamKey& key, Capacity capacity,
                   std::int64_t origin_ns)
    : profile_(profile),
      normal_(NormalTable::instance()),
      delay_(key, Impairment::kDelay),
      loss_(key, Impairment::kLoss),
      loss_state_(key, Impairment::kLossState),
      retransmission_(key, Impairment::kRetransmission),
      duplicate_(key, Impairment::kDuplicate),
      corrupt_(key, Impairment::kCorrupt),
      corrupted_bit_(key, Impairment::kCorruptedBit),
      reorder_(key, Impairment::kReorder),
      event_delay_(key, Impairment::kEventDelay),
      event_loss_(key, Impairment::kEventLoss),
      slot_(key, Impairment::kSlot),
      coupled_delay_({key.seed, key.flow, Direction::kForward}, Impairment::kCoupledDelay),
      flight_(capacity),
      origin_ns_(origin_ns),
      now_ns_(kLongAgo),
      backlog_ns_(kLongAgo),
      last_due_ns_(kLongAgo) {}

PacketOutcome Emulator::push(std::int64_t now_ns, std::span<const std::byte> packet,
                             std::uint64_t tag) noexcept {
  return push(now_ns, packet, static_cast<std::uint32_t>(packet.size()), tag);
}

PacketOutcome Emulator::push(std::int64_t now_ns, std::uint32_t size_bytes, std::uint64_t tag) noexcept {
  return push(now_ns, {}, size_bytes, tag);
}

PacketOutcome Emulator::push(std::int64_t now_ns, std::span<const std::byte> packet, std::uint32_t size,
                             std::uint64_t tag) noexcept {
  const std::int64_t before_ns = now_ns_;
  now_ns = now_ns_ = std::max(now_ns, now_ns_);
  const std::uint64_t index = index_++;
  ++counters_.pushed;
  if (profile_.recording && !profile_.loss_only) {
    PacketOutcome outcome = replay(now_ns);
    keep(outcome, now_ns, packet, size, tag, index);
    return outcome;
  }

  const CompiledProfile::Stage& stage = stage_at(now_ns - origin_ns_);
  PacketOutcome outcome;
  // The states of loss and delay advance with every packet, whatever else befalls it.
  const RecordedOutcome* const of_trace = profile_.recording ? recorded(now_ns - origin_ns_) : nullptr;
  outcome.after_trace = stage.loss_from_trace && of_trace == nullptr;
  outcome.lost_by_model = lose(stage, index, now_ns - before_ns, of_trace);
  outcome.drawn_ns = law_delay(stage, index, now_ns - before_ns);
  const std::int64_t leaves_ns = pass_bottleneck(stage, now_ns, size, outcome);
  if (!profile_.events.empty()) meet_events(leaves_ns - origin_ns_, index, outcome);

  std::int64_t due_ns = leaves_ns + outcome.drawn_ns + outcome.event_ns;
  if (stage.tcp_like && !outcome.queue_full && !outcome.after_trace)
    due_ns += retransmit(stage, leaves_ns - origin_ns_, index, outcome);
  if (outcome.lost()) {
    ++(outcome.queue_full    ? counters_.queue_full
       : outcome.after_trace ? counters_.after_trace
                             : counters_.lost);
    return outcome;
  }

  if (stage.order == Order::kReorder && stage.reorder.happens(reorder_.draw(index))) {
    const std::int64_t earlier_ns = overtake(stage, now_ns, outcome);
    if (outcome.reordered) due_ns = earlier_ns;
  }
  if (stage.order != Order::kFree && !outcome.reordered) {
    due_ns = std::max(due_ns, last_due_ns_);
    if (stage.slot_ns > 0) due_ns = next_slot(stage, due_ns, size);
    recent_due_ns_[in_order_++ % kMaxReorderGap] = due_ns;
  }
  outcome.due_ns = due_ns;
  outcome.duplicated = stage.duplicate.possible() && stage.duplicate.happens(duplicate_.draw(index));
  outcome.corrupted = stage.corrupt.possible() && stage.corrupt.happens(corrupt_.draw(2 * index));
  keep(outcome, now_ns, packet, size, tag, index);
  return outcome;
}

const CompiledProfile::Stage& Emulator::stage_at(std::int64_t since_ns) noexcept {
  while (stage_ + 1 < profile_.stages.size() && since_ns >= profile_.stages[stage_ + 1].from_ns) ++stage_;
  return profile_.stages[stage_];
}

bool Emulator::lose(const CompiledProfile::Stage& stage, std::uint64_t index, std::int64_t pause_ns,
                    const RecordedOutcome* recorded) noexcept {
  if (stage.loss_from_trace) return recorded != nullptr && recorded->lost;
  if (!stage.lossy) return false;
  if (stage.burst_memory_ns > 0) {
    const double left = state_ < 0 ? 0.0 : decay(static_cast<double>(pause_ns), stage.burst_memory_ns);
    const double share = stage.mean_loss;
    const Probability bad(state_ == 1 ? share + (1.0 - share) * left : share * (1.0 - left));
    state_ = bad.happens(loss_state_.draw(index)) ? 1 : 0;
    return state_ == 1;
  }
  int next = 0;
  if (stage.has_states) {
    const auto& up_to = state_ < 0 ? stage.first_state : stage.loss[state_].up_to;
    const std::uint64_t word = loss_state_.draw(index);
    for (const Probability& bound : up_to) next += bound.happens(word) ? 0 : 1;
  }
  state_ = next;
  return stage.loss[next].lost.happens(loss_.draw(index));
}

std::int64_t Emulator::law_delay(const CompiledProfile::Stage& stage, std::uint64_t index,
                                 std::int64_t pause_ns) noexcept {
  if (stage.constant) return stage.constant_ns;
  const double fresh = normal_.at(delay_.draw(index));
  const double left = has_score_ && stage.correlation_ns > 0
                          ? decay(static_cast<double>(pause_ns), stage.correlation_ns)
                          : 0.0;
  score_ = left * score_ + std::sqrt(1.0 - left * left) * fresh;
  has_score_ = true;
  return stage.delay->at(score_);
}

void Emulator::serve_until(std::int64_t now_ns) noexcept {
  constexpr double kRounding_bytes = 1e-6;
  if (backlog_bytes_ > 0) {
    backlog_bytes_ -= profile_.bottleneck.served_bytes(backlog_ns_ - origin_ns_, now_ns - origin_ns_);
    if (backlog_bytes_ < kRounding_bytes) backlog_bytes_ = 0.0;
  }
  backlog_ns_ = now_ns;
}

std::int64_t Emulator::pass_bottleneck(const CompiledProfile::Stage& stage, std::int64_t now_ns,
                                       std::uint32_t size, PacketOutcome& outcome) noexcept {
  const Bottleneck& bottleneck = profile_.bottleneck;
  const std::int64_t since_ns = now_ns - origin_ns_;
  if (!bottleneck.limits_at(since_ns)) {
    backlog_bytes_ = 0.0;
    return now_ns;
  }
  serve_until(now_ns);
  // The packet on the wire is not in the queue: an idle bottleneck takes any packet.
  constexpr double kRounding_bytes = 1e-3;
  outcome.queue_full = backlog_bytes_ > 0 && backlog_bytes_ + size > stage.queue_bytes + kRounding_bytes;
  if (outcome.queue_full) return now_ns;
  const std::int64_t leaves_ns = bottleneck.served_at(since_ns, backlog_bytes_ + size);
  outcome.after_trace = outcome.after_trace || leaves_ns == Bottleneck::kNever;
  if (leaves_ns == Bottleneck::kNever) return now_ns;
  backlog_bytes_ += size;
  entered_bytes_ += size;
  outcome.queued_ns = leaves_ns - since_ns;
  return origin_ns_ + leaves_ns;
}

void Emulator::retime_queue(const Bottleneck& fresh, std::int64_t now_ns) noexcept {
  serve_until(now_ns);
  if (backlog_bytes_ == 0) return;
  const auto latest_ns = flight_.reschedule([&](std::int64_t due_ns, std::uint64_t place) {
    const double waits_bytes = backlog_bytes_ - static_cast<double>(entered_bytes_ - place);
    const std::int64_t after_ns = fresh.served_at(0, waits_bytes);
    if (waits_bytes <= 0 || after_ns == Bottleneck::kNever) return due_ns;
    const std::int64_t since_ns = now_ns - origin_ns_;
    return due_ns + after_ns - (profile_.bottleneck.served_at(since_ns, waits_bytes) - since_ns);
  });
  last_due_ns_ = latest_ns.value_or(last_due_ns_);
  in_order_ = 0;  // the due times of what can be overtaken are others now
}

void Emulator::meet_events(std::int64_t since_ns, std::uint64_t index, PacketOutcome& outcome) noexcept {
  for (std::size_t i = 0; i < profile_.events.size(); ++i) {
    const CompiledProfile::Event& event = profile_.events[i];
    CompiledProfile::Window& window = windows_[i];
    if (since_ns < window.from_ns || since_ns >= window.until_ns) window = event.window(since_ns);
    const std::int64_t occurrence = window.occurrence;
    if (occurrence < 0) continue;
    const auto number = static_cast<std::uint64_t>(occurrence);
    const std::uint64_t word = event.coupling != 0 ? coupled_delay_.draw(event.coupling + number)
                                                   : event_delay_.draw(number * kMaxEvents + i);
    outcome.event_ns +=
        event.hold
            ? window.until_ns - since_ns
            : event.add_min_ns + static_cast<std::int64_t>(uniform_below(word, event.add_range_ns + 1));
    if (event.lost.possible() && event.lost.happens(event_loss_.draw(index * kMaxEvents + i))) {
      outcome.lost_by_event = true;
    }
  }
}

bool Emulator::lost_again(const CompiledProfile::Stage& stage, std::int64_t since_ns,
                          std::uint64_t counter) const noexcept {
  if (stage.retransmission_lost.happens(retransmission_.draw(counter * (kMaxEvents + 1)))) return true;
  for (std::size_t i = 0; i < profile_.events.size(); ++i) {
    const CompiledProfile::Event& event = profile_.events[i];
    const std::uint64_t word = retransmission_.draw(counter * (kMaxEvents + 1) + 1 + i);
    if (event.lost.possible() && event.window(since_ns).occurrence >= 0 && event.lost.happens(word))
      return true;
  }
  return false;
}

/// The wait that a loss becomes: rto, then twice as long for every further attempt that is lost.
std::int64_t Emulator::retransmit(const CompiledProfile::Stage& stage, std::int64_t since_ns,
                                  std::uint64_t index, PacketOutcome& outcome) const noexcept {
  if (!outcome.lost()) return 0;
  outcome.lost_by_model = outcome.lost_by_event = false;
  std::int64_t wait_ns = 0;
  std::int64_t rto_ns = stage.rto_ns;
  do {
    wait_ns += rto_ns;
    rto_ns *= 2;
    ++outcome.retransmissions;
  } while (outcome.retransmissions < kMaxRetransmissions &&
           lost_again(stage, since_ns + wait_ns, index * kMaxRetransmissions + outcome.retransmissions));
  return wait_ns;
}

std::int64_t Emulator::next_slot(const CompiledProfile::Stage& stage, std::int64_t due_ns,
                                 std::uint32_t size) noexcept {
  const auto start_ns = [&](std::int64_t number) {
    const std::uint64_t word = slot_.draw(static_cast<std::uint64_t>(number));
    return origin_ns_ + number * stage.slot_ns +
           static_cast<std::int64_t>(uniform_below(word, stage.slot_jitter_ns + 1));
  };
  std::int64_t number = std::max<std::int64_t>(0, (due_ns - origin_ns_) / stage.slot_ns);
  if (start_ns(number) < due_ns) ++number;
  number = std::max(number, slot_number_);
  if (number == slot_number_) {
    const bool full = (stage.slot_packets > 0 && slot_used_packets_ >= stage.slot_packets) ||
                      (stage.slot_bytes > 0 && slot_used_bytes_ + size > stage.slot_bytes);
    if (full) ++number;
  }
  if (number != slot_number_) slot_used_packets_ = slot_used_bytes_ = 0;
  slot_number_ = number;
  ++slot_used_packets_;
  slot_used_bytes_ += size;
  return std::max(due_ns, start_ns(number));
}

std::int64_t Emulator::overtake(const CompiledProfile::Stage& stage, std::int64_t now_ns,
                                PacketOutcome& outcome) const noexcept {
  for (std::uint64_t gap = std::min<std::uint64_t>(stage.reorder_gap, in_order_); gap > 0; --gap) {
    const std::int64_t ahead_ns = recent_due_ns_[(in_order_ - gap) % kMaxReorderGap];
    if (ahead_ns <= now_ns) continue;  // has arrived already
    outcome.reordered = true;
    return ahead_ns - 1;
  }
  return now_ns;
}

const RecordedOutcome* Emulator::recorded(std::int64_t since_ns) noexcept {
  const Recording& recording = *profile_.recording;
  const std::int64_t round = std::max<std::int64_t>(0, since_ns) / profile_.recording_ns;
  if (round > 0 && !profile_.repeats) return nullptr;
  if (round != round_) next_recorded_ = 0;
  round_ = round;
  since_ns -= round * profile_.recording_ns;
  while (next_recorded_ < recording.size() && recording[next_recorded_].in_ns < since_ns) ++next_recorded_;
  // Of several that were recorded at the same time, one after the other.
  if (next_recorded_ < recording.size() && recording[next_recorded_].in_ns == since_ns)
    return &recording[next_recorded_++];
  return &recording[next_recorded_ == 0 ? 0 : next_recorded_ - 1];
}

PacketOutcome Emulator::replay(std::int64_t now_ns) noexcept {
  PacketOutcome outcome;
  const RecordedOutcome* const as = recorded(now_ns - origin_ns_);
  outcome.after_trace = as == nullptr;
  if (as == nullptr) return outcome;
  outcome.drawn_ns = as->delay_ns;
  outcome.due_ns = now_ns + as->delay_ns;
  outcome.lost_by_model = as->lost;
  outcome.duplicated = as->duplicated;
  outcome.corrupted = as->corrupted;
  return outcome;
}

void Emulator::keep(PacketOutcome& outcome, std::int64_t now_ns, std::span<const std::byte> packet,
                    std::uint32_t size, std::uint64_t tag, std::uint64_t index) noexcept {
  if (outcome.lost()) {
    ++(outcome.after_trace ? counters_.after_trace : counters_.lost);
    return;
  }
  const auto bit = [&](std::uint64_t copy) -> std::int64_t {
    if (packet.empty()) return -1;
    return static_cast<std::int64_t>(uniform_below(corrupted_bit_.draw(2 * index + copy), 8 * packet.size()));
  };
  InFlight::Packet kept{now_ns, tag, size, outcome.corrupted, false, entered_bytes_};
  if (!flight_.insert(outcome.due_ns, kept, packet, outcome.corrupted ? bit(0) : -1)) {
    outcome.overflowed = true;
    ++counters_.overflowed;
    return;
  }
  last_due_ns_ = std::max(last_due_ns_, outcome.due_ns);
  counters_.corrupted += outcome.corrupted;
  counters_.reordered += outcome.reordered;
  if (!outcome.duplicated) return;
  // The copy follows right behind, with an outcome of its own only as to corruption.
  kept.duplicate = true;
  kept.corrupted = profile_.recording && !profile_.loss_only
                       ? outcome.corrupted
                       : profile_.stages[stage_].corrupt.happens(corrupt_.draw(2 * index + 1));
  if (flight_.insert(outcome.due_ns, kept, packet, kept.corrupted ? bit(1) : -1)) {
    ++counters_.duplicated;
    counters_.corrupted += kept.corrupted;
  } else {
    ++counters_.overflowed;
  }
}

void Emulator::switch_to(CompiledProfile& profile, std::int64_t now_ns) noexcept {
  retime_queue(profile.bottleneck, std::max(now_ns, now_ns_));
  std::swap(profile_, profile);
  origin_ns_ = now_ns;
  stage_ = 0;
  state_ = -1;
  slot_number_ = -1;
  windows_.fill({});
  next_recorded_ = 0;
  round_ = 0;
}

}  // namespace telekerf::netem
