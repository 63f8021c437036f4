// SPDX-License-Identifier: Apache-2.0
// May the beam be on? Laser off is the answer to every doubt; the first reason that forbids it is said aloud.
#pragma once

#include <bit>
#include <cstdint>

#include "slave/laser/guards.h"
#include "slave/laser/permit.h"

namespace telekerf::laser {

/// Bit n: guard n of kGuards forbids.
struct Judgement {
  std::uint32_t forbidden = (std::uint64_t{1} << kGuardCount) - 1;
  bool permits() const noexcept { return forbidden == 0; }
  /// The first that forbids; ready: none does, and the button decides.
  Interlock reason() const noexcept {
    return permits() ? Interlock::kReady
                     : kGuards[static_cast<std::size_t>(std::countr_zero(forbidden))].reason;
  }
};

/// Pure judgement, made anew at every control step: all guards must hold.
inline Judgement evaluate_interlock(const InterlockInputs& now, const InterlockSettings& settings) noexcept {
  Judgement judgement{0};
  for (std::size_t n = 0; n < kGuardCount; ++n) {
    const bool holds = kGuards[n].limits(settings).hold(kGuards[n].value(now, settings));
    judgement.forbidden |= std::uint32_t{!holds} << n;
  }
  return judgement;
}

/// The only maker of permits.
class BeamInterlock {
 public:
  /// `period_ns`: of the control steps, at each of which decide() is called once.
  BeamInterlock(const InterlockSettings& settings, std::int64_t period_ns) noexcept
      : settings_(settings), period_ns_(period_ns) {}

  struct Decision {
    Judgement judgement;
    Permit permit;  ///< permits nothing unless the judgement does
  };
  Decision decide(std::int64_t now_ns, const InterlockInputs& now) noexcept {
    ++tick_;
    Decision decision{evaluate_interlock(now, settings_), {}};
    if (decision.judgement.permits())
      decision.permit = Permit(tick_, now_ns, now_ns + kPermitPeriods * period_ns_, now.power_w);
    return decision;
  }
  const InterlockSettings& settings() const noexcept { return settings_; }

 private:
  static constexpr std::int64_t kPermitPeriods = 2;
  InterlockSettings settings_;
  std::int64_t period_ns_;
  std::uint64_t tick_ = 0;
};

}  // namespace telekerf::laser
