// SPDX-License-Identifier: Apache-2.0
// The network's core for one flow in one direction: packets in, due times out. No clock, no thread, no
// socket.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "netem/core/compiled_profile.h"
#include "netem/core/in_flight.h"
#include "netem/core/profile.h"
#include "netem/core/random.h"

namespace telekerf::netem {

/// What was decided for one packet; everything is decided when it enters.
struct PacketOutcome {
  std::int64_t due_ns = 0;     ///< meaningless when lost
  std::int64_t drawn_ns = 0;   ///< the delay that the law alone gave
  std::int64_t event_ns = 0;   ///< added by events
  std::int64_t queued_ns = 0;  ///< until it has left the bottleneck
  bool lost_by_model = false;
  bool lost_by_event = false;
  bool queue_full = false;   ///< tail drop before the bottleneck
  bool after_trace = false;  ///< the recording is over
  bool overflowed =
      false;  ///< the emulator's own capacity was too small: a fault of the set-up, not of the network
  bool duplicated = false;
  bool corrupted = false;
  bool reordered = false;  ///< chosen to overtake
  std::uint8_t retransmissions = 0;
  bool lost() const noexcept {
    return lost_by_model || lost_by_event || queue_full || overflowed || after_trace;
  }
};

struct Counters {
  std::uint64_t pushed = 0;
  std::uint64_t delivered = 0;  ///< copies included
  std::uint64_t lost = 0;       ///< by loss model or event
  std::uint64_t queue_full = 0;
  std::uint64_t after_trace = 0;  ///< lost since a recording is over
  std::uint64_t overflowed = 0;   ///< capacity of this object
  std::uint64_t duplicated = 0;
  std::uint64_t corrupted = 0;
  std::uint64_t reordered = 0;
};

/// Same profile, key and sequence of pushes: same outcomes, on every machine. Nothing allocates after
/// construction. Not thread-safe: one owner. Times are integer nanoseconds on any clock that the caller
/// likes.
class Emulator {
 public:
  /// The profile's stages and events count from `origin_ns`.
  Emulator(const DirectionProfile& profile, const StreamKey& key, Capacity capacity = {},
           std::int64_t origin_ns = 0);

  /// Decides the packet's outcome and keeps a copy of it. `now_ns` earlier than an earlier push counts as
  /// that one.
  PacketOutcome push(std::int64_t now_ns, std::span<const std::byte> packet, std::uint64_t tag) noexcept;
  /// The same for simulations that need no payload: only the size counts (rate, slots).
  PacketOutcome push(std::int64_t now_ns, std::uint32_t size_bytes, std::uint64_t tag) noexcept;

  /// When the next pop will succeed.
  std::optional<std::int64_t> next_deadline() const noexcept {
    if (flight_.empty()) return std::nullopt;
    return flight_.next_due();
  }

  /// The earliest packet that is due by `now_ns`; never one before its due time.
  std::optional<Delivery> pop(std::int64_t now_ns) noexcept {
    std::optional<Delivery> delivery;
    if (flight_.empty() || flight_.next_due() > now_ns) return delivery;
    flight_.take(delivery.emplace());
    ++counters_.delivered;
    return delivery;
  }

  /// Puts another network in place, from the next push on. What has passed the bottleneck keeps its due time;
  /// what still waits before it leaves at the new network's rate. `profile` receives the old one, to be
  /// destroyed by the caller where allocation is allowed. Stages and events count from `now_ns`.
  void switch_to(CompiledProfile& profile, std::int64_t now_ns) noexcept;

  const Counters& counters() const noexcept { return counters_; }
  std::size_t memory_bytes() const noexcept { return flight_.memory_bytes(); }

 private:
  PacketOutcome push(std::int64_t now_ns, std::span<const std::byte> packet, std::uint32_t size,
                     std::uint64_t tag) noexcept;
  const CompiledProfile::Stage& stage_at(std::int64_t since_ns) noexcept;
  /// `pause_ns`: since the packet before.
  bool lose(const CompiledProfile::Stage& stage, std::uint64_t index, std::int64_t pause_ns,
            const RecordedOutcome* recorded) noexcept;
  void meet_events(std::int64_t since_ns, std::uint64_t index, PacketOutcome& outcome) noexcept;
  std::int64_t law_delay(const CompiledProfile::Stage& stage, std::uint64_t index,
                         std::int64_t pause_ns) noexcept;
  bool lost_again(const CompiledProfile::Stage& stage, std::int64_t since_ns,
                  std::uint64_t counter) const noexcept;
  std::int64_t retransmit(const CompiledProfile::Stage& stage, std::int64_t since_ns, std::uint64_t index,
                          PacketOutcome& outcome) const noexcept;
  std::int64_t next_slot(const CompiledProfile::Stage& stage, std::int64_t due_ns,
                         std::uint32_t size) noexcept;
  std::int64_t overtake(const CompiledProfile::Stage& stage, std::int64_t now_ns,
                        PacketOutcome& outcome) const noexcept;
  /// How the packet fares that was recorded at this time; null: the recording is over.
  const RecordedOutcome* recorded(std::int64_t since_ns) noexcept;
  PacketOutcome replay(std::int64_t now_ns) noexcept;
  void serve_until(std::int64_t now_ns) noexcept;
  /// When the packet has left the bottleneck, or what becomes of it there.
  std::int64_t pass_bottleneck(const CompiledProfile::Stage& stage, std::int64_t now_ns, std::uint32_t size,
                               PacketOutcome& outcome) noexcept;
  /// What waits leaves by another bottleneck, which begins now.
  void retime_queue(const Bottleneck& fresh, std::int64_t now_ns) noexcept;
  void keep(PacketOutcome& outcome, std::int64_t now_ns, std::span<const std::byte> packet,
            std::uint32_t size, std::uint64_t tag, std::uint64_t index) noexcept;

  CompiledProfile profile_;
  const NormalTable& normal_;
  Stream delay_, loss_, loss_state_, retransmission_, duplicate_, corrupt_, corrupted_bit_, reorder_,
      event_delay_, event_loss_, slot_, coupled_delay_;
  InFlight flight_;
  Counters counters_;

  std::int64_t origin_ns_;
  std::int64_t now_ns_;
  std::uint64_t index_ = 0;  // of the next packet: the counter of every stream
  std::size_t stage_ = 0;
  std::array<CompiledProfile::Window, kMaxEvents>
      windows_{};       // the stretch of time that each event was last looked up for
  int state_ = -1;      // of the loss chain; -1: not drawn yet
  double score_ = 0.0;  // normal score of the last delay
  bool has_score_ = false;
  double backlog_bytes_ = 0.0;  // before the bottleneck, at backlog_ns_
  std::int64_t backlog_ns_;
  std::uint64_t entered_bytes_ = 0;  // into the bottleneck's queue, ever
  std::size_t next_recorded_ = 0;    // of the recording, in its round
  std::int64_t round_ = 0;
  std::int64_t last_due_ns_;
  std::int64_t slot_number_ = -1, slot_used_packets_ = 0, slot_used_bytes_ = 0;
  std::array<std::int64_t, kMaxReorderGap> recent_due_ns_{};  // ring of packets that kept their order
  std::uint64_t in_order_ = 0;
};

}  // namespace telekerf::netem
