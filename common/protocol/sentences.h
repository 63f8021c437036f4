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

/// Why the beam is off, as the operator reads it.
constexpr const char* sentence_of(Interlock interlock) noexcept {
  switch (interlock) {
    case Interlock::kReady:
      return "the button decides";
    case Interlock::kNoContour:
      return "the slave knows no contour, or not the master's";
    case Interlock::kNotEngaged:
      return "the slave does not follow";
    case Interlock::kStale:
      return "commands are missing";
    case Interlock::kOutsideWorkspace:
      return "the tool is outside its workspace";
    case Interlock::kOutsideCorridor:
      return "the tool is off the contour";
    case Interlock::kTracking:
      return "the slave is not where it is led to yet";
    case Interlock::kStopped:
      return "the emergency stop is in force";
    case Interlock::kHeight:
      return "the tool is too far above or below the work";
    case Interlock::kSpeed:
      return "the tool rests, or is too slow or too fast to burn";
    case Interlock::kDose:
      return "this place has got all the energy that it may";
    case Interlock::kPower:
      return "more power is wanted than the work may have";
    case Interlock::kPredicted:
      return "the tool could leave the corridor in a moment";
    case Interlock::kFault:
      return "the slave has a fault";
    case Interlock::kAge:
      return "commands reach the slave too late to burn";
    case Interlock::kNotArmed:
      return "let go of the fire button once, or engage anew";
    case Interlock::kMonitor:
      return "the second judgement forbids it";
    case Interlock::kArc:
      return "the tool is beside another part of the contour than expected";
    case Interlock::kLate:
      return "a control step of the slave came late";
  }
  return "an unknown reason";
}

}  // namespace telekerf
