// SPDX-License-Identifier: Apache-2.0
// Starts out of focus, drawn from a seed: target, defocus, magnification, noise, dust. And what a strategy
// made of one.
#pragma once

#include <cstdint>
#include <memory>

#include "common/runtime/enum_table.h"
#include "experiments/autofocus/virtual_unit.h"
#include "slave/vision/imaging/targets.h"

namespace telekerf::experiments {

/// What a start is made of beside its target.
enum class StartKind : std::uint8_t {
  kUsual,       ///< the target lies within +-10 depths of field
  kOutOfRange,  ///< 30 to 45 depths of field away
  kMoving,      ///< it slides, shakes or creeps
};

struct FocusStart {
  imaging::Target target = imaging::Target::kRelief;
  StartKind kind = StartKind::kUsual;
  std::uint64_t seed = 1;
};

/// The unit of a start, with the focus where the start says.
struct DrawnStart {
  std::unique_ptr<VirtualUnit> unit;
  imaging::FocusRange range;
};
DrawnStart draw_start(const FocusStart& start);

struct FocusOutcome {
  bool claimed = false;  ///< the strategy says that this is the focus
  imaging::FocusVerdict verdict = imaging::FocusVerdict::kNoPeak;  ///< of a strategy that gives one
  int pictures = 0;
  double error_dof = 0.0;  ///< true, where the focus was left
  /// Within a depth of field of the truth.
  bool success() const noexcept { return claimed && error_dof <= 1.0 && error_dof >= -1.0; }
  bool false_lock() const noexcept { return claimed && !success(); }
};

/// Ways to find the focus, each in a unit of its own.
using FocusStrategy = FocusOutcome (*)(VirtualUnit& unit, const imaging::FocusRange& range);

FocusOutcome by_search(VirtualUnit& unit, const imaging::FocusRange& range);

}  // namespace telekerf::experiments
