// SPDX-License-Identifier: Apache-2.0
#include "common/robot/drivers/udp_robot.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <boost/asio/buffer.hpp>
#include <cmath>

#include "common/robot/drivers/simulated_robot.h"
#include "common/runtime/startup_error.h"

namespace telekerf::robot {
namespace {

namespace asio = boost::asio;
using asio::ip::udp;

static_assert(std::endian::native == std::endian::little, "datagrams are little endian");
static_assert(sizeof(UdpCurrents) == 40 && sizeof(UdpReading) == 56, "datagrams hold no padding");

/// Steps a second for which there is time to answer on one host.
constexpr double kMostHz = 5000.0;
constexpr std::uint32_t kLongestPeriod_ns = 100'000'000;
/// A controller that has been silent this long has gone.
constexpr std::chrono::milliseconds kGone{500};

}  // namespace

UdpRobot::UdpRobot(const UdpAddress& address, double period_s)
    : socket_(context_),
      drive_(open_udp(socket_, address, "drive")),
      seal_(address.key),
      most_steps_(static_cast<std::uint64_t>(std::max(4L, std::lround(kOldest_s / period_s)))) {
  outgoing_.period_ns = static_cast<std::uint32_t>(std::lround(period_s * 1e9));
}

JointReading UdpRobot::read() noexcept {
  constexpr int kMostAtOnce = 64;  // bounds the step, whatever is in the queue
  JointReading reading;
  bool answered = false;
  for (int i = 0; i < kMostAtOnce; ++i) {
    Arrival<SealedReading> arrived;
    const UdpReading& incoming = arrived.datagram.datagram;
    udp::endpoint from;
    boost::system::error_code error;
    const std::size_t size = socket_.receive_from(arrived.room(), from, 0, error);
    if (error == asio::error::would_block) break;
    if (error) {
      ++dropped_;
      continue;
    }
    if (from != drive_ || seal_.open(arrived.datagram, size) != sizeof(incoming) ||
        incoming.magic != UdpReading::kMagic || incoming.sequence > outgoing_.sequence ||
        (incoming.valid == 1 && !Vec3(incoming.joints_m).allFinite())) {
      ++refused_;
      continue;
    }
    if (incoming.sequence <= newest_) continue;  // overtaken on the way
    newest_ = incoming.sequence;
    answered = true;
    reading.joints_m = Vec3(incoming.joints_m);
    reading.valid = incoming.valid == 1;
    reading.tick = incoming.tick;
    reading.time_ns = incoming.time_ns;
  }
  if (answered && is_late(outgoing_.sequence - newest_)) reading.valid = false;
  return reading;
}

bool UdpRobot::is_late(std::uint64_t steps) noexcept {
  const bool late = steps > most_steps_ || steps > *std::min_element(lags_.begin(), lags_.end());
  lags_[next_lag_] = steps;
  next_lag_ = (next_lag_ + 1) % lags_.size();
  return late;
}

void UdpRobot::write(const Vec3& currents_a) noexcept {
  ++outgoing_.sequence;
  for (int i = 0; i < 3; ++i) outgoing_.currents_a[i] = currents_a[i];
  boost::system::error_code error;
  const std::size_t size = seal_.close(sealed_);
  socket_.send_to(asio::buffer(&sealed_, size), drive_, 0, error);
  if (error) ++dropped_;
}

Capabilities UdpRobot::capabilities() const {
  return {"udp " + drive_.address().to_string() + ":" + std::to_string(drive_.port()), false, 0, 0, kMostHz};
}

UdpDrive::UdpDrive(SimulatedRobot& plant, std::uint16_t port, const std::string& key)
    : plant_(plant), socket_(context_), seal_(key) {
  boost::system::error_code error;
  socket_.open(udp::v4(), error);
  if (!error) socket_.bind({asio::ip::address_v4::loopback(), port}, error);
  if (error)
    throw environment_error(
        fmt::format("port = {}: {}; use a free one, or 0 for any", port, error.message()));
  receive();
}

bool UdpDrive::is_currents(std::size_t size) {
  return seal_.open(arrived_.datagram, size) == sizeof(incoming_) && incoming_.magic == UdpCurrents::kMagic &&
         incoming_.period_ns > 0 && incoming_.period_ns <= kLongestPeriod_ns &&
         Vec3(incoming_.currents_a).allFinite();
}

bool UdpDrive::is_of_controller() {
  if (from_ == controller_) return true;
  if (std::chrono::steady_clock::now() - heard_ < kGone) return false;
  controller_ = from_;
  last_sequence_ = 0;
  return true;
}

void UdpDrive::receive() {
  socket_.async_receive_from(arrived_.room(), from_,
                             [this](boost::system::error_code error, std::size_t size) {
                               if (!error && is_currents(size) && is_of_controller()) {
                                 // What is not newer was overtaken on the way.
                                 if (incoming_.sequence > last_sequence_) obey();
                               } else if (error != asio::error::operation_aborted) {
                                 ++refused_;
                               }
                               receive();
                             });
}

void UdpDrive::obey() {
  last_sequence_ = incoming_.sequence;
  heard_ = std::chrono::steady_clock::now();
  plant_.write(Vec3(incoming_.currents_a));
  plant_.advance(incoming_.period_ns * 1e-9);
  ++steps_;
  const JointReading reading = plant_.read();
  SealedReading sealed;
  UdpReading& answer = sealed.datagram;
  answer.valid = reading.valid ? 1 : 0;
  answer.sequence = incoming_.sequence;
  answer.tick = reading.tick;
  answer.time_ns = reading.time_ns;
  for (int i = 0; i < 3; ++i) answer.joints_m[i] = reading.joints_m[i];
  boost::system::error_code ignored;  // the controller sees a missing answer as a lost step
  const std::size_t whole = seal_.close(sealed);
  socket_.send_to(asio::buffer(&sealed, whole), from_, 0, ignored);
}

std::uint64_t UdpDrive::serve_for(double seconds) {
  steps_ = 0;
  context_.restart();
  context_.poll();
  context_.run_for(
      std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::duration<double>(seconds)));
  return steps_;
}

Drive open_udp_drive(std::string_view rest, const DriveNeeds& needs) {
  return {.robot = std::make_unique<UdpRobot>(udp_address(rest), 1.0 / needs.control_hz)};
}

}  // namespace telekerf::robot
