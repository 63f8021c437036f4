// SPDX-License-Identifier: Apache-2.0
// From a run that misses a bar to the smallest one that still does.
#pragma once

#include <functional>
#include <string>

#include "experiments/chaos/chaos_run.h"

namespace telekerf::experiments {

/// True: the run still misses the bar in question.
using StillFails = std::function<bool(const ChaosSettings&)>;

/// Shorter (halves, then smaller parts), without healing where that is not the matter, and fault by fault
/// left out, as long as it fails. `failing` must fail.
ChaosSettings shrink(const ChaosSettings& failing, const StillFails& fails);

/// What to type to see it.
std::string command_line(const ChaosSettings& settings);

/// "loss,stop" -> kinds; "none": no fault. Throws StartupError that names the words there are.
std::vector<FaultKind> parse_faults(const std::string& words);

}  // namespace telekerf::experiments
