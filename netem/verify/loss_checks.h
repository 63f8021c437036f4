// SPDX-License-Identifier: Apache-2.0
// What a run of many packets must show of its losses, held against the nominal law.
#pragma once

#include "netem/core/profile.h"
#include "netem/verify/checks.h"
#include "netem/verify/virtual_run.h"

namespace telekerf::netem {

/// Fraction and bursts of what the loss model takes. With `event_losses` retransmissions have two causes and
/// are not counted.
void check_loss(const Conditions& nominal, const Run& run, double rate_hz, bool event_losses, Checks& checks);

}  // namespace telekerf::netem
