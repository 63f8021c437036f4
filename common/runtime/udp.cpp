// SPDX-License-Identifier: Apache-2.0
#include "common/runtime/udp.h"

#include <fmt/format.h>

#include <charconv>

#include "common/runtime/startup_error.h"

namespace telekerf {

using boost::asio::ip::udp;

UdpAddress udp_address(std::string_view text) {
  constexpr std::string_view kKey = ",key=";
  std::string key;
  if (const std::size_t at = text.find(kKey); at != text.npos) {
    key = text.substr(at + kKey.size());
    text = text.substr(0, at);
  }
  const std::size_t colon = text.rfind(':');
  if (colon == text.npos) return {std::string(text)};
  UdpAddress address{std::string(text.substr(0, colon)), 0, key};
  const std::string_view digits = text.substr(colon + 1);
  const auto [end, error] = std::from_chars(digits.begin(), digits.end(), address.port);
  if (error != std::errc() || end != digits.end()) address.port = 0;
  return address;
}

std::string validate_udp(std::string_view text) {
  if (!udp_address(text).key.empty()) return "this device's datagrams know no seal: leave ,key= out";
  return validate_sealed_udp(text);
}

std::string validate_sealed_udp(std::string_view text) {
  const UdpAddress address = udp_address(text);
  if (text.find(",key=") != text.npos && address.key.empty()) return "key needs a file: ./telekerf keys makes one";
  if (!address.host.empty() && address.port != 0) return "";
  return "udp needs a host and a port within [1, 65535], as in udp:127.0.0.1:7000";
}

void refuse_udp(const UdpAddress& address, std::string_view key, std::string_view wrong,
                std::string_view remedy) {
  throw hardware_error(fmt::format("{} = udp:{}:{}: {}; {}", key, address.host, address.port, wrong, remedy));
}

udp::endpoint open_udp(udp::socket& socket, const UdpAddress& address, std::string_view key) {
  boost::system::error_code error;
  udp::resolver resolver(socket.get_executor());
  const auto found = resolver.resolve(udp::v4(), address.host, std::to_string(address.port), error);
  if (error || found.empty()) {
    refuse_udp(address, key, error.message(), "give the host's IPv4 address or a name that it is known by");
  }
  socket.open(udp::v4(), error);
  if (!error) socket.non_blocking(true, error);
  if (error) refuse_udp(address, key, error.message(), "close what holds so many sockets");
  return found.begin()->endpoint();
}

}  // namespace telekerf
