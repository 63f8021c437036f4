// SPDX-License-Identifier: Apache-2.0
// What a simulated microscope looks at: textures of our own, drawn from a seed.
#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>

#include "common/runtime/enum_table.h"

namespace telekerf::imaging {

enum class Target : std::uint8_t { kRelief, kTissue, kLetter, kGrid, kBlank };
inline constexpr EnumRow<Target> kTargetRows[] = {
    {"relief", Target::kRelief, "a coin-like relief under oblique light"},
    {"tissue", Target::kTissue, "a tissue-like texture of low contrast"},
    {"letter", Target::kLetter, "a printed letter"},
    {"grid", Target::kGrid, "the printed grid of dots for the calibration"},
    {"blank", Target::kBlank, "nothing at all"},
};
inline constexpr EnumTable<Target> kTargets(kTargetRows);

/// Dots of a printed grid, as a share of its pitch across.
inline constexpr double kDotShare = 0.45;

/// `size` x `size` grey levels 0..255 (CV_32F). `structure_px` is the width of the finest structure, and
/// of a grid its pitch.
cv::Mat draw_target(Target target, int size, double structure_px, std::uint64_t seed);

}  // namespace telekerf::imaging
