// SPDX-License-Identifier: Apache-2.0
// What a run of many packets must show of events, copies, damage, order and slots, held against what the
// profile says.
#pragma once

#include <vector>

#include "netem/core/profile.h"
#include "netem/core/random.h"
#include "netem/verify/checks.h"
#include "netem/verify/virtual_run.h"

namespace telekerf::netem {

/// Delay and loss inside each event, as far as no other event has a part in them.
void check_events(const std::vector<Event>& events, const Run& run, Checks& checks);

/// Copies, damage, overtaking and slots.
void check_impairments(const Conditions& nominal, const Run& run, Checks& checks);

/// What every network keeps: nothing comes early or gets lost uncounted, and `fifo` nothing overtakes.
void check_promises(bool fifo, const Run& run, Checks& checks);

}  // namespace telekerf::netem
