// SPDX-License-Identifier: Apache-2.0
// How long a stop takes from who says it to the answer that it is obeyed, over a link that loses messages.
#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>

namespace telekerf::experiments {

struct StopTrial {
  std::uint64_t seed = 1;
  double rtt_s = 0.1;
  double loss = 0.0;  ///< of messages, each way
};

struct StopOutcome {
  double obeyed_s = -1.0;        ///< from saying it until the control loop obeys; negative: never
  double acknowledged_s = -1.0;  ///< until the answer is there
  bool survived =
      false;  ///< it is in force after a restart of the station and of who said it, until it is cleared
};

/// In virtual time, with what the processes use: said every kStopAgain, latched where it is heard, obeyed in
/// the next step of a loop of 1 kHz, answered by a thread that looks as often. No loss is repaired by the
/// middleware.
StopOutcome try_stop(const StopTrial& trial);

/// `runs` of them from `seed` on, without loss and with 20 %, round trips of 2 to 150 ms; what of the answers
/// came after the round trip, at most. False: a bar is missed (2 ms, 60 ms, all survive).
bool try_stops(std::uint64_t seed, int runs, nlohmann::ordered_json& out);

}  // namespace telekerf::experiments
