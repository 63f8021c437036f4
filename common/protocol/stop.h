// SPDX-License-Identifier: Apache-2.0
// The emergency stop: who said it, under which number, and who has obeyed.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <string>

namespace telekerf {

/// Reliable and latched, anyone -> everyone; said again until everyone concerned has obeyed.
struct StopMessage {
  std::uint32_t epoch = 0;   ///< of the process that says it
  std::uint32_t number = 0;  ///< of this stop, never 0: chosen by who stops, and quoted by everyone else
  std::string source;        ///< who stopped; nobody else can clear it
  bool set = true;           ///< false: the stop of this number is over
  bool obeyed = false;       ///< said by a station: its control loop has acted on it
  std::string reason;        ///< for people
};

/// What a control loop is told of it, every step.
struct StopOrder {
  std::uint32_t number = 0;                ///< of the stop in force; 0: none
  std::array<std::uint32_t, 4> cleared{};  ///< of those that were cleared last; 0: none

  /// The stop that is in force where the other side's stream quotes `quoted` (0: none): it may know of one
  /// that has not come here yet.
  std::uint32_t in_force(std::uint32_t quoted) const noexcept {
    if (number != 0) return number;
    return std::find(cleared.begin(), cleared.end(), quoted) == cleared.end() ? quoted : 0;
  }
};

}  // namespace telekerf
