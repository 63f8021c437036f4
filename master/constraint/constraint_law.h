// SPDX-License-Identifier: Apache-2.0
// Guidance and forbidden-region virtual fixture (thesis 5.2): the acceleration that keeps the tool on the
// curve (eq. 58-78 with eq. 165 corrected) or inside a corridor around it. Master's workpiece frame.
#pragma once

#include "common/control/kinematic_state.h"
#include "master/constraint/constraint_generator.h"
#include "master/constraint/constraint_settings.h"

namespace telekerf::master {

using control::KinematicState;

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

/// Desired tool acceleration of the guidance fixture, m/s^2: e'' + K2 e' + K1 e = 0 across the curve and in z
/// (eq. 65), and along it what the hand's force `hand_n` (estimated) does to the virtual mass, within the
/// speed limit of the bends. `felt_n`: acts on that mass as well, along the curve.
Vec3 guided_acceleration(const ActiveConstraint& active, const ConstraintSettings& settings,
                         const KinematicState& tool, const Vec3& hand_n,
                         const ConstraintReference& reference = {}, double felt_n = 0.0) noexcept;

/// The part of it that answers an error across the curve and in z: -K2 e' - K1 e.
Vec3 guiding_correction(const ActiveConstraint& active, const ConstraintSettings& settings,
                        const KinematicState& tool, const ConstraintReference& reference = {}) noexcept;

/// The same of the forbidden-region fixture: the hand moves the virtual mass in the plane, a spring draws it
/// to the curve, and at the corridor's edge stands a wall that pushes but never holds back.
Vec3 region_acceleration(const ActiveConstraint& active, const ConstraintSettings& settings,
                         const ConstraintMode& mode, const KinematicState& tool, const Vec3& hand_n) noexcept;

}  // namespace telekerf::master
