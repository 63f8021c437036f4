// SPDX-License-Identifier: Apache-2.0
// Greatest speeds at equal steps along a line, such that every slow place can be braked for.
#pragma once

#include <span>

namespace telekerf::geometry {

/// Speed at which a bend of this curvature (1/m, of either sign) asks for that acceleration across it; no
/// bend: infinity.
double speed_in_bend(double curvature_per_m, double acceleration_m_per_s2) noexcept;

/// Lowers the speeds until each can be braked down to the next one ahead: v^2 changes by at most 2 a ds.
void keep_brakable(std::span<double> speed_m_per_s, double step_m, double acceleration_m_per_s2) noexcept;

/// The same for either direction of travel. `closed`: the last one is beside the first one.
void keep_brakable_both_ways(std::span<double> speed_m_per_s, double step_m, double acceleration_m_per_s2,
                             bool closed) noexcept;

}  // namespace telekerf::geometry
