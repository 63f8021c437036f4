// SPDX-License-Identifier: Apache-2.0
// What the bus makes of a sample that arrived. Inside the bus only.
#pragma once

#include <cstdint>

namespace telekerf::bus {

enum class Verdict : std::uint8_t {
  kGood,
  kDamaged,          ///< checksum, an unknown enumerator, a broken bound or no number
  kForeignContract,  ///< written under another version of the contract
};

}  // namespace telekerf::bus
