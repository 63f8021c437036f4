// SPDX-License-Identifier: Apache-2.0
// What an encoder learns of its stream as it goes on.
#pragma once

#include <span>

#include "common/codec/axis_code.h"

namespace telekerf::codec {

/// What the stream has lately been like, announced in each packet's head so that the usual costs one bit.
struct ContextModel {
  int count = 4;        ///< coefficients an axis
  int step_offset = 0;  ///< half octaves above the finest step
  int level_order = 8;  ///< Exp-Golomb order of a level told whole
  int value_order = 4;  ///< ... of an axis' first coefficient
};

/// The model after a block: `codes` are its axes'. With `anchored` the level of a block that has one is told
/// apart from coefficient 0.
ContextModel learnt(ContextModel model, std::span<const AxisCode* const> codes, bool anchored) noexcept;

}  // namespace telekerf::codec
