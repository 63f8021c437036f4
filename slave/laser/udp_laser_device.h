// SPDX-License-Identifier: Apache-2.0
// The other end of a UdpLaser: a laser that obeys docs/how-to/add-a-laser.md. Datagrams and time in, beam
// out; no socket and no clock.
#pragma once

#include <boost/asio/ip/udp.hpp>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "slave/laser/udp_laser.h"

namespace telekerf::laser {

/// Times are ns of any one monotonic clock.
class UdpLaserDevice {
 public:
  using Sender = boost::asio::ip::udp::endpoint;
  /// `max_w`: more is never given.
  explicit UdpLaserDevice(double max_w) noexcept : max_w_(max_w) {}

  /// True: obeyed. What is not obeyed changes nothing, and does not count against the silence.
  bool hear(const UdpPower& told, std::size_t size, const Sender& from, std::int64_t now_ns) noexcept;

  double power_w(std::int64_t now_ns) const noexcept { return dark(now_ns) ? 0.0 : modulated_w(); }
  bool pilot(std::int64_t now_ns) const noexcept { return !dark(now_ns) && newest_.pilot == 1; }
  /// From here on it is dark by itself, unless it is told anew.
  std::int64_t dark_ns() const noexcept;
  /// When it obeyed last.
  std::int64_t heard_ns() const noexcept { return heard_ns_; }
  /// What it answers to the datagram that it obeyed last, with its light as measured at `now_ns`.
  UdpEmission answer(std::int64_t now_ns) const noexcept;

  /// For trials: from now on the modulator gives this much, whatever it is told. Only the supply, which
  /// follows the datagram's enable, puts the light out.
  void stick(double power_w) noexcept { stuck_w_ = power_w; }

 private:
  bool dark(std::int64_t now_ns) const noexcept { return now_ns >= dark_ns(); }
  double modulated_w() const noexcept;

  double max_w_;
  Sender sender_;
  UdpPower newest_;
  std::uint64_t enable_ = 0;  ///< largest of any with power
  std::int64_t heard_ns_ = 0;
  std::optional<double> stuck_w_;
};

}  // namespace telekerf::laser
