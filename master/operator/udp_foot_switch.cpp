// SPDX-License-Identifier: Apache-2.0
#include "master/operator/udp_foot_switch.h"

#include <bit>
#include <boost/asio/buffer.hpp>

namespace telekerf::master {
namespace {

using boost::asio::ip::udp;

static_assert(std::endian::native == std::endian::little, "datagrams are little endian");
static_assert(sizeof(UdpButton) == 24, "datagrams hold no padding");

}  // namespace

UdpFootSwitch::UdpFootSwitch(const UdpAddress& address) : socket_(context_), seal_(address.key) {
  const udp::endpoint here = open_udp(socket_, address, "button");
  boost::system::error_code error;
  socket_.bind(here, error);
  if (error) {
    refuse_udp(address, "button", error.message(), "give an address of this host, and a port that is free");
  }
}

OperatorSample UdpFootSwitch::sample(std::int64_t now_ns) noexcept {
  stop_ = false;
  constexpr int kMostAtOnce = 64;  // bounds the step, whatever is in the queue
  for (int i = 0; i < kMostAtOnce; ++i) {
    Arrival<DatagramSeal::Sealed<UdpButton>> arrived;
    const UdpButton& told = arrived.datagram.datagram;
    udp::endpoint from;
    boost::system::error_code error;
    const std::size_t size = socket_.receive_from(arrived.room(), from, 0, error);
    if (error == boost::asio::error::would_block) break;
    if (error) continue;
    const bool good = seal_.open(arrived.datagram, size) == sizeof(told) && told.magic == UdpButton::kMagic &&
                      told.version == UdpButton::kVersion && hear(told, from, now_ns);
    if (!good) ++refused_;
  }
  return {.trigger = lease_.held(now_ns) && !squeezed_,
          .stop = stop_ || (newest_ == UdpButton::kSqueezed && !lease_.silent(now_ns))};
}

bool UdpFootSwitch::hear(const UdpButton& told, const udp::endpoint& from, std::int64_t now_ns) noexcept {
  if (lease_.silent(now_ns)) {
    pedal_ = from;
    lease_.begin();
  }
  if (from != pedal_) return false;
  if (!lease_.hear({told.sequence, std::nullopt, told.held == UdpButton::kHeld}, now_ns)) return true;
  newest_ = told.held;
  stop_ = stop_ || newest_ == UdpButton::kSqueezed;  // also where it was squeezed for less than a step
  squeezed_ = newest_ == UdpButton::kSqueezed || (squeezed_ && newest_ == UdpButton::kHeld);
  return true;
}

std::unique_ptr<OperatorInput> open_udp_foot_switch(std::string_view rest) {
  return std::make_unique<UdpFootSwitch>(udp_address(rest));
}

}  // namespace telekerf::master
