// SPDX-License-Identifier: Apache-2.0
#include "common/codec/button_bits.h"

#include <bit>

#include "common/codec/selection.h"

namespace telekerf::codec {

void write_button(BitWriter& out, std::uint64_t button, int block) noexcept {
  // Two bits say "constant"; one press or release inside the block is its place; anything else is told bit by
  // bit.
  const std::uint64_t all = first_indices(block);
  button &= all;
  const bool start = (button & 1) != 0;
  const std::uint64_t differs = start ? ~button & all : button;
  if (differs == 0) {
    out.bits(start ? 1 : 0, 2);
    return;
  }
  const int change = std::countr_zero(differs);
  if (differs == (all & ~first_indices(change))) {
    out.bits(start ? 5 : 4, 3);
    out.bits(static_cast<std::uint64_t>(change), 6);
    return;
  }
  out.bits(3, 2);
  out.bits(button, block);
}

std::uint64_t read_button(BitReader& in, int block) noexcept {
  const std::uint64_t all = first_indices(block);
  if (!in.bit()) return in.bit() ? all : 0;
  if (in.bit()) return in.bits(block);
  const bool start = in.bit();
  const auto before = first_indices(static_cast<int>(in.bits(6))) & all;
  return start ? before : all & ~before;
}

}  // namespace telekerf::codec
