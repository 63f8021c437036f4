// SPDX-License-Identifier: Apache-2.0
// A controller and the joints under it: readings and references in, currents out, one step at a time.
#pragma once

#include "common/control/joint_acceleration_control.h"
#include "common/runtime/enum_table.h"
#include "slave/machining/controller.h"

namespace telekerf::machining {

enum class ControllerKind : std::uint8_t {
  kAuto,  ///< contouring on closed contours, preview on open ones
  kIndependent,
  kPreview,
  kContouring,
};
inline constexpr EnumRow<ControllerKind> kControllerRows[] = {
    {"auto", ControllerKind::kAuto, "contouring on closed contours, preview on open ones"},
    {"independent", ControllerKind::kIndependent, "every joint for itself"},
    {"preview", ControllerKind::kPreview, "joints with the accelerations of the samples to come"},
    {"contouring", ControllerKind::kContouring, "loops along and across the path"},
};
inline constexpr EnumTable<ControllerKind> kControllers(kControllerRows);

/// What of the robot's file is used beside feedback.
enum class ModelUse : std::uint8_t {
  kNone,    ///< the joints' masses at the start (eq. 21); all else is left to the observer
  kJoints,  ///< every joint for itself: also its friction and its weight at the start, and preview
  kWhole,   ///< A(q), weight, Coriolis force and friction
};

struct PathFollowerSettings {
  double control_hz = 2400.0;
  int loop_delay = 0;                 ///< samples from a reading to the effect of its currents
  bool preview = true;                ///< false: accelerations of the same tick, as if the loop had no delay
  double along_rad_s = 70.0;          ///< bandwidth of all joints, or along the path
  double across_rad_s = 240.0;        ///< contouring: across the path
  double observer_rad_s = 400.0;      ///< of the disturbance
  double velocity_rad_s = 900.0;      ///< of the velocity estimate
  ModelUse model = ModelUse::kWhole;  ///< preview, contouring
  ModelUse independent_model = ModelUse::kNone;  ///< as in the thesis (eq. 21, 32)

  /// Bandwidths of the observer that fit a speed: sensor noise makes the same ripple in m/s at any speed, so
  /// slow paths get a quieter loop; there friction changes its direction more slowly, too. `stiff` keeps the
  /// observer faster than that: at corners friction changes at once, and an even burn matters more than
  /// ripple.
  void tune_for_speed(double speed_m_per_s, bool stiff = false) noexcept;
};

/// The controller of a kind with gains and preview that match the loop.
Controller make_controller(ControllerKind kind, bool closed, const PathFollowerSettings& settings) noexcept;
control::JointAccelerationSettings joint_settings(ControllerKind kind,
                                                  const PathFollowerSettings& settings) noexcept;
ModelUse model_use(ControllerKind kind, const PathFollowerSettings& settings) noexcept;

class PathFollower {
 public:
  PathFollower(const robot::RobotModel& nominal, const control::JointAccelerationSettings& joints,
               const Controller& controller, ModelUse model_use) noexcept
      : model_(nominal),
        kinematics_(nominal.geometry),
        origin_in_base_m_(nominal.in_base(Vec3::Zero())),
        ahead_(joints.observer.loop_delay + 0.5),
        model_use_(model_use),
        joints_(nominal, joints),
        controller_(controller) {}

  void reset(const Vec3& joints_m) noexcept;
  /// Another law from the next step on; at rest it is taken over without a jump.
  void use(const Controller& controller) noexcept { controller_ = controller; }
  /// Currents in A. A reference that is no pose of the robot gives the currents that hold it where it is.
  Vec3 step(const robot::JointReading& reading, const Trajectory& trajectory, double tick) noexcept;
  /// Observed tool, workpiece frame.
  Vec3 tool_m() const noexcept { return joints_.state().tool_m - origin_in_base_m_; }
  /// Share of the beam's power that gives each millimetre the same energy: what was planned, corrected by the
  /// observed speed along the path (corners, friction), at most half as much again.
  double beam_power(const Reference& reference) const noexcept;
  const control::JointAccelerationControl& joints() const noexcept { return joints_; }

 private:
  Vec3 expected_force(const Tracking& now) const noexcept;

  robot::RobotModel model_;
  robot::DeltaKinematics kinematics_;
  Vec3 origin_in_base_m_;
  double ahead_;  ///< samples until the currents act, on average
  ModelUse model_use_;
  Vec3 weight_n_ = Vec3::Zero();  ///< on the joints at the start
  control::JointAccelerationControl joints_;
  Controller controller_;
};

}  // namespace telekerf::machining
