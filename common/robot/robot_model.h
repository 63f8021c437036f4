// SPDX-License-Identifier: Apache-2.0
// One robot as numbers: geometry, masses, motors, sensors, friction, limits; read from a robot file (TOML).
#pragma once

#include <cstdint>
#include <string>

#include "common/robot/delta_kinematics.h"
#include "common/robot/workspace.h"
#include "common/runtime/enum_table.h"

namespace telekerf::robot {

struct Motor {
  double mass_kg = 0.1;  ///< everything that moves with one carriage
  double force_constant_n_per_a = 6.0;
  double continuous_force_n = 4.0;
  double peak_force_n = 10.0;
};

/// How joint positions are measured.
struct Sensor {
  enum class Kind : std::uint8_t { kEncoder, kHall };
  Kind kind = Kind::kEncoder;
  double resolution_m = 0.5e-6;  ///< encoder: one count
  double pitch_m = 0.018;        ///< Hall: magnetic period (eq. 150)
  int adc_bits = 16;             ///< Hall: converter, over 1.25 x the nominal amplitude to either side
  double noise = 0.0;            ///< Hall: rms of one conversion, as a share of its channel's amplitude
  int conversions = 1;           ///< Hall: of every channel for one reading, which is their mean
  double conversion_s = 5e-6;    ///< Hall: from one of them to the next; the last is of the reading's moment
  double gain_mismatch = 0.0;    ///< Hall: largest relative deviation of a channel's gain
  double phase_mismatch_rad = 0.0;  ///< Hall: largest misplacement of a channel
  bool calibrated = true;           ///< Hall: read through calibrate_hall()'s result, not as if ideal
  double offset_mismatch = 0.0;     ///< Hall: largest offset of a channel, as a share of its amplitude
};

inline constexpr EnumRow<Sensor::Kind> kSensorKindRows[] = {
    {"encoder", Sensor::Kind::kEncoder, "counts, without error between them"},
    {"hall", Sensor::Kind::kHall, "two Hall sensors a joint: noise, mismatch, calibration"},
};
inline constexpr EnumTable<Sensor::Kind> kSensorKinds(kSensorKindRows);

/// Friction of one joint (SI): (coulomb + (breakaway - coulomb) exp(-(v/stribeck)^2)) tanh(v/smoothing) +
/// viscous v.
struct Friction {
  double coulomb_n = 0.0;
  double breakaway_n = 0.0;
  double viscous_n_s_per_m = 0.0;
  double stribeck_velocity_m_per_s = 5e-3;
  double smoothing_velocity_m_per_s = 5e-4;
};

/// What the tool may be asked to do.
struct ToolLimits {
  double velocity_m_per_s = 0.5;
  double acceleration_m_per_s2 = 20.0;
};

struct RobotModel {
  std::string name;
  DeltaGeometry geometry;
  Motor motor;
  double tool_mass_kg = 0.1;
  /// Age of a reading when the force that answers it begins to act, beside the wait for the next control
  /// step: what fieldbus and converters take. 0: the reading is of the very moment.
  double drive_delay_s = 0.0;
  Sensor sensor;
  Friction friction;
  ToolLimits limits;
  Vec3 gravity_m_per_s2{0, 0, -9.80665};  ///< in base; says how the robot is mounted
  Workspace workspace;                    ///< in base

  /// The workpiece frame (x right, y up, z along the beam) has its origin in the workspace's centre:
  /// base_T_workpiece is a pure translation.
  Vec3 in_base(const Vec3& in_workpiece_m) const noexcept { return in_workpiece_m + workspace.centre_m; }
  Vec3 in_workpiece(const Vec3& in_base_m) const noexcept { return in_base_m - workspace.centre_m; }
};

/// Loads a shipped robot by name or a robot file by path. Only [geometry] is mandatory; without [workspace]
/// the largest upright cylinder is computed; a geometry that has none is refused, but not if only kinematics
/// are wanted (`with_workspace` false). Throws StartupError that names file, key, value and bound.
RobotModel load_robot(const std::string& name_or_path, bool with_workspace = true);

/// The same from text; `name` stands in messages.
RobotModel parse_robot(const std::string& toml, const std::string& name);

/// A machine that is not quite what its file says: masses, force constant and friction each off by up to
/// `share` (0.1: ten per cent), drawn from `seed`. Geometry stays.
RobotModel mismatched(const RobotModel& nominal, double share, std::uint64_t seed);

}  // namespace telekerf::robot
