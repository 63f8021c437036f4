// SPDX-License-Identifier: Apache-2.0
#include "slave/laser/udp_laser.h"

#include <algorithm>
#include <bit>
#include <boost/asio/buffer.hpp>
#include <boost/asio/error.hpp>
#include <chrono>
#include <cmath>
#include <thread>
#include <utility>

namespace telekerf::laser {
namespace {

static_assert(std::endian::native == std::endian::little, "datagrams are little endian");
static_assert(sizeof(UdpPower) == 48 && sizeof(UdpEmission) == 24, "datagrams hold no padding");
/// In this time a host that is near says that nobody listens.
constexpr std::chrono::milliseconds kAnswer{50};
constexpr int kMostAnswers = 8;  ///< that are looked at in a step

}  // namespace

UdpLaser::UdpLaser(const UdpAddress& address, double control_hz, std::int64_t (*clock)() noexcept)
    : socket_(context_), seal_(address.key), clock_(clock), sent_ns_(clock()) {
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
  told_w_[outgoing_.sequence % told_w_.size()] = outgoing_.power_w;
  boost::system::error_code error;
  const std::size_t size = seal_.close(sealed_);
  socket_.send(boost::asio::buffer(&sealed_, size), 0, error);
  return error;
}

bool UdpLaser::emit(const Emission& emission) noexcept {
  const std::int64_t now_ns = clock_();
  const bool held_up = now_ns - std::exchange(sent_ns_, now_ns) > udp_silence_ns(outgoing_.period_ns);
  outgoing_.power_w = held_up ? 0.0 : emission.power_w;
  outgoing_.pilot = emission.pilot && !held_up ? 1 : 0;
  outgoing_.enable = emission.enable;
  outgoing_.lasts_ns = static_cast<std::uint32_t>(
      std::clamp<std::int64_t>(emission.lasts_ns, 0, 2 * std::int64_t{outgoing_.period_ns}));
  // What fails may be of the datagram before, and keeps this one from being sent.
  const bool told = !send();
  if (!told) send();
  return !std::exchange(refused_, false) && told;
}

bool UdpLaser::stray() noexcept {
  bool stray = false;
  for (int n = 0; n < kMostAnswers; ++n) {
    Arrival<SealedEmission> arrived;
    const UdpEmission& answer = arrived.datagram.datagram;
    boost::system::error_code error;
    const std::size_t size = socket_.receive(arrived.room(), 0, error);
    if (error) {
      // Of the datagram before, which nobody has got; send() will not hear of it any more.
      refused_ = error == boost::asio::error::connection_refused;
      break;
    }
    if (seal_.open(arrived.datagram, size) != sizeof(answer) || answer.magic != UdpEmission::kMagic ||
        answer.version != UdpPower::kVersion || answer.sequence > outgoing_.sequence) {
      ++refused_answers_;
      continue;
    }
    const bool late = answer.sequence <= answered_ || outgoing_.sequence - answer.sequence >= told_w_.size();
    if (late) continue;
    answered_ = answer.sequence;
    // Written so that what is not a number is light.
    stray = !(answer.emission_w <= kDark_w + kTolerance * told_w_[answer.sequence % told_w_.size()]);
  }
  return stray;
}

std::unique_ptr<Laser> open_udp_laser(std::string_view rest, double control_hz) {
  return std::make_unique<UdpLaser>(udp_address(rest), control_hz);
}

}  // namespace telekerf::laser
