// SPDX-License-Identifier: Apache-2.0
#include "master/operator/udp_hand.h"

#include <bit>
#include <boost/asio/buffer.hpp>
#include <cmath>

namespace telekerf::master {
namespace {

using boost::asio::ip::udp;

static_assert(std::endian::native == std::endian::little, "datagrams are little endian");
static_assert(sizeof(UdpHandFrame) == 48 && sizeof(UdpHandAnswer) == 64, "datagrams hold no padding");

}  // namespace

UdpHand::UdpHand(const UdpAddress& address) : socket_(context_) {
  const udp::endpoint here = open_udp(socket_, address, "hand");
  boost::system::error_code error;
  socket_.bind(here, error);
  if (error)
    refuse_udp(address, "hand", error.message(), "give an address of this host, and a port that is free");
}

OperatorSample UdpHand::sample(std::int64_t now_ns) noexcept {
  constexpr int kMostAtOnce = 64;  // bounds the step, whatever is in the queue
  news_ = false;
  for (int i = 0; i < kMostAtOnce; ++i) {
    Arrival<UdpHandFrame> arrived;
    const UdpHandFrame& frame = arrived.datagram;
    udp::endpoint from;
    boost::system::error_code error;
    const std::size_t size = socket_.receive_from(arrived.room(), from, 0, error);
    if (error == boost::asio::error::would_block) break;
    if (error) continue;
    const bool good = size == sizeof(frame) && frame.magic == UdpHandFrame::kMagic &&
                      frame.version == UdpHandFrame::kVersion && std::isfinite(frame.x_m) &&
                      std::isfinite(frame.y_m) && is_of_hand(frame, from, now_ns);
    if (good) {
      news_ = hear(frame, now_ns) || news_;
    } else {
      ++refused_;
    }
  }
  const bool held = lease_.held(now_ns);
  news_ = news_ || held != held_;
  held_ = held;
  if (!held) return {};
  OperatorSample sample;
  sample.trigger = (newest_.flags & UdpHandFrame::kTrigger) != 0;
  sample.held = (newest_.flags & UdpHandFrame::kHeld) != 0;
  if (sample.held) sample.pointer_m = Vec2(newest_.x_m, newest_.y_m);
  return sample;
}

bool UdpHand::is_of_hand(const UdpHandFrame& frame, const udp::endpoint& from, std::int64_t now_ns) noexcept {
  if (from == hand_ && frame.session == newest_.session) return true;
  if (!lease_.silent(now_ns)) return false;
  hand_ = from;
  lease_.begin();
  return true;
}

bool UdpHand::hear(const UdpHandFrame& frame, std::int64_t now_ns) noexcept {
  const bool held = (frame.flags & (UdpHandFrame::kHeld | UdpHandFrame::kTrigger)) != 0;
  newest_.session = frame.session;
  if (!lease_.hear({frame.sequence, frame.sent_ns, held}, now_ns)) return false;
  newest_ = frame;
  return true;
}

void UdpHand::answer(const OperatorAnswer& answer) noexcept {
  if (!news_) return;
  UdpHandAnswer told;
  told.session = newest_.session;
  told.flags = (held_ ? newest_.flags & (UdpHandAnswer::kHeld | UdpHandAnswer::kTrigger) : 0U) |
               (answer.guided ? UdpHandAnswer::kGuided : 0U);
  told.sequence = newest_.sequence;
  told.step_ns = answer.now_ns;
  told.x_m = answer.tool_m.x();
  told.y_m = answer.tool_m.y();
  told.x_n = answer.force_n.x();
  told.y_n = answer.force_n.y();
  boost::system::error_code error;  // whoever does not listen misses it
  (void)socket_.send_to(boost::asio::buffer(&told, sizeof(told)), hand_, 0, error);
}

std::unique_ptr<OperatorInput> open_udp_hand(std::string_view rest) {
  return std::make_unique<UdpHand>(udp_address(rest));
}

std::unique_ptr<OperatorInput> open_browser_hand(std::string_view rest) {
  return open_udp_hand(rest.empty() ? std::string_view(kBrowserHand) : rest);
}

std::string validate_browser_hand(std::string_view rest) { return rest.empty() ? "" : validate_udp(rest); }

}  // namespace telekerf::master
