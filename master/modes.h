// SPDX-License-Identifier: Apache-2.0
// What the master is about: holding, bringing the tool to the curve, guiding the hand, leading the slave.
#pragma once

#include <cstdint>

#include "common/control/kinematic_state.h"
#include "common/protocol/messages.h"
#include "master/constraint/guide_path.h"

namespace telekerf::master {

using control::KinematicState;

enum class MasterMode : std::uint8_t {
  kIdle,      ///< no contour: holds its pose
  kApproach,  ///< brings the tool to the curve
  kGuiding,   ///< the hand moves on the curve, the slave does not follow
  kEngaged,   ///< the slave follows
  kStopped,   ///< latched emergency stop: holds its pose
};

/// What the choice of the mode depends on, of one control step.
struct Situation {
  const GuidePath* guide = nullptr;  ///< null: no contour yet
  Vec3 tool_m = Vec3::Zero();
  bool stopped = false;      ///< emergency stop
  bool engage = false;       ///< the operator wants the slave to follow
  bool slave_ready = false;  ///< it is alive, not stopped, would follow, and works on the same contour
};

class Modes {
 public:
  /// `approach_m_per_s`: mean speed at which the tool is brought to the curve.
  Modes(double approach_m_per_s, double dt_s) noexcept : approach_m_per_s_(approach_m_per_s), dt_s_(dt_s) {}

  void rest_at(const Vec3& position_m) noexcept { hold_m_ = position_m; }
  /// Every control step, once. True: another curve is to be followed from now on.
  bool step(const Situation& now) noexcept;
  /// The wish to engage is over: the operator has to say it anew. Of the last step.
  bool engage_spent() const noexcept { return engage_spent_; }

  MasterMode mode() const noexcept { return mode_; }
  const GuidePath* guide() const noexcept { return guide_; }
  /// Every control step in which no hand is guided, once: what the tool is held to.
  KinematicState goal() noexcept;

 private:
  void begin_approach(const Vec3& tool_m) noexcept;
  KinematicState approach() noexcept;

  double approach_m_per_s_;
  double dt_s_;
  MasterMode mode_ = MasterMode::kIdle;
  const GuidePath* guide_ = nullptr;
  bool engage_spent_ = false;
  Vec3 hold_m_ = Vec3::Zero();
  Vec3 approach_from_m_ = Vec3::Zero();
  Vec3 approach_to_m_ = Vec3::Zero();
  double approach_s_ = 0.0;
  double approach_duration_s_ = 0.0;
};

}  // namespace telekerf::master
