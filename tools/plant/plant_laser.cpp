// SPDX-License-Identifier: Apache-2.0
#include "tools/plant/plant_laser.h"

#include <fmt/format.h>

#include <algorithm>
#include <boost/asio/buffer.hpp>
#include <utility>

#include "common/runtime/clock.h"
#include "common/runtime/startup_error.h"

namespace telekerf::plant {
namespace {

namespace asio = boost::asio;
using asio::ip::udp;

/// Pieces of light are at most this long.
constexpr std::int64_t kPiece_ns = 1'000'000;

}  // namespace

PlantLaser::PlantLaser(asio::io_context& context, const PlantLaserSettings& settings,
                       const robot::SimulatedRobot& robot, const Vec3& workpiece_in_base_m, double radius_m,
                       Contour contour)
    : settings_(settings),
      robot_(robot),
      workpiece_in_base_m_(workpiece_in_base_m),
      contour_(std::move(contour)),
      socket_(context),
      seal_(settings.key),
      device_(settings.max_w),
      book_(radius_m),
      booked_ns_(monotonic_ns()) {
  boost::system::error_code error;
  socket_.open(udp::v4(), error);
  const auto port = static_cast<std::uint16_t>(settings.port);
  if (!error) socket_.bind({asio::ip::address_v4::loopback(), port}, error);
  if (!error) socket_.non_blocking(true, error);
  if (error)
    throw environment_error(
        fmt::format("laser_port = {}: {}; use a free one, or 0 for any", port, error.message()));
  receive();
}

void PlantLaser::receive() {
  socket_.async_receive_from(incoming_.room(), from_,
                             [this](boost::system::error_code error, std::size_t size) {
                               // What waits came at one time: of a queue from a sleep the newest alone gives
                               // light.
                               const std::int64_t now_ns = monotonic_ns();
                               while (!error) {
                                 hear(size, now_ns);
                                 size = socket_.receive_from(incoming_.room(), from_, 0, error);
                               }
                               receive();
                             });
}

void PlantLaser::hear(std::size_t size, std::int64_t now_ns) {
  book_until(now_ns);
  const bool lit = device_.power_w(now_ns) > 0.0;
  const laser::SealedPower& sealed = incoming_.datagram;
  if (!device_.hear(sealed.datagram, seal_.open(sealed, size), from_, now_ns)) {
    ++ignored_;
    return;
  }
  ++obeyed_;
  if (lit && device_.power_w(now_ns) <= 0.0) book_.dark(DarkBy::kTold, 0);
  boost::system::error_code ignored;  // who does not hear it has no measurement
  laser::SealedEmission answer{device_.answer(now_ns)};
  const std::size_t whole = seal_.close(answer);
  socket_.send_to(asio::buffer(&answer, whole), from_, 0, ignored);
}

void PlantLaser::book_until(std::int64_t now_ns) {
  const std::int64_t dark_ns = device_.dark_ns();
  while (booked_ns_ < std::min(now_ns, dark_ns)) {
    const std::int64_t to_ns = std::min({booked_ns_ + kPiece_ns, now_ns, dark_ns});
    book_.add(booked_ns_, to_ns, beam_at(to_ns), device_.power_w(booked_ns_), contour_());
    booked_ns_ = to_ns;
  }
  booked_ns_ = now_ns;
  if (now_ns >= dark_ns) book_.dark(DarkBy::kItself, dark_ns - device_.heard_ns());
  if (!stuck_ && settings_.stuck_after_j > 0.0 && book_.energy_j() > settings_.stuck_after_j) {
    stuck_ = true;
    device_.stick(settings_.max_w);
  }
}

Vec2 PlantLaser::beam_at(std::int64_t time_ns) const noexcept {
  const std::int64_t coasted_ns = std::max<std::int64_t>(0, time_ns - device_.heard_ns() - kPiece_ns);
  const Vec3 tool_m = robot_.true_tool_in_base_m() - workpiece_in_base_m_ +
                      1e-9 * static_cast<double>(coasted_ns) * robot_.true_tool_velocity_m_per_s();
  return tool_m.head<2>();
}

}  // namespace telekerf::plant
