// SPDX-License-Identifier: Apache-2.0
// What the master says that it does.
#pragma once

#include "common/protocol/blocks.h"
#include "master/modes.h"

namespace telekerf::master {

/// A literal. What the slave makes of being led is said by the slave. `slave`: its newest report, or null;
/// `ours`: it answers to this master. `contour_id`: of the contour that this side works on. `off_line`: the hand
/// pushes the tool so far off the curve that the button is not passed on.
const char* text_of(MasterMode mode, const StateHeader* slave, bool ours, std::uint32_t contour_id,
                    bool off_line = false);

}  // namespace telekerf::master
