// SPDX-License-Identifier: Apache-2.0
// What a run of many packets must show of its delays, held against the nominal law.
#pragma once

#include "netem/core/profile.h"
#include "netem/verify/checks.h"
#include "netem/verify/virtual_run.h"

namespace telekerf::netem {

/// Quantiles, mean, deviation and memory of the delays; where the order is free how often a packet overtakes
/// the one before it, sent at `rate_hz`.
void check_delay(const Conditions& nominal, const Run& run, double rate_hz, Checks& checks);

}  // namespace telekerf::netem
