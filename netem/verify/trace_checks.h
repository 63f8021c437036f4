// SPDX-License-Identifier: Apache-2.0
// What a run of many packets must show of a recording: by time, each packet fares as the one recorded last.
#pragma once

#include "netem/core/profile.h"
#include "netem/verify/checks.h"
#include "netem/verify/virtual_run.h"

namespace telekerf::netem {

/// The whole fate of every packet.
void check_recording(const DirectionProfile& nominal, const Run& run, Checks& checks);

/// Losses alone.
void check_loss_trace(const DirectionProfile& nominal, const Run& run, Checks& checks);

}  // namespace telekerf::netem
