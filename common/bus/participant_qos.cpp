// SPDX-License-Identifier: Apache-2.0
#include "common/bus/participant_qos.h"

#include <fmt/format.h>
#include <netdb.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>
#include <fastdds/dds/log/Log.hpp>

#include <charconv>
#include <cstddef>
#include <cstdlib>
#include <mutex>
#include <optional>
#include <random>

#include "common/bus/interfaces.h"
#include "common/bus/middleware.h"
#include "common/bus/qos.h"
#include "common/bus/quiet_log.h"
#include "common/runtime/startup_error.h"

namespace telekerf::bus {
namespace {

namespace dds = middleware::dds;
namespace rtps = middleware::rtps;
using eprosima::fastdds::rtps::TransportDescriptorInterface;
using eprosima::fastdds::rtps::UDPv4TransportDescriptor;

constexpr const char* kDiscoveryMulticast = "239.255.0.1";  // RTPS default
constexpr std::uint32_t kParticipantsPerPeer = 64;          // ports tried at a peer that names none
constexpr int kHighestDomain = 232;                         // ports above would pass 65535
constexpr int kParticipantsPerHost = 120;                   // more would run into the next domain's ports

std::string resolved(const std::string& host) {
  addrinfo hints{};
  hints.ai_family = AF_INET;
  addrinfo* list = nullptr;
  if (getaddrinfo(host.c_str(), nullptr, &hints, &list) != 0 || list == nullptr) {
    throw environment_error(
        fmt::format("peer '{}' has no IPv4 address; check its name or give the address", host));
  }
  char text[NI_MAXHOST] = {};
  getnameinfo(list->ai_addr, list->ai_addrlen, text, sizeof text, nullptr, 0, NI_NUMERICHOST);
  freeaddrinfo(list);
  return text;
}

struct Peer {
  std::string host;
  std::uint32_t port = 0;  ///< 0: every port that a participant of this domain would use
};

std::optional<Peer> parsed_peer(const std::string& text) {
  const std::size_t colon = text.find(':');
  Peer peer{text.substr(0, colon)};
  if (peer.host.empty() || peer.host.find_first_of(" \t") != std::string::npos) return std::nullopt;
  if (colon == std::string::npos) return peer;
  const char* const end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data() + colon + 1, end, peer.port);
  if (error != std::errc() || rest != end || peer.port == 0 || peer.port > 65535) return std::nullopt;
  return peer;
}

/// Of discovery; the next one is that of the data (RTPS 2.x, 9.6.1.1).
int discovery_port(int domain) { return 7400 + 250 * domain; }
int participant_port(int domain, int id) { return discovery_port(domain) + 10 + 2 * id; }

/// `shared`: with others who share it, too.
bool can_be_bound(int port, bool shared) {
  if (port > 65535) return false;
  const int fd = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (fd < 0) return false;
  const int yes = 1;
  if (shared) (void)setsockopt(fd, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  const bool free = bind(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
  close(fd);
  return free;
}

/// A name that only one process of this host has at a time, as long as the descriptor is open; negative:
/// another one has it. It is a socket without a file, so nothing stays behind.
int claimed(const std::string& name) {
  const int fd = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (fd < 0) return fd;
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  name.copy(address.sun_path + 1, sizeof address.sun_path - 1);
  const auto size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + name.size());
  if (bind(fd, reinterpret_cast<const sockaddr*>(&address), size) == 0) return fd;
  close(fd);
  return -1;
}

/// The vendor's two bytes, the site, and nine of chance: unique without asking anybody.
rtps::GuidPrefix_t random_prefix(Site site) {
  std::random_device random;
  rtps::GuidPrefix_t prefix;
  for (auto& byte : prefix.value) byte = static_cast<rtps::octet>(random());
  prefix.value[0] = rtps::c_VendorId_eProsima[0];
  prefix.value[1] = rtps::c_VendorId_eProsima[1];
  prefix.value[kSiteByte] = static_cast<rtps::octet>(site);
  return prefix;
}

}  // namespace
}  // namespace telekerf::bus

namespace telekerf {

std::string complaint_about_peer(const std::string& peer) {
  return bus::parsed_peer(peer) ? "" : "must be HOST or HOST:PORT with a port within [1, 65535]";
}

}  // namespace telekerf

