// SPDX-License-Identifier: Apache-2.0
#include "slave/laser/beam.h"

#include <fmt/format.h>

#include <cmath>
#include <string_view>
#include <utility>

#include "common/runtime/device_table.h"
#include "common/runtime/settings.h"
#include "slave/laser/udp_laser.h"

namespace telekerf::slave {
namespace {

std::unique_ptr<Laser> simulated(std::string_view, double) { return std::make_unique<SimulatedLaser>(); }

std::unique_ptr<Laser> udp(std::string_view rest, double control_hz) {
  return std::make_unique<UdpLaser>(udp_address(rest), control_hz);
}

using Table = DeviceTable<std::unique_ptr<Laser>, double>;
constexpr Table::Kind kKinds[] = {
    {"simulated", "simulated", stands_alone, simulated},
    {"udp", "udp:HOST:PORT", complaint_about_udp, udp},
};
constexpr Table kLasers("laser", kKinds);

}  // namespace

std::string complaint_about_laser(const std::string& laser) { return kLasers.complaint(laser); }

void BeamSettings::declare(Settings& settings) {
  settings.add("laser", laser, fmt::format("what makes the beam ({})", kLasers.forms()),
               complaint_about_laser);
  settings.add("laser_max_w", laser_max_w, {.min = 0, .max = 1000},
               "power that the laser is never asked to exceed");
}

Beam::Beam(const BeamSettings& settings, double laser_w, double control_hz, std::unique_ptr<Laser> laser)
    : max_w_(settings.laser_max_w) {
  if (laser_w > max_w_) {
    throw Refusal(
        fmt::format("laser_w = {:g} must be at most laser_max_w = {:g}; lower it, or raise "
                    "laser_max_w if the laser can give more",
                    laser_w, max_w_));
  }
  laser_ = laser ? std::move(laser) : kLasers.attach(settings.laser, control_hz);
  off();
}

double Beam::emit(double power_w, bool pilot) noexcept {
  if (!std::isfinite(power_w) || power_w < 0.0) power_w = 0.0;
  if (power_w > max_w_) {
    power_w = max_w_;
    ++clipped_;
  }
  if (!laser_->emit(power_w, pilot)) ++untold_;
  return power_w;
}

}  // namespace telekerf::slave
