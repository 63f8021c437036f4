// SPDX-License-Identifier: Apache-2.0
#include "common/bus/network_watch.h"

#include <arpa/inet.h>
#include <ifaddrs.h>
#include <net/if.h>
#include <netinet/in.h>

#include <array>
#include <chrono>
#include <utility>

namespace telekerf {
namespace {

constexpr std::chrono::milliseconds kNap{50};
constexpr int kNaps = 10;  // between two looks

}  // namespace

std::string network_addresses() {
  ifaddrs* first = nullptr;
  if (getifaddrs(&first) != 0) return {};
  std::string addresses;
  for (const ifaddrs* at = first; at != nullptr; at = at->ifa_next) {
    if (at->ifa_addr == nullptr || at->ifa_addr->sa_family != AF_INET || (at->ifa_flags & IFF_UP) == 0)
      continue;
    std::array<char, INET_ADDRSTRLEN> text{};
    const auto* const address = reinterpret_cast<const sockaddr_in*>(at->ifa_addr);
    if (inet_ntop(AF_INET, &address->sin_addr, text.data(), text.size()) == nullptr) continue;
    addresses += std::string(at->ifa_name) + " " + text.data() + "\n";
  }
  freeifaddrs(first);
  return addresses;
}

NetworkWatch::NetworkWatch(std::function<void()> changed)
    : known_(network_addresses()), thread_([this, changed = std::move(changed)](const std::stop_token& stop) {
        for (int n = 1; !stop.stop_requested(); ++n) {
          std::this_thread::sleep_for(kNap);
          if (n % kNaps != 0) continue;
          std::string now = network_addresses();
          if (now == known_) continue;
          known_ = std::move(now);
          changed();
        }
      }) {}

}  // namespace telekerf
