// SPDX-License-Identifier: Apache-2.0
// Notices that this computer's addresses have changed: a cable, a radio link, a network that comes up late.
#pragma once

#include <functional>
#include <set>
#include <string>
#include <thread>

namespace telekerf {

/// The IPv4 addresses of all interfaces, without those by which a computer speaks to itself. One that is down
/// for a while keeps its own. Empty: none, or the system does not tell.
std::set<std::string> network_addresses();

class NetworkWatch {
 public:
  /// `changed` is called from a thread of the watch's own within a second after they have become others. An address
  /// counts from when its interface first has a link: nothing can be heard there before.
  /// `lost`: one of those before is gone, or there was none but this computer's own.
  explicit NetworkWatch(std::function<void(bool lost)> changed);

 private:
  std::set<std::string> known_;
  std::jthread thread_;
};

}  // namespace telekerf
