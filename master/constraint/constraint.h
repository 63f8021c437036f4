// SPDX-License-Identifier: Apache-2.0
// The virtual constraint of thesis 3.3 and 5.1-5.2: which circle is in force at the tool (Algorithm 1), and
// the acceleration that keeps the tool on it (eq. 58-78 with eq. 165 corrected) or inside a corridor around
// it. Master's workpiece frame.
#pragma once

#include <optional>

#include "master/constraint/constraint_settings.h"
#include "master/constraint/guide_path.h"

namespace telekerf::master {

/// The circle (or line) that is in force for one tick; frozen within it (c' = 0).
struct ActiveConstraint {
  GuidePiece piece;
  double phi_m = 0.0;          ///< signed distance of the tool, positive to the left of travel
  double drift_m_per_s = 0.0;  ///< partial time derivative of phi: the circle is not the last tick's
  double beyond_end_m = 0.0;   ///< how far the tool is past an end of an open curve (signed)
  GuidePath::SpeedLimit limit{1.0, 0.0};
};

/// Algorithm 1 with a local search from the last foot point, so that a tool at a crossing stays on its
/// branch.
class ConstraintGenerator {
 public:
  void reset() noexcept { last_.reset(); }
  ActiveConstraint at(const GuidePath& guide, const Vec2& tool_m, double dt_s) noexcept;

 private:
  std::optional<GuidePiece> last_;
};

/// phi^ref of eq. 61 for the constraint in plane and for z. Zero but for what is left of an entry.
struct ConstraintReference {
  Vec2 place_m = Vec2::Zero();
  Vec2 velocity_m_per_s = Vec2::Zero();
  Vec2 acceleration_m_per_s2 = Vec2::Zero();
};

/// Inside a corridor of this half width the hand is free but for a spring towards the curve; 0: guidance.
struct ConstraintMode {
  double corridor_m = 0.0;
  double stiffness_n_per_m = 0.0;
};

struct ToolState {
  Vec3 position_m = Vec3::Zero();
  Vec3 velocity_m_per_s = Vec3::Zero();
  Vec3 hand_n = Vec3::Zero();  ///< estimated force of the hand
};

/// Desired tool acceleration in the guidance form: e'' + K2 e' + K1 e = 0 across the curve and in z (eq. 65),
/// and along it what the hand's force does to the virtual mass, within the speed limit of the bends.
Vec3 guided_acceleration(const ActiveConstraint& active, const ConstraintSettings& settings,
                         const ToolState& tool, const ConstraintReference& reference = {}) noexcept;

/// The same in the forbidden-region form: the hand moves the virtual mass in the plane, a spring draws it to
/// the curve, and at the corridor's edge stands a wall that pushes but never holds back.
Vec3 region_acceleration(const ActiveConstraint& active, const ConstraintSettings& settings,
                         const ConstraintMode& form, const ToolState& tool) noexcept;

/// Generator and law together, with entries and changes of form that fade instead of jumping.
class ConstraintController {
 public:
  explicit ConstraintController(const ConstraintSettings& settings) noexcept
      : settings_(settings), form_{settings.corridor_m, settings.stiffness_n_per_m} {}

  /// The next step starts on the curve nearest to the tool, wherever that is.
  void enter() noexcept;
  void choose(const ConstraintMode& form) noexcept;
  /// Desired tool acceleration, m/s^2.
  Vec3 step(const GuidePath& guide, const ToolState& tool, double dt_s) noexcept;

  const ActiveConstraint& active() const noexcept { return active_; }
  const ConstraintMode& form() const noexcept { return form_; }

 private:
  void begin_entry(const ToolState& tool) noexcept;
  ConstraintReference reference() const noexcept;
  Vec2 parked(const ToolState& tool) noexcept;

  ConstraintSettings settings_;
  ConstraintMode form_;
  ConstraintGenerator generator_;
  ActiveConstraint active_;
  bool entering_ = true;
  std::optional<Vec2> parked_m_;       ///< where a tool that nobody moves came to rest
  Vec2 entry_m_ = Vec2::Zero();        ///< offset in plane and in z at entry
  Vec2 entry_m_per_s_ = Vec2::Zero();  ///< and its rate
  double entered_s_ = 0.0;
  double entry_duration_s_ = 0.0;
  double faster_m_per_s_ = 0.0;  ///< than the bends allow, left over from the free form
  double opened_s_ = 1e9;        ///< since guidance became a corridor
};

}  // namespace telekerf::master
