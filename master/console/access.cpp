// SPDX-License-Identifier: Apache-2.0
#include "master/console/access.h"

#include <fmt/format.h>

#include <boost/asio/ip/address.hpp>
#include <random>

namespace telekerf::master {

bool host_allowed(std::string_view host, std::string_view name, unsigned port) {
  const std::size_t bracket = host.rfind(']');
  const std::size_t colon = host.rfind(':');
  std::string_view address = host;
  if (colon != host.npos && (bracket == host.npos || colon > bracket)) {
    if (host.substr(colon + 1) != std::to_string(port)) return false;
    address = host.substr(0, colon);
  } else if (port != 80 && port != 443) {
    return false;
  }
  if (address == "localhost" || (!name.empty() && address == name)) return true;
  if (address.starts_with('[') && address.ends_with(']')) address = address.substr(1, address.size() - 2);
  boost::system::error_code error;
  (void)boost::asio::ip::make_address(std::string(address), error);
  return !error;
}

bool origin_allowed(std::string_view origin, std::string_view scheme, std::string_view host) {
  return origin.empty() || origin == fmt::format("{}://{}", scheme, host);
}

bool token_matches(std::string_view token, std::string_view given) noexcept {
  if (token.empty() || token.size() != given.size()) return false;
  unsigned difference = 0;
  for (std::size_t i = 0; i < token.size(); ++i)
    difference |= static_cast<unsigned char>(token[i]) ^ static_cast<unsigned char>(given[i]);
  return difference == 0;
}

std::string new_token() {
  std::random_device random;
  std::string token;
  for (int i = 0; i < 4; ++i) token += fmt::format("{:08x}", random());
  return token;
}

std::string warning_of(const std::string& bind, bool encrypted, bool token_given) {
  boost::system::error_code error;
  const auto address = boost::asio::ip::make_address(bind, error);
  if (error || address.is_loopback() || encrypted) return {};
  return fmt::format(
      "warning: bind = {}, unencrypted: anyone in that network may watch and stop the cell, and {}; --tls-cert and "
      "--tls-key encrypt it, {}--bind 127.0.0.1 serves this computer alone",
      bind,
      token_given ? "who reads along learns the token and drives" : "who changes what passes may speak for a page",
      token_given ? "" : "--token TEXT lets drive whom you tell it, ");
}

}  // namespace telekerf::master
