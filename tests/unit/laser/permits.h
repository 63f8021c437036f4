// SPDX-License-Identifier: Apache-2.0
// An interlock whose every input is good, the permits that it makes, and an output that they open.
#pragma once

#include <string>
#include <utility>

#include "common/runtime/startup_error.h"
#include "slave/laser/interlock.h"
#include "slave/laser/laser_output.h"

namespace telekerf::laser {

inline InterlockInputs all_good() {
  return {.stopped = false,
          .fault = false,
          .contour_known = true,
          .engaged = true,
          .armed = true,
          .button_armed = true,
          .fresh = true,
          .unlit = true,
          .on_time = true,
          .emission_agrees = true,
          .monitor_agrees = true,
          .command_age_s = 0.0,
          .radius_m = 0.0,
          .height_m = 0.0,
          .contour_distance_m = 0.0,
          .arc_gap_m = 0.0,
          .predicted_distance_m = 0.0,
          .speed_m_per_s = 0.0,
          .cut_speed_m_per_s = 0.0,
          .tracking_error_m = 0.0,
          .offset_m = 0.0,
          .power_w = 0.0,
          .dose_j = 0.0,
          .area_dose_j_per_mm2 = 0.0};
}

/// Of a machine of 15 mm workspace, half a metre a second and a kilowatt.
inline InterlockSettings of_a_machine() {
  InterlockSettings settings;
  settings.workspace_radius_m = 0.015;
  settings.max_speed_m_per_s = 0.5;
  settings.max_power_w = 1000.0;
  return settings;
}

/// Steps of a millisecond.
class Permits {
 public:
  static constexpr std::int64_t kPeriod_ns = 1'000'000;

  /// Of the next step, for so much power.
  Permit next(double power_w = 1000.0) {
    now_ns += kPeriod_ns;
    InterlockInputs inputs = all_good();
    inputs.power_w = power_w;
    return interlock.decide(now_ns, inputs).permit;
  }

  BeamInterlock interlock{of_a_machine(), kPeriod_ns};
  std::int64_t now_ns = 0;
};

inline LaserOutputSettings named(const std::string& laser) {
  LaserOutputSettings settings;
  settings.laser = laser;
  return settings;
}

/// With the power that it may never exceed.
inline LaserOutputSettings stated(const std::string& laser, double laser_max_w = 20.0) {
  LaserOutputSettings settings = named(laser);
  settings.laser_max_w = laser_max_w;
  return settings;
}

/// Of an output with these settings, or "accepted".
inline std::string refusal_of(const LaserOutputSettings& settings, double laser_w) {
  try {
    const LaserOutput beam(settings, laser_w, 1000.0);
  } catch (const StartupError& refusal) {
    return refusal.what();
  }
  return "accepted";
}

/// The output with an interlock that permits whatever it is asked for.
class Permitted {
 public:
  template <class... Arguments>
  explicit Permitted(Arguments&&... arguments) : output(std::forward<Arguments>(arguments)...) {}
  double emit(double power_w, bool pilot) {
    Permit permit = permits.next();
    return output.emit(std::move(permit), permits.now_ns, power_w, pilot);
  }

  Permits permits;
  LaserOutput output;
};

}  // namespace telekerf::laser
