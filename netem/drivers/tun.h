// SPDX-License-Identifier: Apache-2.0
// A TUN device: whatever IP packet the kernel routes to it can be read, whatever is written to it has
// arrived.
#pragma once

#include <string>

namespace telekerf::netem {

struct TunSettings {
  std::string device;  ///< name, at most 15 characters
  std::string netns;  ///< name under /run/netns, or a path such as /proc/PID/ns/net; empty: this process' own
  std::string address;  ///< "10.77.0.1/24"; empty: the caller configures the device
  bool default_route = false;
};

/// Creates the device inside the namespace, gives it its address and brings it up; the namespace of the
/// calling thread is unchanged afterwards. The device vanishes when the descriptor is closed. Returns a
/// non-blocking descriptor. Throws StartupError: no TUN support, no permission, unknown namespace, bad
/// address.
int open_tun(const TunSettings& settings);

inline constexpr int kTunMtu = 1500;

}  // namespace telekerf::netem
