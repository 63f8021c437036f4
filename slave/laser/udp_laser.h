// SPDX-License-Identifier: Apache-2.0
// A laser behind a UDP address, one datagram a step, which it may answer with the light that it measures: the
// smallest one, to copy from. For one host or a wire of its own: against a stranger's datagrams there is the
// seal alone (common/runtime/datagram_seal.h), if both ends have its key.
#pragma once

#include <algorithm>
#include <array>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/udp.hpp>
#include <cstdint>
#include <memory>
#include <string_view>

#include "common/runtime/clock.h"
#include "common/runtime/datagram_seal.h"
#include "common/runtime/udp.h"
#include "slave/laser/laser.h"

namespace telekerf::laser {

/// Controller -> laser, little endian. docs/how-to/add-a-laser.md says what the laser must do by itself.
struct UdpPower {
  static constexpr std::uint32_t kMagic = 0x4c554b54;
  static constexpr std::uint32_t kVersion = 2;
  std::uint32_t magic = kMagic;
  std::uint32_t version = kVersion;
  std::uint64_t sequence = 0;  ///< from 1, more each time
  double power_w = 0.0;
  std::uint32_t period_ns = 0;  ///< until the next one
  std::uint32_t pilot = 0;      ///< 1: on
  std::uint64_t enable = 0;     ///< larger than any before, or no power; 0: none
  std::uint32_t lasts_ns = 0;   ///< from its arrival on, then off
  std::uint32_t reserved = 0;
};

/// Laser -> controller, if it measures its light; the answer to each UdpPower that it obeys.
struct UdpEmission {
  static constexpr std::uint32_t kMagic = 0x45554b54;
  std::uint32_t magic = kMagic;
  std::uint32_t version = UdpPower::kVersion;
  std::uint64_t sequence = 0;  ///< of the datagram that it answers
  double emission_w = 0.0;     ///< measured, with that datagram obeyed
};

/// What of this was sealed, see datagram_seal.h.
using SealedPower = DatagramSeal::Sealed<UdpPower>;
using SealedEmission = DatagramSeal::Sealed<UdpEmission>;

/// After so long without a datagram the laser must be off: what the interlock reckons with (reaction_s), or
/// two control periods if they are longer.
constexpr std::int64_t udp_silence_ns(std::uint32_t period_ns) noexcept {
  return std::max<std::int64_t>(3'000'000, 2 * std::int64_t{period_ns});
}

class UdpLaser final : public Laser {
 public:
  /// Puts the beam out. Throws StartupError if the address cannot be resolved or reached, or if its host says
  /// that nobody listens there.
  /// `clock`: monotonic, ns.
  UdpLaser(const UdpAddress& address, double control_hz, std::int64_t (*clock)() noexcept = monotonic_ns);
  /// False also if the one before did not arrive. Later after the one before than the laser waits for it says
  /// off, whatever it was given: a step that was held up was judged by what was.
  bool emit(const Emission& emission) noexcept override;
  /// The newest answer says so: more than kTolerance times what its datagram asked for, and more than
  /// kDark_w.
  bool stray() noexcept override;
  /// Datagrams of another seal, length, kind or number. What is no number under the right seal is light.
  std::uint64_t refused() const noexcept override { return refused_answers_; }
  static constexpr double kDark_w = 1e-3;
  static constexpr double kTolerance = 1.5;

 private:
  boost::system::error_code send() noexcept;

  boost::asio::io_context context_;
  boost::asio::ip::udp::socket socket_;
  DatagramSeal seal_;
  SealedPower sealed_;
  UdpPower& outgoing_ = sealed_.datagram;
  std::int64_t (*clock_)() noexcept;
  std::int64_t sent_ns_ = 0;    ///< the datagram before
  bool refused_ = false;        ///< the datagram before, as was learned meanwhile
  std::uint64_t answered_ = 0;  ///< newest datagram that was
  std::uint64_t refused_answers_ = 0;
  std::array<double, 64> told_w_{};  ///< by the last datagrams, by their number
};

std::unique_ptr<Laser> open_udp_laser(std::string_view rest, double control_hz);
inline constexpr LaserKind kUdpLaser{"udp", "udp:HOST:PORT", validate_sealed_udp, open_udp_laser};
/// The one of telekerf-plant: the same datagrams, but no light.
inline constexpr LaserKind kPlantLaser{"plant", "plant:HOST:PORT", validate_sealed_udp, open_udp_laser};

}  // namespace telekerf::laser
