// SPDX-License-Identifier: Apache-2.0
// What a run of many packets must show of a bottleneck, also while its rate changes.
#pragma once

#include "netem/core/profile.h"
#include "netem/core/random.h"
#include "netem/verify/checks.h"
#include "netem/verify/virtual_run.h"

namespace telekerf::netem {

/// Twice the bottleneck's rate is offered, in packets of which at least two fit into its queue; what leaves
/// must be the rate, and nothing may stay longer than a full queue takes.
void check_rate(const DirectionProfile& emulated, const Conditions& nominal, Direction direction,
                Traffic traffic, Checks& checks);

/// From one stage to the next with its queue full: each packet must leave when the rates of both stages, as
/// far as each lasts, have served what was before it.
void check_change_of_rate(const Stage& before, const Stage& after, const DirectionProfile& emulated,
                          Direction direction, Traffic traffic, Checks& checks);

/// A recorded rate, offered twice what it can take: every opportunity takes its bytes and no more.
void check_rate_trace(const DirectionProfile& nominal, const DirectionProfile& emulated, Direction direction,
                      Traffic traffic, Checks& checks);

}  // namespace telekerf::netem
