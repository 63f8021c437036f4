// SPDX-License-Identifier: Apache-2.0
#include "common/codec/context_model.h"

#include <algorithm>
#include <bit>

#include "common/codec/bits.h"

namespace telekerf::codec {

ContextModel learnt(ContextModel model, std::span<const AxisCode* const> codes, bool anchored) noexcept {
  int count = 0;
  int offset = 0;
  int level_order = 0;
  int value_order = 0;
  int used = 0;
  for (const AxisCode* each : codes) {
    const AxisCode& code = *each;
    const auto width = [&](std::size_t k) {
      return static_cast<int>(std::bit_width(zigzag(code.values[k])));
    };
    if (code.mode == Mode::kRunLength) level_order = std::max(level_order, width(0) - 2);
    if (!code.is_transformed()) continue;
    count += std::popcount(code.set);
    offset += code.step_offset;
    ++used;
    level_order = std::max(level_order, width(0) - 2);
    const auto upper = code.set & ~IndexSet{anchored && code.has_level() ? 0u : 1u};
    if (upper != 0) value_order += width(static_cast<std::size_t>(std::countr_zero(upper))) - 1;
  }
  model.level_order = std::clamp(level_order, 0, 31);
  if (used == 0) return model;
  model.count = std::min((count + used / 2) / used, 63);
  model.step_offset = std::clamp((offset + used / 2) / used, 0, 31);
  model.value_order = std::clamp(value_order / used, 0, 15);
  return model;
}

}  // namespace telekerf::codec
