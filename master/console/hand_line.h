// SPDX-License-Identifier: Apache-2.0
// The way to the master's hand on this host, and its answers back.
#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/udp.hpp>
#include <functional>

#include "common/runtime/udp.h"
#include "master/operator/udp_hand.h"

namespace telekerf::master {

class HandLine {
 public:
  /// `answered`: in the io_context's thread. Throws StartupError.
  HandLine(boost::asio::io_context& context, const UdpAddress& master,
           std::function<void(const UdpHandAnswer&)> answered);
  /// A master that does not listen misses it.
  void send(const UdpHandFrame& frame) noexcept;

 private:
  void listen();

  boost::asio::ip::udp::socket socket_;
  boost::asio::ip::udp::endpoint master_, from_;
  std::function<void(const UdpHandAnswer&)> answered_;
  UdpHandAnswer answer_;
};

}  // namespace telekerf::master
