// SPDX-License-Identifier: Apache-2.0
// A direction's profile, made ready for the packet path: tables, integer thresholds, nanoseconds.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "netem/core/bottleneck.h"
#include "netem/core/delay_table.h"
#include "netem/core/loss_chain.h"
#include "netem/core/profile.h"
#include "netem/core/random.h"

namespace telekerf::netem {

/// Built outside the packet path (it allocates), then swapped into an emulator as a whole.
struct CompiledProfile {
  struct State {
    std::array<Probability, kMaxLossStates - 1> up_to;  ///< cumulative: the next state is at most 0, 1, 2
    Probability lost;
  };
  struct Stage {
    Stage(const netem::Stage& stage, std::shared_ptr<const DelayTable> table);
    std::int64_t from_ns;
    std::shared_ptr<const DelayTable> delay;  ///< stages of the same law share one
    bool constant;                            ///< no draw needed
    std::int64_t constant_ns;
    double correlation_ns;  ///< 0: none
    std::array<State, kMaxLossStates> loss;
    std::array<Probability, kMaxLossStates - 1> first_state;
    double mean_loss, burst_memory_ns;  ///< of a loss law in time; memory 0: by packets
    bool lossy, has_states, loss_from_trace;
    Probability retransmission_lost;
    Order order;
    Probability reorder;
    std::uint32_t reorder_gap;
    bool tcp_like;
    std::int64_t rto_ns;
    Probability duplicate, corrupt;
    double queue_bytes;
    std::int64_t slot_ns, slot_jitter_ns, slot_packets, slot_bytes;
  };
  /// Times since the profile began, [from, until), over which an event does not change: inside an occurrence,
  /// or between two (occurrence -1).
  struct Window {
    std::int64_t from_ns = 0, until_ns = 0;
    std::int64_t occurrence = -1;
  };
  struct Event {
    explicit Event(const netem::Event& event);
    std::int64_t first_ns, every_ns, duration_ns, add_min_ns, add_range_ns;
    Probability lost;
    bool hold;
    std::uint64_t coupling;
    Window window(std::int64_t since_ns) const noexcept;
  };

  explicit CompiledProfile(const DirectionProfile& profile);

  std::vector<Stage> stages;
  std::vector<Event> events;
  Bottleneck bottleneck;
  std::shared_ptr<const Recording> recording;
  bool loss_only = false;
  bool repeats = false;           ///< the recording
  std::int64_t recording_ns = 0;  ///< its length
};

}  // namespace telekerf::netem