namespace telekerf::bus {

BusSettings validated(BusSettings settings) {
  if (settings.domain < 0 || settings.domain > kHighestDomain) {
    throw usage_error(fmt::format("domain {} is outside [0, {}]", settings.domain, kHighestDomain));
  }
  if (const std::string wrong = complaint_about_cell(settings.cell); !wrong.empty())
    throw usage_error(fmt::format("cell = '{}': {}", settings.cell, wrong));
  if (settings.name.empty()) settings.name = settings.role;
  return settings;
}

void settle_library(bool secured) {
  static std::once_flag once;
  std::call_once(once, [] {
    setenv("SKIP_DEFAULT_XML", "1", 1);
    unsetenv("ROS_DISCOVERY_SERVER");
    dds::Log::SetVerbosity(dds::Log::Error);
  });
  if (secured) quiet_log();
  middleware::deliver_within_a_process(secured);
}

std::shared_ptr<UDPv4TransportDescriptor> udp_transport() {
  auto udp = std::make_shared<UDPv4TransportDescriptor>();
  udp->sendBufferSize = kSocketBufferBytes;
  udp->receiveBufferSize = kSocketBufferBytes;
  udp->non_blocking_send = true;
  udp->maxInitialPeersRange = kParticipantsPerPeer;
  return udp;
}

void require_discovery_port(int domain) {
  if (can_be_bound(discovery_port(domain), true)) return;
  throw environment_error(fmt::format(
      "UDP port {} of domain {}, where processes hear of each other, is in use by another program; end that "
      "program (ss -ulpn names it) or choose another --domain: below 102 no system hands these ports out by "
      "itself",
      discovery_port(domain), domain));
}

ParticipantNumber::ParticipantNumber(int domain) {
  for (int id = 0; id < kParticipantsPerHost; ++id) {
    const int port = participant_port(domain, id);
    if (!can_be_bound(port, false) || !can_be_bound(port + 1, false)) continue;
    // Between this look and the middleware's own socket another one may look, too.
    const int claim = claimed(fmt::format("telekerf/{}", port));
    if (claim < 0) continue;
    value_ = id;
    claim_ = claim;
    return;
  }
}

ParticipantNumber::~ParticipantNumber() {
  if (claim_ >= 0) close(claim_);
}

dds::DomainParticipantQos participant_qos(const BusSettings& settings,
                                          std::shared_ptr<TransportDescriptorInterface> transport,
                                          const std::vector<std::uint8_t>& user_data) {
  dds::DomainParticipantQos qos;
  qos.name(settings.name);
  qos.user_data().data_vec(user_data);
  qos.transport().use_builtin_transports = false;
  qos.transport().user_transports = {std::move(transport)};
  qos.transport().send_socket_buffer_size = kSocketBufferBytes;
  qos.transport().listen_socket_buffer_size = kSocketBufferBytes;
  qos.wire_protocol().prefix = random_prefix(settings.site);

  auto& builtin = qos.wire_protocol().builtin;
  builtin.discovery_config.leaseDuration = milliseconds(5000);
  builtin.discovery_config.leaseDuration_announcementperiod = milliseconds(2000);
  builtin.discovery_config.initial_announcements = {20, milliseconds(100)};
  if (!settings.peers.empty()) {  // naming peers replaces multicast unless it is named too
    rtps::Locator_t locator;
    rtps::IPLocator::createLocator(LOCATOR_KIND_UDPv4, kDiscoveryMulticast, 0, locator);
    builtin.initialPeersList.push_back(locator);
  }
  for (const std::string& peer : settings.peers) {
    const auto named = parsed_peer(peer);
    if (!named) throw usage_error(fmt::format("peers = '{}': {}", peer, complaint_about_peer(peer)));
    rtps::Locator_t locator;
    rtps::IPLocator::createLocator(LOCATOR_KIND_UDPv4, resolved(named->host), named->port, locator);
    builtin.initialPeersList.push_back(locator);
  }
  return qos;
}

std::string address_of(const middleware::Discovery::Discovered& participant) {
  const auto text = [](const rtps::Locator_t& locator) { return rtps::IPLocator::ip_to_string(locator); };
  std::string address = "an unknown address";
  for (const rtps::Locator_t& locator : participant.data_locators.unicast) return text(locator);
  for (const rtps::Locator_t& locator : participant.discovery_locators.unicast) return text(locator);
  return address;
}

void refuse_peers_outside(const BusSettings& settings, const std::vector<std::string>& inner) {
  for (const std::string& peer : settings.peers) {
    const auto named = parsed_peer(peer);
    if (named && lies_outside(resolved(named->host), inner))
      throw usage_error(
          fmt::format("peers = '{}' lies beyond this computer, where nothing is secured: give --security "
                      "DIR, or --insecure if "
                      "whoever is there may command",
                      peer));
  }
}

std::string socket_buffer_note() {
  const int fd = socket(AF_INET, SOCK_DGRAM, 0);
  if (fd < 0) return {};
  std::string note;
  const auto granted = [fd](int option) {
    int bytes = static_cast<int>(kSocketBufferBytes);
    socklen_t size = sizeof bytes;
    setsockopt(fd, SOL_SOCKET, option, &bytes, sizeof bytes);
    getsockopt(fd, SOL_SOCKET, option, &bytes, &size);
    return static_cast<std::uint32_t>(bytes) / 2;  // the kernel counts its bookkeeping in
  };
  const std::uint32_t smaller = std::min(granted(SO_RCVBUF), granted(SO_SNDBUF));
  close(fd);
  if (smaller < kSocketBufferBytes) {
    note = fmt::format(
        "the kernel grants {} kB of socket buffer instead of {} kB, so large contours take several attempts; "
        "remedy: "
        "sysctl -w net.core.rmem_max={} net.core.wmem_max={}",
        smaller >> 10, kSocketBufferBytes >> 10, kSocketBufferBytes, kSocketBufferBytes);
  }
  return note;
}

}  // namespace telekerf::bus
