// SPDX-License-Identifier: Apache-2.0
#include "common/protocol/contour.h"

#include <algorithm>
#include <cstring>

namespace telekerf {
namespace {

/// FNV-1a over one line after the other.
std::uint32_t digest_of(bool closed, const std::vector<Vec2>& points_m, std::uint32_t hash) {
  if (!closed) hash ^= 1U;
  for (const Vec2& p : points_m) {
    for (const double value : {p.x(), p.y()}) {
      std::uint64_t bits = 0;
      std::memcpy(&bits, &value, sizeof bits);
      for (int byte = 0; byte < 8; ++byte)
        hash = (hash ^ static_cast<unsigned char>(bits >> (8 * byte))) * 16777619U;
    }
  }
  return hash;
}

}  // namespace

std::uint32_t digest_of(const ContourMessage& message) {
  std::uint32_t hash = digest_of(message.closed, message.points_m, 2166136261U);
  for (const ContourLine& line : message.further) hash = digest_of(line.closed, line.points_m, hash);
  return std::max(1U, hash);
}

}  // namespace telekerf
