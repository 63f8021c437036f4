// SPDX-License-Identifier: Apache-2.0
#include "netem/drivers/tun.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <linux/if_tun.h>
#include <net/if.h>
#include <net/route.h>
#include <sched.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <cstring>

#include "common/runtime/startup_error.h"

namespace telekerf::netem {
namespace {

class Descriptor {
 public:
  explicit Descriptor(int fd) : fd_(fd) {}
  ~Descriptor() {
    if (fd_ >= 0) ::close(fd_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int get() const { return fd_; }
  int release() {
    const int fd = fd_;
    fd_ = -1;
    return fd;
  }

 private:
  int fd_;
};

[[noreturn]] void refuse(const std::string& what, int error) {
  if (error == EPERM || error == EACCES) {
    throw environment_error(fmt::format(
        "{}: not permitted; run as root, or inside `unshare --user --map-root-user --net`", what));
  }
  throw environment_error(fmt::format("{}: {}", what, std::strerror(error)));
}

/// Moves the calling thread into a network namespace for as long as this lives.
class NamespaceVisit {
 public:
  explicit NamespaceVisit(const std::string& netns)
      : home_(::open("/proc/self/ns/net", O_RDONLY | O_CLOEXEC)) {
    if (netns.empty()) return;
    const std::string path = netns.find('/') == std::string::npos ? "/run/netns/" + netns : netns;
    const Descriptor target(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
    if (target.get() < 0 && errno == ENOENT && path != netns) {
      throw environment_error(
          fmt::format("no network namespace '{}'; make it with `ip netns add {}`", netns, netns));
    }
    if (target.get() < 0) refuse(fmt::format("opening the network namespace '{}'", netns), errno);
    if (::setns(target.get(), CLONE_NEWNET) != 0)
      refuse(fmt::format("entering the namespace '{}'", netns), errno);
    moved_ = true;
  }
  ~NamespaceVisit() {
    if (moved_) (void)::setns(home_.get(), CLONE_NEWNET);
  }
  NamespaceVisit(const NamespaceVisit&) = delete;
  NamespaceVisit& operator=(const NamespaceVisit&) = delete;

 private:
  Descriptor home_;
  bool moved_ = false;
};

struct Address {
  in_addr host{};
  in_addr mask{};
};

Address parse_address(const std::string& text) {
  const auto slash = text.find('/');
  Address address;
  int bits = 0;
  const char* const end = text.data() + text.size();
  const bool good = slash != std::string::npos &&
                    ::inet_pton(AF_INET, text.substr(0, slash).c_str(), &address.host) == 1 &&
                    std::from_chars(text.data() + slash + 1, end, bits).ptr == end && bits >= 1 && bits <= 32;
  if (!good)
    throw usage_error(fmt::format("'{}' is no address with prefix length, such as 10.77.0.1/24", text));
  address.mask.s_addr = htonl(0xFFFFFFFFU << (32 - bits));
  return address;
}

void put_address(sockaddr& where, in_addr address) {
  sockaddr_in in{};
  in.sin_family = AF_INET;
  in.sin_addr = address;
  std::memcpy(&where, &in, sizeof(where));
}

void configure(const TunSettings& settings) {
  const Descriptor socket(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  const auto control = [&](unsigned long request, void* argument, const char* what) {
    if (::ioctl(socket.get(), request, argument) != 0)
      refuse(fmt::format("{} of {}", what, settings.device), errno);
  };
  ifreq request{};
  std::strncpy(request.ifr_name, settings.device.c_str(), IFNAMSIZ - 1);
  request.ifr_mtu = kTunMtu;
  control(SIOCSIFMTU, &request, "size limit");
  constexpr int kQueue_packets = 10'000;  // the emulator shall lose packets, not the kernel's queue before it
  request.ifr_qlen = kQueue_packets;
  control(SIOCSIFTXQLEN, &request, "queue length");
  if (!settings.address.empty()) {
    const Address address = parse_address(settings.address);
    put_address(request.ifr_addr, address.host);
    control(SIOCSIFADDR, &request, "address");
    put_address(request.ifr_netmask, address.mask);
    control(SIOCSIFNETMASK, &request, "netmask");
  }
  control(SIOCGIFFLAGS, &request, "flags");
  request.ifr_flags |= IFF_UP | IFF_MULTICAST;
  control(SIOCSIFFLAGS, &request, "start");
  if (settings.default_route) {
    rtentry route{};
    put_address(route.rt_dst, {});
    put_address(route.rt_genmask, {});
    std::string device = settings.device;
    route.rt_dev = device.data();
    route.rt_flags = RTF_UP;
    control(SIOCADDRT, &route, "default route");
  }
}

}  // namespace

int open_tun(const TunSettings& settings) {
  if (settings.device.empty() || settings.device.size() >= IFNAMSIZ) {
    throw environment_error(
        fmt::format("'{}' is no device name: 1 to {} characters", settings.device, IFNAMSIZ - 1));
  }
  const NamespaceVisit visit(settings.netns);
  Descriptor tun(::open("/dev/net/tun", O_RDWR | O_NONBLOCK | O_CLOEXEC));
  if (tun.get() < 0 && (errno == ENOENT || errno == ENODEV)) {
    throw environment_error(
        "this kernel has no TUN devices (/dev/net/tun); load the module `tun`, or use --netem in the "
        "processes");
  }
  if (tun.get() < 0) refuse("opening /dev/net/tun", errno);
  ifreq request{};
  std::strncpy(request.ifr_name, settings.device.c_str(), IFNAMSIZ - 1);
  request.ifr_flags = IFF_TUN | IFF_NO_PI;
  if (::ioctl(tun.get(), TUNSETIFF, &request) != 0) {
    refuse(fmt::format("creating the TUN device {}", settings.device), errno);
  }
  configure(settings);
  return tun.release();
}

}  // namespace telekerf::netem
