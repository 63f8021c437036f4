// SPDX-License-Identifier: Apache-2.0
// A laser behind a UDP address that obeys docs/how-to/add-a-laser.md: datagrams and time in, beam out.
#pragma once

#include <algorithm>
#include <boost/asio/buffer.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/udp.hpp>
#include <chrono>
#include <cmath>
#include <optional>
#include <string>

#include "slave/laser/udp_laser.h"

namespace telekerf::laser {

class LaserDevice {
 public:
  using Sender = boost::asio::ip::udp::endpoint;
  explicit LaserDevice(double max_w) : max_w_(max_w) {}

  /// True: obeyed.
  bool hear(const UdpPower& told, std::size_t size, const Sender& from, std::int64_t now_ns) {
    if (size != sizeof(told) || told.magic != UdpPower::kMagic || told.version != UdpPower::kVersion ||
        !std::isfinite(told.power_w) || told.power_w < 0.0) {
      return false;
    }
    const bool off = told.power_w == 0.0 && told.pilot == 0;
    if (off && (newest_.sequence == 0 || now_ns - heard_ns_ >= kGone_ns)) {
      sender_ = from;
      newest_.sequence = 0;
      enable_ = 0;
    }
    if (from != sender_ || told.sequence <= newest_.sequence) return false;
    if (told.power_w > 0.0) {
      if (told.enable <= enable_) return false;
      enable_ = told.enable;
    }
    newest_ = told;
    heard_ns_ = now_ns;
    return true;
  }
  double power_w(std::int64_t now_ns) const {
    return silent(now_ns) ? 0.0 : std::min(newest_.power_w, max_w_);
  }
  /// What it answers to the datagram that it obeyed last.
  UdpEmission answer(std::int64_t now_ns) const {
    UdpEmission answer;
    answer.sequence = newest_.sequence;
    answer.emission_w = power_w(now_ns);
    return answer;
  }
  bool pilot(std::int64_t now_ns) const { return !silent(now_ns) && newest_.pilot == 1; }

 private:
  static constexpr std::int64_t kGone_ns = 500'000'000;
  bool silent(std::int64_t now_ns) const {
    return now_ns - heard_ns_ >= std::min<std::int64_t>(udp_silence_ns(newest_.period_ns), newest_.lasts_ns);
  }

  double max_w_;
  Sender sender_;
  UdpPower newest_;
  std::uint64_t enable_ = 0;
  std::int64_t heard_ns_ = 0;
};

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
    LaserDevice::Sender from;
  };
  std::optional<Arrival> take() {
    Arrival arrival;
    boost::system::error_code error;
    arrival.size =
        socket_.receive_from(boost::asio::buffer(&arrival.told, sizeof(UdpPower)), arrival.from, 0, error);
    if (error) return std::nullopt;
    return arrival;
  }
  void answer(const UdpEmission& answer, const LaserDevice::Sender& to) {
    socket_.send_to(boost::asio::buffer(&answer, sizeof(answer)), to);
  }
  UdpAddress address() const { return {"127.0.0.1", socket_.local_endpoint().port()}; }
  /// As a user writes it.
  std::string laser() const { return "udp:127.0.0.1:" + std::to_string(address().port); }

 private:
  boost::asio::io_context context_;
  boost::asio::ip::udp::socket socket_;
};

}  // namespace telekerf::laser
