// SPDX-License-Identifier: Apache-2.0
#include "slave/laser/laser_output.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/runtime/settings.h"
#include "slave/laser/udp_laser.h"

namespace telekerf::laser {
namespace {

// A distant host says once a second at most that nobody listens, a near one every time.
constexpr double kMemory_s = 4.0;
constexpr double kEnough = 3.0;

// A laser of your own: its header above, and one row.
constexpr LaserKind kKinds[] = {
    kSimulatedLaser,
    kUdpLaser,
    kPlantLaser,
};
constexpr LaserRegistry kLasers("laser", kKinds);

}  // namespace

std::string validate_laser(const std::string& laser) { return kLasers.validate(laser); }

bool LaserOutputSettings::simulated() const {
  return laser == kSimulatedLaser.name || laser.starts_with(std::string(kPlantLaser.name) + ":");
}

void LaserOutputSettings::add_parameters(Settings& settings) {
  settings.add("laser", laser, device_form(kLasers.forms(), validate_laser), "what makes the beam");
  settings.add("laser_max_w", laser_max_w, {.min = 0, .max = 1000, .unit = "W"},
               "power that the laser is never asked to exceed, 0: 1000 of a simulated one; any other must "
               "have it stated");
}

void LaserOutputSettings::validate(double laser_w) const {
  if (!simulated() && laser_max_w <= 0.0) {
    throw configuration_error(fmt::format(
        "laser = {}: laser_max_w must be stated for a laser that is not simulated; give the power that "
        "it may never exceed",
        laser));
  }
  if (laser_w <= max_w()) return;
  throw configuration_error(
      fmt::format("laser_w = {:g} must be at most laser_max_w = {:g}; lower it, or raise "
                  "laser_max_w if the laser can give more",
                  laser_w, max_w()));
}

LaserOutput::LaserOutput(const LaserOutputSettings& settings, double laser_w, double control_hz,
                         std::unique_ptr<Laser> laser)
    : name_(settings.laser),
      max_w_(settings.max_w()),
      lasts_ns_(std::llround(2e9 / control_hz)),
      forgotten_a_step_(1.0 / (kMemory_s * control_hz)) {
  settings.validate(laser_w);
  laser_ = laser ? std::move(laser) : kLasers.open(settings.laser, control_hz);
  off();
}

double LaserOutput::emit(Permit permit, std::int64_t now_ns, double power_w, bool pilot) noexcept {
  if (!std::isfinite(power_w) || power_w < 0.0) power_w = 0.0;
  const bool permitted = permit.tick() > used_tick_ && permit.covers(now_ns);
  if (permitted) used_tick_ = permit.tick();
  const double most_w = permitted ? permit.max_w() : 0.0;
  if (power_w > most_w) {
    power_w = most_w;
    ++unpermitted_;
  }
  if (power_w > max_w_) {
    power_w = max_w_;
    ++clipped_;
  }
  return tell({.power_w = power_w,
               .pilot = pilot,
               .lasts_ns = permitted ? permit.end_ns() - now_ns : lasts_ns_,
               .enable = permitted ? permit.tick() : 0});
}

double LaserOutput::tell(const Emission& emission) noexcept {
  Emission told = emission;
  if (failed_) told = {};
  if (laser_->emit(told)) {
    doubts_ = std::max(0.0, doubts_ - forgotten_a_step_);
  } else {
    ++write_failures_;
    failed_ = failed_ || ++doubts_ >= kEnough;
  }
  if (emission_agrees()) stray_steps_ = laser_->stray() ? stray_steps_ + 1 : 0;
  failed_ = failed_ || !emission_agrees();
  return told.power_w;
}

std::string LaserOutput::failure() const {
  if (!emission_agrees()) {
    return fmt::format(
        "laser = {}: it gives light that it was not told to give, so it is told nothing but off any more; "
        "cut its power, and have it looked at",
        name_);
  }
  return fmt::format(
      "laser = {}: it no longer hears what it is told, so nothing is cut any more; is it switched on, "
      "connected, and its port right?",
      name_);
}

}  // namespace telekerf::laser
