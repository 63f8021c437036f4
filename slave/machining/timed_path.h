// SPDX-License-Identifier: Apache-2.0
// When the tool is where: speed along the path from curvature and limits, corner policy, one reference a
// tick.
#pragma once

#include <string>
#include <vector>

#include "common/robot/robot_model.h"
#include "common/runtime/enum_table.h"
#include "slave/laser/pulsed_source.h"
#include "slave/machining/path.h"

namespace telekerf::machining {

/// What to do where the contour has a corner.
enum class CornerPolicy : std::uint8_t {
  kExact,    ///< as little rounding as a sampled path allows, constant speed
  kRounded,  ///< rounded up to a tolerance, constant speed
  kSlow,     ///< adaptive preview (thesis 9.2): little rounding, speed by curvature, power follows speed
};
inline constexpr EnumRow<CornerPolicy> kCornerRows[] = {
    {"exact", CornerPolicy::kExact, "as little rounding as a sampled path allows, constant speed"},
    {"rounded", CornerPolicy::kRounded, "rounded up to a tolerance, constant speed"},
    {"slow", CornerPolicy::kSlow, "little rounding, speed by curvature, power follows speed"},
};
inline constexpr EnumTable<CornerPolicy> kCorners(kCornerRows);

struct TimedPathSettings {
  double control_hz = 2400.0;
  double speed_m_per_s = 8e-3;
  CornerPolicy corner = CornerPolicy::kRounded;
  double tolerance_m = 10e-6;                ///< of kRounded
  double slow_acceleration_m_per_s2 = 0.25;  ///< of kSlow: across the path, and along it
  double max_acceleration_m_per_s2 = 10.0;   ///< whatever the policy
  double max_speed_m_per_s = 0.3;            ///< more is refused
  double ramp_m_per_s2 = 2.0;                ///< run-up and run-out along the path, beam off
  double smoothing_s = 0.012;                ///< of the speed in time, so that acceleration is continuous
  double settle_s = 0.15;                    ///< at full speed before the beam comes on, but ...
  double settle_m = 2e-3;                    ///< ... not longer than this
  double overlap_m = 0.2e-3;                 ///< a closed contour is cut this far beyond its start
  double spot_radius_m = laser::PulsedSourceSettings{}.spot_radius_m;  ///< of the beam, for an even burn

  /// For a machine of these limits. Half of its acceleration and nine tenths of its speed are planned with,
  /// the rest is for following.
  void keep_within(const robot::ToolLimits& limits) noexcept;
};

/// What the controllers follow at one tick, workpiece frame.
struct Reference {
  Vec3 position_m = Vec3::Zero();
  Vec3 velocity_m_per_s = Vec3::Zero();
  Vec3 acceleration_m_per_s2 = Vec3::Zero();
  // The moving frame's tangent and its derivatives by arc length (they exist at rest, too).
  Vec3 tangent = Vec3::UnitX();
  Vec3 tangent_s = Vec3::Zero();
  Vec3 tangent_ss = Vec3::Zero();
  double speed_m_per_s = 0.0;
  double speed_rate_m_per_s2 = 0.0;
  double arc_length_m = 0.0;
  bool beam = false;  ///< within the contour: the beam may be on
  /// Share of the full power: follows the speed, so that each millimetre gets the same energy, and goes down
  /// where the spot meets another part of the path (sharp corners, crossings, a closed contour's overlap).
  double power = 0.0;
};

/// References at equal ticks; beyond its ends the trajectory stands still.
class Trajectory {
 public:
  explicit Trajectory(std::vector<Reference> points) : points_(std::move(points)) {}
  std::size_t size() const noexcept { return points_.size(); }
  const Reference& operator[](std::size_t tick) const noexcept { return points_[tick]; }
  void replace(std::size_t tick, const Reference& reference) noexcept { points_[tick] = reference; }
  /// At a tick that may lie between two; clamped at the ends (with zero derivatives beyond). Real-time.
  Reference at(double tick) const noexcept;

 private:
  std::vector<Reference> points_;
};

struct TimedPath {
  Path path;
  Trajectory trajectory;
  double period_s = 0.0;
  double cut_s = 0.0;               ///< time with the beam on
  double mean_speed_m_per_s = 0.0;  ///< with the beam on
  double slowest_m_per_s = 0.0;
  double time_s() const noexcept { return period_s * static_cast<double>(trajectory.size()); }
};

/// How far the path may leave the contour's points under a policy.
PathSettings path_settings(const TimedPathSettings& settings) noexcept;
/// The error is one sentence. Speeds above what the machine's acceleration allows are lowered, never refused.
tl::expected<TimedPath, std::string> make_timed_path(Path path, const TimedPathSettings& settings);
tl::expected<TimedPath, std::string> make_timed_path(const geometry::Polyline& contour,
                                                     const TimedPathSettings& settings);

}  // namespace telekerf::machining
