// SPDX-License-Identifier: Apache-2.0
#include "slave/vision/imaging/udp_axes.h"

#include <bit>
#include <boost/asio/buffer.hpp>
#include <cmath>

namespace telekerf::imaging {
namespace {

namespace asio = boost::asio;

static_assert(std::endian::native == std::endian::little, "datagrams are little endian");
static_assert(sizeof(UdpAxesCurrents) == 32 && sizeof(UdpAxesReading) == 48, "datagrams hold no padding");

}  // namespace

UdpAxes::UdpAxes(const UdpAddress& address, double period_s)
    : socket_(context_), axes_(open_udp(socket_, address, "imaging")) {
  outgoing_.period_ns = static_cast<std::uint32_t>(std::lround(period_s * 1e9));
}

AxesReading UdpAxes::read() noexcept {
  constexpr int kMostAtOnce = 64;  // bounds the step, whatever is in the queue
  AxesReading reading;
  for (int i = 0; i < kMostAtOnce; ++i) {
    Arrival<UdpAxesReading> arrived;
    const UdpAxesReading& incoming = arrived.datagram;
    asio::ip::udp::endpoint from;
    boost::system::error_code error;
    const std::size_t size = socket_.receive_from(arrived.room(), from, 0, error);
    if (error == asio::error::would_block) break;
    if (error || size != sizeof(incoming) || incoming.magic != UdpAxesReading::kMagic || from != axes_) {
      ++dropped_;
      continue;
    }
    if (incoming.sequence <= newest_ || incoming.sequence > outgoing_.sequence)
      continue;  // overtaken, or no answer
    newest_ = incoming.sequence;
    reading.valid = incoming.valid == 1 && outgoing_.sequence - incoming.sequence <= kMostLate;
    reading.tick = incoming.tick;
    for (const std::size_t axis : kBothAxes) {
      reading.encoders_m[axis] = incoming.encoders_m[axis];
      reading.at_lower_end[axis] = incoming.at_lower_end[axis] == 1;
      if (!std::isfinite(incoming.encoders_m[axis])) reading.valid = false;
    }
  }
  return reading;
}

void UdpAxes::write(const PerAxis& currents_a) noexcept {
  ++outgoing_.sequence;
  for (const std::size_t axis : kBothAxes) outgoing_.currents_a[axis] = currents_a[axis];
  boost::system::error_code error;
  socket_.send_to(asio::buffer(&outgoing_, sizeof(outgoing_)), axes_, 0, error);
  if (error) ++dropped_;
}

}  // namespace telekerf::imaging
