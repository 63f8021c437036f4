// SPDX-License-Identifier: Apache-2.0
// What is said now and then: modes and events to everyone, and slow numbers for people.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace telekerf {

/// Modes and events, reliable.
struct EventMessage {
  enum class Kind : std::uint8_t { kEngage, kDisengage, kSetBeta, kFinished, kSetNetem, kSetZoom, kRefocus };
  std::uint32_t epoch = 0;
  Kind kind = Kind::kDisengage;
  double value = 0.0;
  std::string text;
};

/// Slow named numbers of one process, for console and recorder.
struct TelemetryMessage {
  std::string role;
  std::uint64_t tick = 0;  ///< of the process' own
  std::vector<std::pair<std::string, double>> values;
};

}  // namespace telekerf
