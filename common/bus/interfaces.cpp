// SPDX-License-Identifier: Apache-2.0
#include "common/bus/interfaces.h"

#include <arpa/inet.h>
#include <ifaddrs.h>
#include <linux/ethtool.h>
#include <linux/sockios.h>
#include <net/if.h>
#include <netinet/in.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>

namespace telekerf::bus {
namespace {

constexpr std::uint16_t kDiscard = 9;  // nothing is sent there

/// The driver's name; empty: it does not tell.
std::string driver_of(int fd, const char* interface) {
  ethtool_drvinfo info{};
  info.cmd = ETHTOOL_GDRVINFO;
  ifreq request{};
  std::strncpy(request.ifr_name, interface, sizeof request.ifr_name - 1);
  request.ifr_data = reinterpret_cast<char*>(&info);
  if (ioctl(fd, SIOCETHTOOL, &request) != 0) return "";
  return info.driver;
}

bool leads_nowhere(int fd, const ifaddrs& interface) {
  if ((interface.ifa_flags & IFF_LOOPBACK) != 0) return true;
  const std::string driver = driver_of(fd, interface.ifa_name);
  return driver == "veth" || driver == "tun" || driver == "dummy";
}

std::string text_of(const sockaddr* address) {
  return dotted(reinterpret_cast<const sockaddr_in*>(address)->sin_addr.s_addr);
}

}  // namespace

std::string dotted(std::uint32_t address) {
  std::array<char, INET_ADDRSTRLEN> text{};
  (void)inet_ntop(AF_INET, &address, text.data(), text.size());
  return text.data();
}

std::vector<std::string> inner_addresses() {
  std::vector<std::string> inner;
  bool outer = false;
  ifaddrs* first = nullptr;
  const int fd = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (fd < 0 || getifaddrs(&first) != 0) {
    if (fd >= 0) close(fd);
    return {"127.0.0.1"};
  }
  for (const ifaddrs* at = first; at != nullptr; at = at->ifa_next) {
    if (at->ifa_addr == nullptr || at->ifa_addr->sa_family != AF_INET) continue;
    if (leads_nowhere(fd, *at)) {
      inner.push_back(text_of(at->ifa_addr));
    } else {
      outer = true;
    }
  }
  freeifaddrs(first);
  close(fd);
  return outer ? inner : std::vector<std::string>{};
}

bool lies_outside(const std::string& address, const std::vector<std::string>& inner) {
  const int fd = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (fd < 0) return false;
  sockaddr_in there{};
  there.sin_family = AF_INET;
  there.sin_port = htons(kDiscard);
  sockaddr_in here{};
  socklen_t size = sizeof here;
  const bool routed = inet_pton(AF_INET, address.c_str(), &there.sin_addr) == 1 &&
                      connect(fd, reinterpret_cast<const sockaddr*>(&there), sizeof there) == 0 &&
                      getsockname(fd, reinterpret_cast<sockaddr*>(&here), &size) == 0;
  close(fd);
  if (!routed) return false;  // there is no way to it at all
  return std::find(inner.begin(), inner.end(), text_of(reinterpret_cast<const sockaddr*>(&here))) ==
         inner.end();
}

}  // namespace telekerf::bus
