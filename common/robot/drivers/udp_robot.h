// SPDX-License-Identifier: Apache-2.0
// A robot in another process: the hardware seam over UDP, one datagram each way a step.
//
// The smallest possible drive, to copy from (docs/how-to/add-a-drive.md). Lost datagrams cost a step, never
// an offset: positions are absolute. For one host or a wire of its own: against a stranger's datagrams there
// is the seal alone (common/runtime/datagram_seal.h), if both ends have its key. Controller and drive are in
// step: the reading that answers a step's currents is there at the next step, unless the way there and back
// takes longer than a control period.
#pragma once

#include <array>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/udp.hpp>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "common/robot/drivers/drive.h"
#include "common/robot/robot.h"
#include "common/runtime/datagram_seal.h"
#include "common/runtime/udp.h"

namespace telekerf::robot {

/// Currents, controller -> drive. Little endian, as all fields of both datagrams.
struct UdpCurrents {
  static constexpr std::uint32_t kMagic = 0x43554b54;
  std::uint32_t magic = kMagic;
  std::uint32_t period_ns = 0;  ///< until the next ones
  std::uint64_t sequence = 0;
  double currents_a[3] = {0, 0, 0};
};

/// Reading, drive -> controller; the answer to each UdpCurrents.
struct UdpReading {
  static constexpr std::uint32_t kMagic = 0x52554b54;
  std::uint32_t magic = kMagic;
  std::uint32_t valid = 0;
  std::uint64_t sequence = 0;  ///< of the currents that it answers
  std::uint64_t tick = 0;
  std::int64_t time_ns = 0;
  double joints_m[3] = {0, 0, 0};
};

/// What of this was sealed, see datagram_seal.h.
using SealedCurrents = DatagramSeal::Sealed<UdpCurrents>;
using SealedReading = DatagramSeal::Sealed<UdpReading>;

/// Controller's side. Neither call blocks: a datagram that is not there yet makes read() invalid.
class UdpRobot final : public Robot {
 public:
  static constexpr double kOldest_s = 0.01;

  /// `period_s`: between two writes, at most 0.1 s. Throws StartupError if the address cannot be resolved or
  /// opened.
  UdpRobot(const UdpAddress& address, double period_s);

  /// Newest answer that has arrived; invalid if none has come since the last call, or if it answers older
  /// currents than usual: where a drive that was kept waiting works off what has piled up, its first answers
  /// are milliseconds old, and the observer would take them for a throw of the tool. Nor is an answer to
  /// currents of more than kOldest_s ago (of at least four steps) one: no loop holds with it.
  JointReading read() noexcept override;
  void write(const Vec3& currents_a) noexcept override;
  Capabilities capabilities() const override;

  /// Datagrams that could not be sent.
  std::uint64_t dropped() const noexcept { return dropped_; }
  /// Datagrams of another address, seal, length or kind, that answer nothing, or with a position that is no
  /// number.
  std::uint64_t refused() const noexcept override { return refused_; }

 private:
  /// Of an answer to the currents `steps` before the newest: whether one of the last eight was newer than
  /// that, or it is too old at all. A way that has become longer for good is soon the usual one.
  bool is_late(std::uint64_t steps) noexcept;

  boost::asio::io_context context_;
  boost::asio::ip::udp::socket socket_;
  boost::asio::ip::udp::endpoint drive_;
  DatagramSeal seal_;
  SealedCurrents sealed_;
  UdpCurrents& outgoing_ = sealed_.datagram;
  std::uint64_t newest_ = 0;
  std::uint64_t most_steps_;
  std::array<std::uint64_t, 8> lags_{};  ///< of the last answers, steps
  std::size_t next_lag_ = 0;
  std::uint64_t dropped_ = 0;
  std::uint64_t refused_ = 0;
};

/// The drive's side: a simulated robot that moves one period for each datagram of currents, and answers with
/// its reading. Without datagrams nothing moves. It obeys one controller; another one is heard only after the
/// first has been silent for a while.
class UdpDrive {
 public:
  /// Binds to `port` of the loopback interface; 0: any free one, see port(). `key`: file of the seal; empty:
  /// none. Throws StartupError.
  UdpDrive(SimulatedRobot& plant, std::uint16_t port, const std::string& key = {});

  std::uint16_t port() const { return socket_.local_endpoint().port(); }
  /// What else is to be served in serve_for() may be put here.
  boost::asio::io_context& context() noexcept { return context_; }
  /// Serves what arrives within `seconds`, at least what is there already; returns the number of steps.
  std::uint64_t serve_for(double seconds);
  /// Datagrams that moved nothing: of another seal, length or kind, with a current that is no number, or of a
  /// second controller.
  std::uint64_t refused() const noexcept { return refused_; }

 private:
  void receive();
  void obey();
  bool is_currents(std::size_t size);
  bool is_of_controller();

  SimulatedRobot& plant_;
  boost::asio::io_context context_;
  boost::asio::ip::udp::socket socket_;
  boost::asio::ip::udp::endpoint from_;
  boost::asio::ip::udp::endpoint controller_;
  std::chrono::steady_clock::time_point heard_;
  DatagramSeal seal_;
  Arrival<SealedCurrents> arrived_;
  UdpCurrents& incoming_ = arrived_.datagram.datagram;
  std::uint64_t last_sequence_ = 0;
  std::uint64_t steps_ = 0;
  std::uint64_t refused_ = 0;
};

Drive open_udp_drive(std::string_view rest, const DriveNeeds& needs);
inline constexpr DriveKind kUdpDrive{"udp", "udp:HOST:PORT", validate_sealed_udp, open_udp_drive};

}  // namespace telekerf::robot
