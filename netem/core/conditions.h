// SPDX-License-Identifier: Apache-2.0
// What a stage does to packets, read from its keys.
#pragma once

#include "netem/core/profile.h"
#include "netem/core/section.h"

namespace telekerf::netem {

/// Delay, loss, order and what else the section says; refuses keys that contradict one another.
Conditions read_conditions(const Section& section);

}  // namespace telekerf::netem
