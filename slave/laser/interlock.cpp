// SPDX-License-Identifier: Apache-2.0
#include "slave/laser/interlock.h"

namespace telekerf::laser {

const char* name_of(Interlock state) noexcept {
  switch (state) {
    case Interlock::kReady:
      return "ready";
    case Interlock::kNoContour:
      return "no contour";
    case Interlock::kNotEngaged:
      return "not engaged";
    case Interlock::kStale:
      return "no fresh commands";
    case Interlock::kOutsideWorkspace:
      return "outside the workspace";
    case Interlock::kOutsideCorridor:
      return "outside the corridor";
    case Interlock::kTracking:
      return "too far from the reference";
    case Interlock::kStopped:
      return "emergency stop";
  }
  return "unknown";
}

}  // namespace telekerf::laser
