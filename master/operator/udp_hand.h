// SPDX-License-Identifier: Apache-2.0
// A hand that sends datagrams: the console's, or a program's of your own. For one host or a wire of its own;
// there is no protection against a stranger's datagrams.
#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/udp.hpp>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "common/runtime/udp.h"
#include "master/operator/operator_input.h"
#include "master/operator/operator_lease.h"

namespace telekerf::master {

/// Where the console and the master on one host meet, unless they are told otherwise.
inline constexpr const char* kBrowserHand = "127.0.0.1:8080";

/// Hand -> master, on every movement and every 20 ms while it holds; once "released" at least before it
/// holds. Little endian.
struct UdpHandFrame {
  static constexpr std::uint32_t kMagic = 0x48544b54;
  static constexpr std::uint32_t kVersion = 1;
  static constexpr std::uint32_t kHeld = 1, kTrigger = 2;
  std::uint32_t magic = kMagic;
  std::uint32_t version = kVersion;
  std::uint32_t session = 0;   ///< another number for another hand
  std::uint32_t flags = 0;     ///< kHeld, kTrigger
  std::uint64_t sequence = 0;  ///< from 1 in each session, more each time
  std::int64_t sent_ns = 0;    ///< sender's clock
  double x_m = 0.0;            ///< where it pulls, on the contour as it was published
  double y_m = 0.0;
};

/// Master -> hand, of every control step in which a frame counted or a hold ended.
struct UdpHandAnswer {
  static constexpr std::uint32_t kMagic = 0x41544b54;
  static constexpr std::uint32_t kHeld = 1, kTrigger = 2, kGuided = 4;
  std::uint32_t magic = kMagic;
  std::uint32_t version = UdpHandFrame::kVersion;
  std::uint32_t session = 0;
  std::uint32_t flags = 0;     ///< what holds in this step
  std::uint64_t sequence = 0;  ///< of the newest frame
  std::int64_t step_ns = 0;    ///< of the step, master's monotonic clock
  double x_m = 0.0;            ///< of the tool, on the contour as it was published
  double y_m = 0.0;
  double x_n = 0.0;  ///< of the hand on the tool
  double y_n = 0.0;
};

class UdpHand final : public OperatorInput {
 public:
  /// `address`: of this host, where the frames arrive; port 0: any free one. Throws StartupError.
  explicit UdpHand(const UdpAddress& address);
  OperatorSample sample(std::int64_t now_ns) noexcept override;
  void answer(const OperatorAnswer& answer) noexcept override;

  std::uint16_t port() const { return socket_.local_endpoint().port(); }
  const OperatorLease::Counters& counters() const noexcept { return lease_.counters(); }
  /// Datagrams of another length or kind, that pull to what is no place, or of a second hand.
  std::uint64_t refused() const noexcept override { return refused_; }

 private:
  bool is_of_hand(const UdpHandFrame& frame, const boost::asio::ip::udp::endpoint& from,
                  std::int64_t now_ns) noexcept;
  /// True: it counts.
  bool hear(const UdpHandFrame& frame, std::int64_t now_ns) noexcept;

  boost::asio::io_context context_;
  boost::asio::ip::udp::socket socket_;
  boost::asio::ip::udp::endpoint hand_;  ///< the one that is heard
  OperatorLease lease_;
  UdpHandFrame newest_;
  bool news_ = false;  ///< of this step
  bool held_ = false;
  std::uint64_t refused_ = 0;
};

/// `rest`: HOST:PORT, as the user wrote it; of the console's hand it may be left out. Throw StartupError.
std::unique_ptr<OperatorInput> open_udp_hand(std::string_view rest);
std::unique_ptr<OperatorInput> open_browser_hand(std::string_view rest);
/// What is wrong with `rest` of the console's hand; empty: nothing.
std::string validate_browser_hand(std::string_view rest);

}  // namespace telekerf::master
