// SPDX-License-Identifier: Apache-2.0
// One seed: both stations in virtual time, whatever its faults do to them, and what the checker found.
#pragma once

#include <cstdint>
#include <vector>

#include "common/protocol/messages.h"
#include "experiments/chaos/checker.h"
#include "experiments/chaos/fault.h"
#include "experiments/chaos/sites.h"

namespace telekerf::experiments {

/// liveness: the last third (at least 7 s) heals everything, and the lap must go on after one engage.
enum class ChaosMode : std::uint8_t { kLiveness, kSafety };
inline constexpr EnumRow<ChaosMode> kChaosModeRows[] = {
    {"liveness", ChaosMode::kLiveness, "the last third heals everything; one engage must suffice"},
    {"safety", ChaosMode::kSafety, "faults until the end"}};
inline constexpr EnumTable<ChaosMode> kChaosModes(kChaosModeRows);

/// The contours that a run may publish; the same for all runs.
struct ChaosContours {
  ContourMessage work;      ///< what is cut
  ContourMessage other;     ///< another one, under its own id
  ContourMessage impostor;  ///< another one, under the id of the first
};
ChaosContours chaos_contours(const master::StationSettings& master, const slave::StationSettings& slave);

struct ChaosSettings {
  std::uint64_t seed = 1;
  double duration_s = 20.0;
  ChaosMode mode = ChaosMode::kLiveness;
  std::vector<FaultKind> kinds;  ///< at work
  CheckerSettings bars;
  master::StationSettings master;
  slave::StationSettings slave;
  /// The same beam's gate at both sites and for the checker.
  void set_gate(double gate_s) { bars.gate_s = master.beam_age_s = slave.node.interlock.beam_age_s = gate_s; }
};

struct ChaosOutcome {
  Findings findings;
  Refused refused;
  int engages = 0;
  bool recovered = false;  ///< liveness only
};

/// A shorter run has no room for faults, or, in liveness mode, for the healing after them.
double shortest_s(ChaosMode mode) noexcept;
/// When everything is healed; the end where nothing is.
double heal_s(double duration_s, ChaosMode mode) noexcept;

/// Same settings, same outcome, bit by bit. Throws StartupError.
ChaosOutcome run_chaos(const ChaosSettings& settings, const ChaosContours& contours);

}  // namespace telekerf::experiments
