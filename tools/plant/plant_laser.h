// SPDX-License-Identifier: Apache-2.0
// A simulated laser behind a UDP port, above the tool of a simulated robot: it obeys
// docs/how-to/add-a-laser.md, measures its light, and books it by the clock.
#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/udp.hpp>
#include <cstdint>
#include <functional>

#include "common/robot/drivers/simulated_robot.h"
#include "slave/laser/udp_laser_device.h"
#include "tools/plant/light_book.h"

namespace telekerf::plant {

struct PlantLaserSettings {
  double max_w = 20.0;
  double stuck_after_j = 0.0;  ///< once it has given so much its modulator sticks; 0: never
  int port = 0;                ///< of the loopback interface; 0: any free one
  std::string key;             ///< file of the datagrams' seal; empty: none
};

class PlantLaser {
 public:
  using Contour = std::function<const geometry::NearestIndex*()>;

  /// Serves whenever `context` runs. `workpiece_in_base_m`: where the robot's tool is when it is at the
  /// workpiece's origin. `contour`: the newest, null before the first. Throws StartupError if the port is
  /// taken.
  PlantLaser(boost::asio::io_context& context, const PlantLaserSettings& settings,
             const robot::SimulatedRobot& robot, const Vec3& workpiece_in_base_m, double radius_m,
             Contour contour);

  std::uint16_t port() const { return socket_.local_endpoint().port(); }
  /// Books what it has given until now.
  void book_until(std::int64_t now_ns);
  bool lit() const noexcept { return device_.power_w(booked_ns_) > 0.0; }
  const LightBook& book() const noexcept { return book_; }
  std::uint64_t obeyed() const noexcept { return obeyed_; }
  std::uint64_t ignored() const noexcept { return ignored_; }
  bool stuck() const noexcept { return stuck_; }

 private:
  void receive();
  void hear(std::size_t size, std::int64_t now_ns);
  /// Where the beam is: the tool goes on as it went, from the time of the newest word's period on.
  Vec2 beam_at(std::int64_t time_ns) const noexcept;

  PlantLaserSettings settings_;
  const robot::SimulatedRobot& robot_;
  Vec3 workpiece_in_base_m_;
  Contour contour_;
  boost::asio::ip::udp::socket socket_;
  boost::asio::ip::udp::endpoint from_;
  DatagramSeal seal_;
  Arrival<laser::SealedPower> incoming_;
  laser::UdpLaserDevice device_;
  LightBook book_;
  std::int64_t booked_ns_;
  std::uint64_t obeyed_ = 0;
  std::uint64_t ignored_ = 0;
  bool stuck_ = false;
};

}  // namespace telekerf::plant
