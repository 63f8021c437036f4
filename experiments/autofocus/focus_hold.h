// SPDX-License-Identifier: Apache-2.0
// Keeping the focus on an object that stands still: what looking for a better place costs.
#pragma once

#include <cstdint>

#include "common/runtime/error_statistics.h"
#include "slave/vision/imaging/targets.h"

namespace telekerf::experiments {

struct FocusHold {
  ErrorStatistics all_dof;     ///< true defocus at every picture after the lock,
  ErrorStatistics passed_dof;  ///< at those that are passed on as in focus
  bool lost = false;           ///< it searched anew, or never found the focus
};

/// Finds the focus at a magnification drawn from the seed, then keeps it for `seconds` of the stream.
FocusHold hold_focus(imaging::Target target, std::uint64_t seed, double seconds);

}  // namespace telekerf::experiments
