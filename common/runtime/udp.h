// SPDX-License-Identifier: Apache-2.0
// What all devices behind a UDP address share: HOST:PORT as users write it, with the key that seals their
// datagrams, and a socket that never waits.
#pragma once

#include <boost/asio/buffer.hpp>
#include <boost/asio/ip/udp.hpp>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace telekerf {

struct UdpAddress {
  std::string host;
  std::uint16_t port = 0;  ///< 0: none was given, or none that there is
  std::string key = {};    ///< file, see datagram_seal.h; empty: datagrams are not sealed
};

/// HOST:PORT or HOST:PORT,key=FILE
UdpAddress udp_address(std::string_view text);
/// What an address must be, if it is not; empty: it is. validate_udp(): of a device that knows no seal.
std::string validate_udp(std::string_view text);
std::string validate_sealed_udp(std::string_view text);

/// A datagram that arrives, with room for an octet more than it may have: a longer one would be cut to its
/// length, and taken for it.
template <class Datagram>
struct Arrival {
  Datagram datagram;
  std::byte more{};
  auto room() noexcept { return boost::asio::buffer(static_cast<void*>(this), sizeof(Datagram) + 1); }
};

/// Opens `socket` so that it never waits, and finds the address (IPv4). `key`: the setting that names the
/// device. Throws StartupError.
boost::asio::ip::udp::endpoint open_udp(boost::asio::ip::udp::socket& socket, const UdpAddress& address,
                                        std::string_view key);

/// "drive = udp:127.0.0.1:7000: what is wrong; remedy"
[[noreturn]] void refuse_udp(const UdpAddress& address, std::string_view key, std::string_view wrong,
                             std::string_view remedy);

}  // namespace telekerf
