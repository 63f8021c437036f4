// SPDX-License-Identifier: Apache-2.0
// Which of this computer's networks lead out of it. Inside the bus only.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace telekerf::bus {

/// `address`: IPv4, network order.
std::string dotted(std::uint32_t address);

/// IPv4 addresses at which only this computer can be reached: its own loopback, and virtual cables between
/// its namespaces (veth, tun, dummy). Empty: no other network is there, so that nothing has to be left out.
std::vector<std::string> inner_addresses();

/// Whether a datagram to this IPv4 address would leave through another network than those.
bool lies_outside(const std::string& address, const std::vector<std::string>& inner);

}  // namespace telekerf::bus
