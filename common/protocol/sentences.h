// SPDX-License-Identifier: Apache-2.0
// What the sites tell each other in numbers, in words for people.
#pragma once

#include "common/protocol/blocks.h"

namespace telekerf {

/// Literals, so that a control loop may pass them on.
constexpr const char* sentence_of(HoldReason reason) noexcept {
  switch (reason) {
    case HoldReason::kNone:
      return "it follows";
    case HoldReason::kNoCommands:
      return "no commands have come";
    case HoldReason::kNotEngaged:
      return "the master does not lead";
    case HoldReason::kNeedsEngage:
      return "after a stop, an outage, another contour or a restart it has to be engaged anew (telekerf-ctl "
             "engage)";
    case HoldReason::kSilent:
      return "no commands arrive";
    case HoldReason::kTooOld:
      return "the commands that arrive are too old to be followed";
    case HoldReason::kClockWrong:
      return "nobody knows how old the commands are: they answer no state of this slave";
    case HoldReason::kLimits:
      return "the commands lead out of the robot's bounds";
    case HoldReason::kStopped:
      return "emergency stop";
  }
  return "unknown";
}

/// The same, as the side that leads says it.
constexpr const char* led_sentence_of(HoldReason reason) noexcept {
  switch (reason) {
    case HoldReason::kNotEngaged:
    case HoldReason::kNone:
      return "engaged: the slave is being taken hold of";
    case HoldReason::kNeedsEngage:
      return "engaged, but the slave holds until it is engaged anew";
    case HoldReason::kTooOld:
      return "engaged, but the slave holds: the commands reach it too late";
    case HoldReason::kClockWrong:
      return "engaged, but the slave holds: it cannot tell how old the commands are";
    case HoldReason::kLimits:
      return "engaged, but the slave holds: it is led out of its bounds";
    case HoldReason::kStopped:
      return "engaged, but the slave is stopped";
    case HoldReason::kSilent:
    case HoldReason::kNoCommands:
      return "engaged, but no commands reach the slave";
  }
  return "engaged, but the slave does not follow";
}

}  // namespace telekerf
