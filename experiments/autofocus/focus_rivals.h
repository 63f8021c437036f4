// SPDX-License-Identifier: Apache-2.0
// Other ways to find the focus, on the same starts: the law as printed, and what microscopes' programs do.
#pragma once

#include "common/runtime/enum_table.h"
#include "experiments/autofocus/focus_trial.h"

namespace telekerf::experiments {

/// Eq. 156-161 as printed, 60 pictures at the full rate, from a first excitation of a window on; it claims
/// that where it ends is the focus.
FocusOutcome by_printed_law(VirtualUnit& unit, const imaging::FocusRange& range);
/// Golden section over the reach on eq. 155, to 0.3 depths of field.
FocusOutcome by_golden_section(VirtualUnit& unit, const imaging::FocusRange& range);
/// Brent's method over the reach on eq. 155, relative tolerance 1 %.
FocusOutcome by_brent(VirtualUnit& unit, const imaging::FocusRange& range);
/// A sweep over the reach in one go, half a depth of field a picture; the picture whose JPEG is largest.
FocusOutcome by_largest_jpeg(VirtualUnit& unit, const imaging::FocusRange& range);

inline constexpr EnumRow<FocusStrategy> kFocusStrategyRows[] = {
    {"search", by_search, "variance finds, Tenengrad fixes, a second look confirms"},
    {"thesis_law", by_printed_law, "the self-optimising law as printed"},
    {"golden_section", by_golden_section, "golden section on the normalised variance"},
    {"brent", by_brent, "Brent's method on the normalised variance"},
    {"largest_jpeg", by_largest_jpeg, "a sweep, and the picture whose JPEG is largest"},
};
inline constexpr EnumTable<FocusStrategy> kFocusStrategies(kFocusStrategyRows);

}  // namespace telekerf::experiments
