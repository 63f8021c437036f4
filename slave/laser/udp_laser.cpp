// SPDX-License-Identifier: Apache-2.0
#include "slave/laser/udp_laser.h"

#include <bit>
#include <boost/asio/buffer.hpp>
#include <chrono>
#include <cmath>
#include <thread>

namespace telekerf::laser {
namespace {

static_assert(std::endian::native == std::endian::little, "datagrams are little endian");
static_assert(sizeof(UdpPower) == 32, "datagrams hold no padding");
/// In this time a host that is near says that nobody listens.
constexpr std::chrono::milliseconds kAnswer{50};

}  // namespace

UdpLaser::UdpLaser(const UdpAddress& address, double control_hz) : socket_(context_) {
  const auto endpoint = open_udp(socket_, address, "laser");
  outgoing_.period_ns = static_cast<std::uint32_t>(std::lround(1e9 / control_hz));
  boost::system::error_code error;
  socket_.connect(endpoint, error);  // a connected socket hears what the laser's host answers
  if (!error) error = send();
  std::this_thread::sleep_for(kAnswer);
  if (!error) error = send();
  if (error) {
    refuse_udp(address, "laser", error.message(), "is the laser switched on, connected, and its port right?");
  }
}

boost::system::error_code UdpLaser::send() noexcept {
  ++outgoing_.sequence;
  boost::system::error_code error;
  socket_.send(boost::asio::buffer(&outgoing_, sizeof(outgoing_)), 0, error);
  return error;
}

bool UdpLaser::emit(double power_w, bool pilot) noexcept {
  outgoing_.power_w = power_w;
  outgoing_.pilot = pilot ? 1 : 0;
  // What fails may be of the datagram before, and keeps this one from being sent.
  const bool told = !send();
  if (!told) send();
  return told;
}

std::unique_ptr<Laser> open_udp_laser(std::string_view rest, double control_hz) {
  return std::make_unique<UdpLaser>(udp_address(rest), control_hz);
}

}  // namespace telekerf::laser
