// SPDX-License-Identifier: Apache-2.0
// A second judgement of the beam that shares nothing with the first but the raw joint readings: kinematics of
// its own in single precision, a corridor of its own as a raster, and no controller, observer or clock.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "common/geometry/polyline.h"
#include "common/robot/robot.h"
#include "common/robot/robot_model.h"

namespace telekerf::laser {

/// Cells of the workpiece from which the contour is at most the corridor away; built outside the loop.
class CorridorRaster {
 public:
  static constexpr float kCell_m = 0.05e-3F;

  /// `half_m`: of the corridor. What is drawn beyond `radius_m` of the workspace is left out.
  CorridorRaster(std::span<const geometry::Polyline> lines, double half_m, double radius_m);
  CorridorRaster(const geometry::Polyline& line, double half_m, double radius_m)
      : CorridorRaster(std::span(&line, 1), half_m, radius_m) {}
  /// False for what is no place.
  bool holds(float x_m, float y_m) const noexcept;

 private:
  void draw(const geometry::Polyline& line, double half_m);
  void draw(const Vec2& from_m, const Vec2& to_m, double half_m);
  float origin_m_;
  int side_;
  std::vector<std::uint8_t> cells_;
};

/// The tool in the workpiece frame from joint positions, in base_T_workpiece's translation. NaN: no pose.
class SingleKinematics {
 public:
  explicit SingleKinematics(const robot::RobotModel& model) noexcept;
  std::array<float, 3> tool_m(const std::array<float, 3>& joints_m) const noexcept;

 private:
  struct Leg {
    std::array<float, 3> origin_m;
    std::array<float, 3> rail;
    float rod_m;
  };
  std::array<Leg, 3> legs_;
  std::array<float, 3> centre_m_;
  float side_;  ///< 1: the tool is above the carriages
};

/// Light outside the corridor, above or below the workpiece, after a stop or without a reading, in two steps
/// in a row, is a fault that stays.
class BeamMonitor {
 public:
  static constexpr int kSteps = 2;

  explicit BeamMonitor(const robot::RobotModel& model, double max_height_m) noexcept
      : kinematics_(model), max_height_m_(static_cast<float>(max_height_m)) {}

  /// After every control step, with its reading and whether the laser was told to give light. Null: no
  /// contour.
  void step(const robot::JointReading& reading, const CorridorRaster* corridor, bool stopped,
            bool lit) noexcept;
  bool agrees() const noexcept { return against_ < kSteps; }

 private:
  SingleKinematics kinematics_;
  float max_height_m_;
  int against_ = 0;  ///< steps in a row; at kSteps for good
};

}  // namespace telekerf::laser
