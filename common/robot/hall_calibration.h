// SPDX-License-Identifier: Apache-2.0
// What a commissioning sweep tells about Hall sensors that are not quite alike (eq. 147-154).
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "common/robot/hall_sensor.h"

namespace telekerf::robot {

/// Estimates the calibration from a sweep over one pitch or more, at any speed, in any direction, without
/// another sensor: the Clarke vector of imperfect channels runs on an ellipse; the map that makes it a circle
/// gives phi, and phi gives each channel's sine. Common to all channels, a phase cannot be seen: the mean
/// phase is set to zero, and homing (HallDecoder::home) takes that constant away. nullopt: fewer than 16
/// samples, or they cover too little.
std::optional<HallCalibration> calibrate_hall(std::span<const HallCounts> sweep, int adc_bits);

/// Position error over a path there and back, its mean (which homing removes) taken out.
struct HallAccuracy {
  double rms_m = 0;
  double worst_m = 0;
};

/// Accuracy of one joint with sensors drawn from `seed`, read as ideal ones or through a calibration of their
/// own.
HallAccuracy hall_accuracy(const Sensor& sensor, double path_m, std::uint64_t seed, bool calibrated);

}  // namespace telekerf::robot
