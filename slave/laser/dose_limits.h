// SPDX-License-Identifier: Apache-2.0
// How much energy a place may get, as a user sets it; the same for a hand and for automatic machining.
#pragma once

#include <string_view>

#include "slave/laser/guards.h"

namespace telekerf {
class Settings;
}

namespace telekerf::laser {

/// `dose_max_j` and `dose_max_j_per_mm2`.
void add_dose_parameters(InterlockSettings& limits, Settings& settings);

/// Throws StartupError if one pass with `laser_w` at `speed_mm_s`, the setting `speed_key`, would be too
/// much.
void require_dose(const InterlockSettings& limits, double laser_w, double speed_mm_s,
                  std::string_view speed_key);

}  // namespace telekerf::laser
