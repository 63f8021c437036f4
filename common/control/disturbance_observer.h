// SPDX-License-Identifier: Apache-2.0
// Disturbance observer in joint space (eq. 21-23), with the velocity that the controllers use.
//
// Law: A_n qdd = K_n i - T_dis, with T_dis constant within a sample; T_hat = H(s) (K_n i - A_n qdd).
// Instead of differencing a quantised position twice, each joint runs the model [q, qd, w], w = -A_n^-1
// T_dis, driven by the force that was really applied and corrected by the measured position. H is then a
// third-order low-pass of gain 1 at rest: one pole at `bandwidth` (the thesis' g_i) and two at
// `velocity_bandwidth`.
//
// Discretisation: exact for a force held over the sample (zero-order hold); poles z = exp(-p T), which in
// this form gives the gains in closed form: with r = 1 - z and their elementary symmetric sums c1, c2, c3,
// alpha = c1 - c2 + c3, beta = c2 - 3/2 c3, gamma = c3.
//
// Missing readings: between two readings that are n samples apart the model goes on by itself, so that the
// second one corrects as in an observer of period n T with the same poles. With the gains of one sample a
// velocity would be corrected n times too much, and a robot whose every second reading is missing would be
// thrown to its stops.
//
// A hand that lets go: a force that comes or goes at once moves a joint at the next reading by more than any
// noise or friction does. That reading and the next are then answered at once, so that the estimate has the
// new force after two samples and the tool is not thrown by the one that is gone; were it always so fast, the
// loop would bear no robot that is off its file.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <limits>

#include "common/control/observer_gains.h"
#include "common/runtime/vectors.h"

namespace telekerf::control {

using Mat3 = Eigen::Matrix3d;

/// Most samples between a reading and the effect of the currents that answer it.
inline constexpr int kMaxLoopDelay = 4;

/// An innovation of one sample that is longer than `min_m` is a force that came or went at once, unless no
/// force could do as much (`max_m`); over a gap of n samples both are n^2 times as long.
struct AbruptForce {
  double min_m = std::numeric_limits<double>::infinity();
  double max_m = std::numeric_limits<double>::infinity();
};

class DisturbanceObserver {
 public:
  struct Gains {
    double period_s = 1e-3;
    double bandwidth_rad_per_s = 300;  ///< of the disturbance estimate
    double velocity_bandwidth_rad_per_s =
        900;  ///< of the velocity estimate; more: less lag, more sensor noise
    /// Samples from a reading to the effect of the force that answers it, 0..kMaxLoopDelay, whole or not.
    double loop_delay = 0.0;
    AbruptForce abrupt{};
  };

  explicit DisturbanceObserver(const Gains& gains) noexcept;

  /// At rest at `joints_m`; the disturbance starts from zero.
  void reset(const Vec3& joints_m) noexcept;

  /// First half of a sample: predicts over the last period with the force of applied().
  void predict() noexcept;
  /// Second half: corrects by the measurement. Left out where there is no reading.
  void correct(const Vec3& measured_joints_m) noexcept;
  /// Both; `valid` false: no reading.
  void update(const Vec3& measured_joints_m, bool valid) noexcept {
    predict();
    if (valid) correct(measured_joints_m);
  }

  /// What answers the last reading: the motor force *after* clipping (so nothing winds up at the limit) and
  /// the nominal inertia A_n that the estimate refers to (constant, or the model's A(q)). It acts from
  /// `loop_delay` samples after that reading on.
  void applied(const Vec3& force_n, const Mat3& nominal_inertia_kg) noexcept;

  const Vec3& joints_m() const noexcept { return q_; }
  const Vec3& joint_velocity_m_per_s() const noexcept { return v_; }
  /// What the forces that act now make of the joints by the model.
  const Vec3& acceleration_m_per_s2() const noexcept { return accelerations_[whole_delay_]; }
  /// Where the joints will be when the force that answers the last reading begins to act, by the forces that
  /// are on their way and the disturbance as it is.
  struct Ahead {
    Vec3 joints_m;
    Vec3 velocity_m_per_s;
  };
  Ahead ahead() const noexcept;
  /// T_hat of eq. 23: everything that differs from A_n qdd = K_n i, positive when it opposes positive motion.
  const Vec3& disturbance_n() const noexcept { return disturbance_n_; }

 private:
  const ObserverGains& gains_for(const Vec3& innovation_m) noexcept;

  double period_s_;
  AbruptForce abrupt_;
  /// Readings that come farther apart than this correct as if they did not.
  static constexpr std::size_t kLongestGap = 32;
  std::array<ObserverGains, kLongestGap> gains_;  ///< of readings 1, 2, ... samples apart
  std::size_t missed_ = 0;                        ///< samples since the last reading
  int since_abrupt_;                              ///< readings since a force came or went at once
  std::size_t whole_delay_;                       ///< samples
  double part_delay_;                             ///< of one more
  Vec3 q_ = Vec3::Zero();
  Vec3 v_ = Vec3::Zero();
  Vec3 w_ = Vec3::Zero();                              // disturbance as a joint acceleration, m/s^2
  std::array<Vec3, kMaxLoopDelay + 2> accelerations_;  // A_n^-1 times the forces on their way, newest first
  Mat3 nominal_inertia_kg_ = Mat3::Identity();
  Vec3 disturbance_n_ = Vec3::Zero();
};

}  // namespace telekerf::control
