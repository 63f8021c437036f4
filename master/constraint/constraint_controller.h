// SPDX-License-Identifier: Apache-2.0
// The virtual constraint as the master's node uses it: circle, law, and what passes between them smoothly.
#pragma once

#include <optional>

#include "master/constraint/constraint_law.h"

namespace telekerf::master {

/// Generator and law together, with entries and changes of mode that fade instead of jumping.
class ConstraintController {
 public:
  explicit ConstraintController(const ConstraintSettings& settings) noexcept
      : settings_(settings), mode_{settings.corridor_m, settings.stiffness_n_per_m}, felt_(settings.felt) {}

  /// The next step starts on the curve nearest to the tool, wherever that is.
  void enter() noexcept;
  void set_mode(const ConstraintMode& mode) noexcept;
  /// Desired tool acceleration, m/s^2. `hand_n`: estimated force of the hand. `cutting`: the beam is wanted
  /// and the slave follows, so that there is a cut to be felt.
  Vec3 step(const GuidePath& guide, const KinematicState& tool, const Vec3& hand_n, double dt_s,
            bool cutting = false) noexcept;

  /// What of the last step's acceleration answered an error across the curve. A tool that a hand has pushed
  /// off is brought back by it; whoever follows the curve itself needs none of it.
  const Vec3& correction_m_per_s2() const noexcept { return correction_; }
  const ActiveConstraint& active() const noexcept { return active_; }
  const ConstraintMode& mode() const noexcept { return mode_; }
  const FeltCut& felt() const noexcept { return felt_; }

 private:
  void begin_entry(const KinematicState& tool) noexcept;
  ConstraintReference reference() const noexcept;
  /// Guidance, and along the curve what the hand feels of the cut.
  struct CutInHand {
    double beta = 1.0;
    bool wanted = false;
  };
  Vec3 guided(const KinematicState& tool, const Vec3& hand_n, const ConstraintReference& reference,
              double dt_s, const CutInHand& cut) noexcept;
  Vec2 hold_against_creep(const KinematicState& tool, const Vec3& hand_n) noexcept;

  ConstraintSettings settings_;
  ConstraintMode mode_;
  FeltCut felt_;
  ConstraintGenerator generator_;
  ActiveConstraint active_;
  Vec3 correction_ = Vec3::Zero();
  bool entering_ = true;
  std::optional<Vec2> rest_m_;         ///< where a tool that nobody moves came to rest
  Vec2 entry_m_ = Vec2::Zero();        ///< offset in plane and in z at entry
  Vec2 entry_m_per_s_ = Vec2::Zero();  ///< and its rate
  double entered_s_ = 0.0;
  double entry_duration_s_ = 0.0;
  double faster_m_per_s_ = 0.0;  ///< than the bends allow, left over from the corridor
  double opened_s_ = 1e9;        ///< since guidance became a corridor
};

}  // namespace telekerf::master
