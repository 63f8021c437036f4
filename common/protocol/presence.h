// SPDX-License-Identifier: Apache-2.0
// Who is in the cell.
#pragma once

#include <cstdint>
#include <string>

namespace telekerf {

/// Who a process is; every participant announces it and `Bus` keeps the list of the others.
struct PresenceMessage {
  std::uint16_t contract = 0;
  std::string cell;
  std::string role;  ///< master, slave, vision, console, ...
  std::string name;  ///< unique in the cell
  std::uint32_t epoch = 0;
  bool joined = false;  ///< false while it looks for others before joining
  std::string version;
};

}  // namespace telekerf
