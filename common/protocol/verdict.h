// SPDX-License-Identifier: Apache-2.0
// What a receiver makes of a message that arrived, before any node sees it.
#pragma once

#include <cstdint>

namespace telekerf {

enum class Verdict : std::uint8_t {
  kGood,
  kDamaged,          ///< checksum, an unknown enumerator, a broken bound or no number
  kForeignContract,  ///< written under another version of the contract
  kUnknownSet,       ///< refers to what an earlier block said, and that has not come (header_compression.h)
};

}  // namespace telekerf
