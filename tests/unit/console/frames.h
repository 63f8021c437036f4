// SPDX-License-Identifier: Apache-2.0
// What pages send, for tests.
#pragma once

#include <cstring>
#include <span>
#include <string>

#include "master/console/page_protocol.h"

namespace telekerf::master::testing {

inline std::span<const std::byte> bytes_of(const PageFrame& frame) {
  return std::as_bytes(std::span(&frame, 1));
}

/// A number of a state message, by its name's place.
inline float field_of(const std::string& state, std::size_t place) {
  float value = 0.0F;
  std::memcpy(&value, state.data() + 24 + 4 * place, sizeof(value));
  return value;
}

}  // namespace telekerf::master::testing
