// SPDX-License-Identifier: Apache-2.0
// Where a laser's datagrams arrive: the device is slave/laser/udp_laser_device.h, the socket is here.
#pragma once

#include <boost/asio/buffer.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/udp.hpp>
#include <optional>
#include <string>

#include "slave/laser/udp_laser_device.h"

namespace telekerf::laser {

/// Where its datagrams arrive, on a port of the loopback interface; 0: any free one.
class LaserSocket {
 public:
  explicit LaserSocket(unsigned short port = 0)
      : socket_(context_, {boost::asio::ip::address_v4::loopback(), port}) {
    socket_.non_blocking(true);
    socket_.set_option(boost::asio::socket_base::receive_buffer_size(4 << 20));
  }
  struct Arrival {
    UdpPower told;
    std::size_t size;
    UdpLaserDevice::Sender from;
  };
  std::optional<Arrival> take() {
    Arrival arrival;
    boost::system::error_code error;
    arrival.size =
        socket_.receive_from(boost::asio::buffer(&arrival.told, sizeof(UdpPower)), arrival.from, 0, error);
    if (error) return std::nullopt;
    return arrival;
  }
  void answer(const UdpEmission& answer, const UdpLaserDevice::Sender& to, std::size_t more = 0) {
    telekerf::Arrival<UdpEmission> longer{answer};
    socket_.send_to(boost::asio::buffer(&longer, sizeof(answer) + more), to);
  }
  UdpAddress address() const { return {"127.0.0.1", socket_.local_endpoint().port()}; }
  /// As a user writes it.
  std::string laser() const { return "udp:127.0.0.1:" + std::to_string(address().port); }

 private:
  boost::asio::io_context context_;
  boost::asio::ip::udp::socket socket_;
};

}  // namespace telekerf::laser
