// SPDX-License-Identifier: Apache-2.0
// What an operator who wants a depth has to do, and how deep the cut is so far along the contour. By the
// model of the material (common/workpiece/line_depth.h): nothing measures the depth.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/geometry/nearest.h"
#include "common/workpiece/beam.h"
#include "common/workpiece/material.h"

namespace telekerf::master {

/// As the slave's settings of these names.
struct CutPower {
  double laser_w = 10.0;
  workpiece::BeamPowerSettings power;
};

/// What who drives has said of the work. No other process knows of it.
struct DepthWish {
  static constexpr double kDeepest_m = 0.1;  ///< deeper than any material is thick
  const workpiece::Material* material = nullptr;  ///< null: nobody has said
  std::optional<double> depth_m;                  ///< within [0, kDeepest_m]; 0: none is wished; none: nobody has said
  bool said() const noexcept { return material != nullptr || depth_m; }
  const workpiece::Material& material_or_wood() const noexcept { return material ? *material : workpiece::kWood; }
};

/// Of one material and wished depth.
class DepthPlan {
 public:
  DepthPlan(const CutPower& cut, const workpiece::Material& material, double depth_m);

  /// Of one pass, m, at any speed that the power follows: up to full_speed_m_per_s().
  double pass_m() const noexcept { return pass_m_; }
  double full_speed_m_per_s() const noexcept {
    return workpiece::BeamPowerSettings::kMost * cut_.power.speed_m_per_s;
  }
  /// At which one pass has the wished depth, m/s on the workpiece; none: one pass is not so deep at any
  /// speed.
  std::optional<double> speed_m_per_s() const noexcept;
  /// What to do, one sentence.
  std::string sentence() const;

 private:
  CutPower cut_;
  const workpiece::Material* material_;
  double depth_m_;  ///< wished; 0: none
  double pass_m_;
};

/// The estimate along a contour, in equal pieces of its length from its first point on.
class DepthTrail {
 public:
  static constexpr double kPiece_m = 0.25e-3;
  static constexpr std::size_t kMostPieces = 1024;  ///< of a longer contour the pieces are longer
  static constexpr double kFarthest_m = 0.5e-3;     ///< what is burnt further off belongs to no piece

  /// Another contour, or another material: nothing is cut yet.
  void begin(const geometry::Polyline& contour);
  /// The beam was on for `dt_s` at `place_m` (contour's frame), the tool moving at `speed_m_per_s`. Depth by
  /// length is depth times speed, by time: what a piece gets is that over its length.
  void burn(const Vec2& place_m, double speed_m_per_s, double dt_s) noexcept;
  /// Depth of each piece, m, in the material that it is told of; no deeper than that is thick.
  std::vector<float> depths_m(const CutPower& cut, const workpiece::Material& material) const;
  void set_power(const workpiece::BeamPowerSettings& power) noexcept { power_ = power; }
  /// Of each piece: time with light, each second weighed by the share of the power.
  const std::vector<double>& lit_s() const noexcept { return lit_s_; }
  /// Adds what was lit before; of another count of pieces nothing.
  void add(const std::vector<double>& lit_s) noexcept;
  /// Counts what has changed.
  std::uint64_t version() const noexcept { return version_; }

 private:
  workpiece::BeamPowerSettings power_;
  std::unique_ptr<geometry::NearestIndex> line_;
  std::vector<double> lit_s_;
  double piece_m_ = kPiece_m;
  std::uint64_t version_ = 0;
};

}  // namespace telekerf::master
