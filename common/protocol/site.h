// SPDX-License-Identifier: Apache-2.0
// The two sites. A byte of every participant's GUID prefix names its site, so that a datagram's origin is
// known below DDS (the prefix stands in every RTPS header, at offset 8). DDS Security chooses the prefix itself, from the
// name in the certificate: then a table tells.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace telekerf {

enum class Site : std::uint8_t { kOperator = 0x6d, kSlave = 0x73 };

/// Index into the 12 bytes of the GUID prefix.
inline constexpr int kSiteByte = 2;

/// First octets of the entity ids of stream writers are 0 and this, so that a stream's sample is known as
/// such below DDS, too. No other writer of a process gets there by counting.
inline constexpr std::uint8_t kStreamEntity = 0x53;

class SiteTable {
 public:
  struct Row {
    std::array<std::uint8_t, 6> begin;  ///< of the prefix
    Site site;
  };

  /// By the site byte.
  SiteTable() = default;
  /// By these alone.
  explicit SiteTable(std::vector<Row> rows) : rows_(std::move(rows)) {}

  /// nullopt: of neither site. `prefix`: a whole one.
  std::optional<Site> site_of(std::span<const std::byte> prefix) const noexcept {
    if (rows_.empty()) {
      const auto site = static_cast<Site>(prefix[kSiteByte]);
      return site == Site::kOperator || site == Site::kSlave ? std::optional(site) : std::nullopt;
    }
    for (const Row& row : rows_) {
      if (std::equal(row.begin.begin(), row.begin.end(), prefix.begin(),
                     [](std::uint8_t a, std::byte b) { return std::byte{a} == b; }))
        return row.site;
    }
    return std::nullopt;
  }

 private:
  std::vector<Row> rows_;
};

}  // namespace telekerf
