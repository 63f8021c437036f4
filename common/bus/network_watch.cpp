// SPDX-License-Identifier: Apache-2.0
#include "common/bus/network_watch.h"

#include <arpa/inet.h>
#include <ifaddrs.h>
#include <net/if.h>
#include <netinet/in.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <utility>

namespace telekerf {
namespace {

constexpr std::chrono::milliseconds kNap{50};
constexpr int kNaps = 10;  // between two looks

}  // namespace

std::set<std::string> network_addresses() {
  ifaddrs* first = nullptr;
  if (getifaddrs(&first) != 0) return {};
  std::set<std::string> addresses;
  for (const ifaddrs* at = first; at != nullptr; at = at->ifa_next) {
    const bool counts =
        at->ifa_addr != nullptr && at->ifa_addr->sa_family == AF_INET && (at->ifa_flags & IFF_LOOPBACK) == 0;
    if (!counts) continue;
    std::array<char, INET_ADDRSTRLEN> text{};
    const auto* const address = reinterpret_cast<const sockaddr_in*>(at->ifa_addr);
    if (inet_ntop(AF_INET, &address->sin_addr, text.data(), text.size()) != nullptr)
      addresses.insert(text.data());
  }
  freeifaddrs(first);
  return addresses;
}

NetworkWatch::NetworkWatch(std::function<void(bool)> changed)
    : known_(network_addresses()), thread_([this, changed = std::move(changed)](const std::stop_token& stop) {
        for (int n = 1; !stop.stop_requested(); ++n) {
          std::this_thread::sleep_for(kNap);
          if (n % kNaps != 0) continue;
          std::set<std::string> now = network_addresses();
          if (now == known_) continue;
          const bool lost =
              known_.empty() || !std::includes(now.begin(), now.end(), known_.begin(), known_.end());
          known_ = std::move(now);
          changed(lost);
        }
      }) {}

}  // namespace telekerf
