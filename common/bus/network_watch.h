// SPDX-License-Identifier: Apache-2.0
// Notices that this computer's addresses have changed: a cable, a radio link, a network that comes up late.
#pragma once

#include <functional>
#include <string>
#include <thread>

namespace telekerf {

/// The addresses of all interfaces that are up, one a line, in their order. Empty: none, or the system does not
/// tell.
std::string network_addresses();

class NetworkWatch {
 public:
  /// `changed` is called from a thread of the watch's own within a second after they have become others.
  explicit NetworkWatch(std::function<void()> changed);

 private:
  std::string known_;
  std::jthread thread_;
};

}  // namespace telekerf
