// SPDX-License-Identifier: Apache-2.0
// A direction's profile, made ready for the packet path: tables, integer thresholds, nanoseconds.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

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
    explicit Stage(const netem::Stage& stage);
    std::int64_t from_ns;
    DelayTable delay;
    bool constant;  ///< no draw needed
    std::int64_t constant_ns;
    double correlation, innovation;
    std::array<State, kMaxLossStates> loss;
    std::array<Probability, kMaxLossStates - 1> first_state;
    bool lossy, has_states, loss_from_trace;
    Probability retransmission_lost;
    Order order;
    Probability reorder;
    std::uint32_t reorder_gap;
    bool tcp_like;
    std::int64_t rto_ns;
    Probability duplicate, corrupt;
    double ns_per_byte;     ///< 0: no bottleneck
    std::int64_t queue_ns;  ///< waiting time that fills the queue
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
    Window window(std::int64_t since_ns) const noexcept;
  };

  explicit CompiledProfile(const DirectionProfile& profile);

  std::vector<Stage> stages;
  std::vector<Event> events;
  std::shared_ptr<const Recording> recording;
  bool loss_only = false;
};

}  // namespace telekerf::netem
