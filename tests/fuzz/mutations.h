// SPDX-License-Identifier: Apache-2.0
// Seeded changes of bytes, for fuzz targets that run without libFuzzer.
#pragma once

#include <algorithm>
#include <cstdint>
#include <random>
#include <vector>

namespace telekerf::fuzz {

using Bytes = std::vector<std::uint8_t>;
using Random = std::mt19937_64;

/// Up to four times a bit, a byte, the end, a byte more, or eight bytes of nothing or ones.
inline void mutate(Bytes& bytes, Random& random) {
  for (auto changes = random() % 5; changes > 0 && !bytes.empty(); --changes) {
    const auto at = random() % bytes.size();
    switch (random() % 5) {
      case 0:
        bytes[at] ^= static_cast<std::uint8_t>(1U << random() % 8);
        break;
      case 1:
        bytes[at] = static_cast<std::uint8_t>(random());
        break;
      case 2:
        bytes.resize(at);
        break;
      case 3:
        bytes.insert(bytes.begin() + static_cast<std::ptrdiff_t>(at), static_cast<std::uint8_t>(random()));
        break;
      default:
        for (auto i = at; i < std::min(at + 8, bytes.size()); ++i)
          bytes[i] = (random() & 1) != 0 ? 0xFF : 0x00;
    }
  }
}

}  // namespace telekerf::fuzz
