// SPDX-License-Identifier: Apache-2.0
// A pedal that sends datagrams: the smallest OperatorInput, to copy from. For one host or a wire of its own:
// against a stranger's datagrams there is the seal alone (common/runtime/datagram_seal.h), if both ends have
// its key.
#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/udp.hpp>
#include <cstdint>
#include <memory>
#include <string_view>

#include "common/runtime/datagram_seal.h"
#include "common/runtime/udp.h"
#include "master/operator/operator_input.h"
#include "master/operator/operator_lease.h"

namespace telekerf::master {

/// Pedal -> master every 50 ms or more often, and at once when it changes. Little endian.
struct UdpButton {
  static constexpr std::uint32_t kMagic = 0x42554b54;
  static constexpr std::uint32_t kVersion = 1;
  std::uint32_t magic = kMagic;
  std::uint32_t version = kVersion;
  std::uint64_t sequence = 0;  ///< from 1, more each time
  static constexpr std::uint32_t kHeld = 1;
  static constexpr std::uint32_t kSqueezed = 2;
  std::uint32_t held = 0;  ///< kHeld; kSqueezed, as in fright: an emergency stop; all else: released
  std::uint32_t reserved = 0;
};

/// Held by a lease (operator_lease.h): who holds it down while the line comes back must press it anew, and so
/// must who has squeezed it.
class UdpFootSwitch final : public OperatorInput {
 public:
  /// `address`: of this host, where the pedal's datagrams arrive; port 0: any free one. Throws StartupError.
  explicit UdpFootSwitch(const UdpAddress& address);
  OperatorSample sample(std::int64_t now_ns) noexcept override;
  /// Datagrams of another seal, length or kind, or of a second pedal.
  std::uint64_t refused() const noexcept override { return refused_; }

  std::uint16_t port() const { return socket_.local_endpoint().port(); }

 private:
  /// False: it is a stranger's.
  bool hear(const UdpButton& told, const boost::asio::ip::udp::endpoint& from, std::int64_t now_ns) noexcept;

  boost::asio::io_context context_;
  boost::asio::ip::udp::socket socket_;
  DatagramSeal seal_;
  boost::asio::ip::udp::endpoint pedal_;  ///< the one that is heard
  OperatorLease lease_;
  std::uint32_t newest_ = 0;  ///< what it said last
  bool squeezed_ = false;     ///< since it was released
  bool stop_ = false;         ///< of this step
  std::uint64_t refused_ = 0;
};

/// `rest`: HOST:PORT, as the user wrote it. Throws StartupError.
std::unique_ptr<OperatorInput> open_udp_foot_switch(std::string_view rest);

}  // namespace telekerf::master
