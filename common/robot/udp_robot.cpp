// SPDX-License-Identifier: Apache-2.0
#include "common/robot/udp_robot.h"

#include <bit>
#include <boost/asio/buffer.hpp>
#include <chrono>

#include "common/runtime/refusal.h"

namespace telekerf::robot {
namespace {

namespace asio = boost::asio;
using asio::ip::udp;

static_assert(std::endian::native == std::endian::little, "datagrams are little endian");
static_assert(sizeof(UdpCurrents) == 40 && sizeof(UdpReading) == 56, "datagrams hold no padding");

}  // namespace

UdpRobot::UdpRobot(const std::string& host, std::uint16_t port) : socket_(context_) {
  boost::system::error_code error;
  udp::resolver resolver(context_);
  const auto found = resolver.resolve(udp::v4(), host, std::to_string(port), error);
  if (error || found.empty()) throw Refusal("no drive at " + host + ": " + error.message());
  drive_ = found.begin()->endpoint();
  socket_.open(udp::v4(), error);
  if (!error) socket_.non_blocking(true, error);
  if (error) throw Refusal("no socket for the drive at " + host + ": " + error.message());
}

JointReading UdpRobot::read() noexcept {
  constexpr int kMostAtOnce = 64;  // bounds the step, whatever is in the queue
  JointReading reading;
  for (int i = 0; i < kMostAtOnce; ++i) {
    UdpReading incoming;
    udp::endpoint from;
    boost::system::error_code error;
    const std::size_t size = socket_.receive_from(asio::buffer(&incoming, sizeof(incoming)), from, 0, error);
    if (error == asio::error::would_block) break;
    if (error || size != sizeof(incoming) || incoming.magic != UdpReading::kMagic || from != drive_) {
      ++dropped_;
      continue;
    }
    if (incoming.sequence <= newest_) continue;  // overtaken on the way
    newest_ = incoming.sequence;
    reading.joints_m = Vec3(incoming.joints_m);
    reading.valid = incoming.valid == 1 && reading.joints_m.allFinite();
    reading.tick = incoming.tick;
    reading.time_ns = incoming.time_ns;
  }
  return reading;
}

void UdpRobot::write(const Vec3& currents_a) noexcept {
  UdpCurrents outgoing;
  outgoing.sequence = ++sequence_;
  for (int i = 0; i < 3; ++i) outgoing.currents_a[i] = currents_a[i];
  boost::system::error_code error;
  socket_.send_to(asio::buffer(&outgoing, sizeof(outgoing)), drive_, 0, error);
  if (error) ++dropped_;
}

Capabilities UdpRobot::capabilities() const {
  return {"udp " + drive_.address().to_string() + ":" + std::to_string(drive_.port()), false, 0, 0, 1e3};
}

UdpDrive::UdpDrive(SimulatedRobot& plant, std::uint16_t port, double period_s)
    : plant_(plant), period_s_(period_s), socket_(context_) {
  boost::system::error_code error;
  socket_.open(udp::v4(), error);
  if (!error) socket_.bind({asio::ip::address_v4::loopback(), port}, error);
  if (error) throw Refusal("cannot listen on UDP port " + std::to_string(port) + ": " + error.message());
  receive();
}

void UdpDrive::receive() {
  socket_.async_receive_from(
      asio::buffer(&incoming_, sizeof(incoming_)), from_,
      [this](boost::system::error_code error, std::size_t size) {
        const bool ours = !error && size == sizeof(incoming_) && incoming_.magic == UdpCurrents::kMagic;
        if (ours && incoming_.sequence > last_sequence_) {
          last_sequence_ = incoming_.sequence;
          plant_.write(Vec3(incoming_.currents_a));
          plant_.advance(period_s_);
          ++steps_;
          const JointReading reading = plant_.read();
          UdpReading answer;
          answer.valid = reading.valid ? 1 : 0;
          answer.sequence = incoming_.sequence;
          answer.tick = reading.tick;
          answer.time_ns = reading.time_ns;
          for (int i = 0; i < 3; ++i) answer.joints_m[i] = reading.joints_m[i];
          boost::system::error_code ignored;  // the controller sees a missing answer as a lost step
          socket_.send_to(asio::buffer(&answer, sizeof(answer)), from_, 0, ignored);
        }
        receive();
      });
}

std::uint64_t UdpDrive::serve_for(double seconds) {
  steps_ = 0;
  context_.restart();
  context_.run_for(
      std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::duration<double>(seconds)));
  return steps_;
}

}  // namespace telekerf::robot
