// SPDX-License-Identifier: Apache-2.0
#include "common/bus/trimming_transport.h"

#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/uio.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <optional>
#include <utility>
#include <vector>

#include "common/bus/participant_qos.h"
#include "common/bus/rtps_message.h"
#include "common/runtime/clock.h"

namespace telekerf::bus {
namespace {

namespace dds_rtps = eprosima::fastdds::rtps;
using middleware::rtps::IPLocator;
using middleware::rtps::Locator_t;
using middleware::rtps::Locators;
using middleware::rtps::LocatorsIterator;
using middleware::rtps::octet;
using middleware::rtps::SenderResource;

// RTPS 2.x, 8.3 and 9.4.
constexpr std::uint8_t kInfoTimestamp = 0x09;
constexpr std::uint8_t kInfoDestination = 0x0e;
constexpr std::uint8_t kStatistics = 0x80;
constexpr std::size_t kStatisticsBytes = 60;

/// Datagrams to one host, without the middleware's sockets. Never waits.
class UnicastSocket {
 public:
  UnicastSocket() : fd_(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
    const int bytes = static_cast<int>(kSocketBufferBytes);
    if (fd_ >= 0) (void)::setsockopt(fd_, SOL_SOCKET, SO_SNDBUF, &bytes, sizeof bytes);
  }
  ~UnicastSocket() {
    if (fd_ >= 0) (void)::close(fd_);
  }
  UnicastSocket(const UnicastSocket&) = delete;
  UnicastSocket& operator=(const UnicastSocket&) = delete;

  bool is_open() const noexcept { return fd_ >= 0; }

  bool send(const TrimmedDatagram& datagram, const Locator_t& to) const noexcept {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(IPLocator::getPhysicalPort(to));
    std::memcpy(&address.sin_addr, IPLocator::getIPv4(to), sizeof address.sin_addr);
    std::array<iovec, 2> parts{part(datagram.head), part(datagram.rest)};
    msghdr message{};
    message.msg_name = &address;
    message.msg_namelen = sizeof address;
    message.msg_iov = parts.data();
    message.msg_iovlen = parts.size();
    // A full buffer drops the datagram, as the middleware's own sockets do.
    return ::sendmsg(fd_, &message, MSG_DONTWAIT | MSG_NOSIGNAL) >= 0 || errno == EAGAIN || errno == ENOBUFS;
  }

 private:
  static iovec part(std::span<const std::byte> bytes) noexcept {
    return {const_cast<std::byte*>(bytes.data()), bytes.size()};  // NOLINT: sendmsg() only reads
  }

  int fd_;
};

struct Descriptor : dds_rtps::ChainingTransportDescriptor {
  Descriptor(std::shared_ptr<dds_rtps::TransportDescriptorInterface> below, std::shared_ptr<Gate> at)
      : ChainingTransportDescriptor(std::move(below)), gate(std::move(at)) {}
  dds_rtps::TransportInterface* create_transport() const override;
  std::shared_ptr<Gate> gate;
};

class Transport : public dds_rtps::ChainingTransport {
 public:
  explicit Transport(const Descriptor& descriptor)
      : ChainingTransport(descriptor), descriptor_(descriptor.low_level_descriptor), gate_(descriptor.gate) {}

  dds_rtps::TransportDescriptorInterface* get_configuration() override { return descriptor_.get(); }

  /// Called once for each of the sockets below (an interface each), always with the same bytes and addresses.
  /// A participant sends one datagram at a time.
  bool send(SenderResource* below, middleware::Datagram whole, std::uint32_t size, LocatorsIterator* begin,
            LocatorsIterator* end, const std::chrono::steady_clock::time_point& timeout) override {
    const std::span<const std::byte> bytes = middleware::in_one_piece(whole, size, room_);
    if (!unicast_.is_open() || bytes.empty()) return below->send(whole, size, begin, end, timeout);
    SenderResource* first = nullptr;
    const bool leads = first_.compare_exchange_strong(first, below) || first == below;
    bool sent = true;
    const TrimmedDatagram datagram = trimmed(bytes);
    for (; !(*begin == *end); ++*begin) {
      if (IPLocator::isMulticast(**begin)) {
        const std::vector<Locator_t> address(1, **begin);  // discovery's alone
        Locators at(address.begin());
        Locators behind(address.end());
        sent = below->send(whole, size, &at, &behind, timeout) && sent;
      } else if (leads) {
        sent = unicast_.send(datagram, **begin) && sent;
      }
    }
    return sent;
  }

  void receive(dds_rtps::TransportReceiverInterface* next, const octet* buffer, std::uint32_t size,
               const Locator_t& local, const Locator_t& remote) override {
    if (gate_) {
      std::uint32_t from = 0;
      std::memcpy(&from, IPLocator::getIPv4(remote), sizeof from);
      if (!gate_->admits(std::as_bytes(std::span(buffer, size)), from, monotonic_ns())) return;
    }
    next->OnDataReceived(buffer, size, local, remote);
  }

 private:
  std::shared_ptr<dds_rtps::TransportDescriptorInterface> descriptor_;
  std::shared_ptr<Gate> gate_;
  UnicastSocket unicast_;
  std::vector<std::byte> room_ = std::vector<std::byte>(middleware::kDatagramRoom);
  std::atomic<SenderResource*> first_{nullptr};
};

dds_rtps::TransportInterface* Descriptor::create_transport() const { return new Transport(*this); }

}  // namespace

TrimmedDatagram trimmed(std::span<const std::byte> datagram) noexcept {
  const TrimmedDatagram whole{datagram, {}};
  if (!is_rtps(datagram)) return whole;
  std::size_t end = datagram.size();
  std::optional<std::size_t>
      stream;  // of the first submessage that is no address or stamp, if it is a stream's
  bool only_addressed = true;
  for (std::size_t at = kRtpsHeader; at < datagram.size();) {
    const auto part = submessage(datagram, at);
    if (!part) return whole;
    const std::uint8_t kind = octet_at(*part, 0);
    if (kind == kStatistics && part->size() == kStatisticsBytes && at + part->size() == datagram.size())
      end = at;
    if (only_addressed && is_stream_data(*part)) stream = at;
    only_addressed = only_addressed && (kind == kInfoDestination || kind == kInfoTimestamp);
    at += part->size();
  }
  if (end == kRtpsHeader) return whole;
  if (!stream) return {datagram.first(end), {}};
  return {datagram.first(kRtpsHeader), datagram.subspan(*stream, end - *stream)};
}

std::shared_ptr<dds_rtps::TransportDescriptorInterface> trimming_over(
    std::shared_ptr<dds_rtps::TransportDescriptorInterface> below, std::shared_ptr<Gate> gate) {
  return std::make_shared<Descriptor>(std::move(below), std::move(gate));
}

}  // namespace telekerf::bus
