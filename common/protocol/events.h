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
  enum class Kind : std::uint8_t {
    kEngage,
    kDisengage,
    kSetBeta,
    kFinished,
    kSetNetem,
    kAnswer,
    kTakeContour,
    kSetZoom,
    kRefocus,
    kLook,
    kSetStream
  };
  std::uint32_t epoch = 0;  ///< of the process that says it; of an answer: of whom it answers
  Kind kind = Kind::kDisengage;
  double value = 0.0;  ///< of a scale; of a contour its id; of an answer 1: refused, 0: done
  std::string text;  ///< of a network: its profile; of a look: what is meant (docs/reference/contours.md); of
                     ///< the command stream "WORD VALUE" (docs/reference/contract.md); of an answer "ROLE:
                     ///< what became of it"
};

/// Slow named numbers of one process, for console and recorder.
struct TelemetryMessage {
  std::string role;
  std::uint64_t tick = 0;  ///< of the process' own
  std::vector<std::pair<std::string, double>> values;
};

}  // namespace telekerf
