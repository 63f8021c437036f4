// SPDX-License-Identifier: Apache-2.0
#include "common/bus/network_watch.h"

#include <ifaddrs.h>
#include <net/if.h>
#include <netinet/in.h>

#include <algorithm>
#include <chrono>
#include <iterator>
#include <utility>

#include "common/bus/interfaces.h"

namespace telekerf {
namespace {

constexpr std::chrono::milliseconds kNap{50};
constexpr int kNaps = 10;  // between two looks

struct Addresses {
  std::set<std::string> all;
  std::set<std::string> linked;  ///< of an interface that is up, and has a link
};

Addresses look() {
  ifaddrs* first = nullptr;
  if (getifaddrs(&first) != 0) return {};
  Addresses addresses;
  for (const ifaddrs* at = first; at != nullptr; at = at->ifa_next) {
    const bool counts =
        at->ifa_addr != nullptr && at->ifa_addr->sa_family == AF_INET && (at->ifa_flags & IFF_LOOPBACK) == 0;
    if (!counts) continue;
    const std::string text = bus::dotted(reinterpret_cast<const sockaddr_in*>(at->ifa_addr)->sin_addr.s_addr);
    addresses.all.insert(text);
    constexpr unsigned kLink = IFF_UP | IFF_RUNNING;
    if ((at->ifa_flags & kLink) == kLink) addresses.linked.insert(text);
  }
  freeifaddrs(first);
  return addresses;
}

/// Those with a link, and of those before the ones that are there: a link that is down for a while changes nothing.
std::set<std::string> in_use(const std::set<std::string>& before) {
  Addresses now = look();
  std::set_intersection(now.all.begin(), now.all.end(), before.begin(), before.end(),
                        std::inserter(now.linked, now.linked.end()));
  return std::move(now.linked);
}

}  // namespace

std::set<std::string> network_addresses() { return look().all; }

NetworkWatch::NetworkWatch(std::function<void(bool)> changed)
    : known_(in_use({})), thread_([this, changed = std::move(changed)](const std::stop_token& stop) {
        std::set<std::string> before = known_;
        for (int n = 1; !stop.stop_requested(); ++n) {
          std::this_thread::sleep_for(kNap);
          if (n % kNaps != 0) continue;
          std::set<std::string> now = in_use(known_);
          if (now == known_) continue;
          if (now != before) {  // looked at once more after a nap: what comes up comes in pieces
            before = std::move(now);
            n = kNaps - 1;
            continue;
          }
          const bool lost =
              known_.empty() || !std::includes(now.begin(), now.end(), known_.begin(), known_.end());
          known_ = std::move(now);
          changed(lost);
        }
      }) {}

}  // namespace telekerf
