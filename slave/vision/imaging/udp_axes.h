// SPDX-License-Identifier: Apache-2.0
// An imaging unit's axes in another process: one datagram each way a control step, little endian, without
// padding (docs/how-to/imaging-unit.md). For one host or a wire of its own; there is no protection against a
// stranger's datagrams.
#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/udp.hpp>
#include <cstdint>

#include "common/runtime/udp.h"
#include "slave/vision/imaging/axes.h"

namespace telekerf::imaging {

/// Telekerf -> axes.
struct UdpAxesCurrents {
  static constexpr std::uint32_t kMagic = 0x43494b54;  ///< "TKIC" on the wire
  std::uint32_t magic = kMagic;
  std::uint32_t period_ns = 0;  ///< until the next ones
  std::uint64_t sequence = 0;   ///< from 1, one more each time
  double currents_a[kAxes] = {0, 0};
};

/// Axes -> Telekerf; the answer to each UdpAxesCurrents.
struct UdpAxesReading {
  static constexpr std::uint32_t kMagic = 0x52494b54;  ///< "TKIR"
  std::uint32_t magic = kMagic;
  std::uint32_t valid = 0;     ///< 1: the positions hold
  std::uint64_t sequence = 0;  ///< of the currents that it answers
  std::uint64_t tick = 0;      ///< counts readings of the encoders
  double encoders_m[kAxes] = {0, 0};
  std::uint32_t at_lower_end[kAxes] = {0, 0};  ///< 1: the switch is pressed
};

/// Neither call blocks: an answer that is not there yet makes read() invalid, as does one that is too old.
class UdpAxes final : public Axes {
 public:
  /// Periods that an answer may come later than the next step; the control loop bears no more.
  static constexpr std::uint64_t kMostLate = 2;

  /// `period_s`: between two writes. Throws StartupError if the address cannot be resolved or opened.
  UdpAxes(const UdpAddress& address, double period_s);

  AxesReading read() noexcept override;
  void write(const PerAxis& currents_a) noexcept override;

  /// Datagrams that could not be sent or were not an answer of these axes.
  std::uint64_t dropped() const noexcept { return dropped_; }

 private:
  boost::asio::io_context context_;
  boost::asio::ip::udp::socket socket_;
  boost::asio::ip::udp::endpoint axes_;
  UdpAxesCurrents outgoing_;
  std::uint64_t newest_ = 0;
  std::uint64_t dropped_ = 0;
};

}  // namespace telekerf::imaging
