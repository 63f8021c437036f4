// SPDX-License-Identifier: Apache-2.0
// Who computes the slave's acceleration (thesis 5.3): the laws, a row each, and the one that the master
// computes.
#pragma once

#include "common/control/kinematic_state.h"
#include "common/protocol/messages.h"
#include "common/runtime/enum_table.h"

namespace telekerf::master {

using control::KinematicState;

inline constexpr EnumRow<Law> kLawRows[] = {
    {"anchored", Law::kAnchored, "the master; the slave follows what its commands integrate to"},
    {"remote-acceleration", Law::kRemoteAcceleration, "the master; the slave obeys each command as it is"},
    {"local", Law::kLocal, "the slave, from the master's scaled position"}};
/// The words of command lines and reports.
inline constexpr EnumTable<Law> kLaws(kLawRows);

/// The stream carries accelerations; otherwise positions.
constexpr bool streams_accelerations(Law law) noexcept { return law != Law::kLocal; }

struct LawSettings {
  Law law = Law::kAnchored;
  double tracking_rad_s = 400.0;  ///< w of the law, critically damped: K_v = 2 w, K_p = w^2
  double timing_error_s = 1e-3;   ///< of the slave's answer, to be borne when the loop spans the delay
  double max_acceleration_m_per_s2 = 10.0;  ///< of a command; what is stored is what was clipped
};

/// w at a delay of `delay_s` from command to answer. A loop of bandwidth w closed across the delay D bears an
/// error t of the assumed timing while t (2 w + w^2 D) < 1 (docs/results/delay.md); designed to half of it.
double law_bandwidth(const LawSettings& settings, double delay_s) noexcept;

/// Eq. 96 in operational space and with eq. 79's scaling corrected, eps = beta x_m - x_s: the command that
/// leads the slave, predicted as `slave` and under `disturbance_m_per_s2`, to `goal`; m/s^2, clipped.
Vec3 commanded_acceleration(const LawSettings& settings, double bandwidth_rad_s, const KinematicState& goal,
                            const KinematicState& slave, const Vec3& disturbance_m_per_s2) noexcept;

}  // namespace telekerf::master
