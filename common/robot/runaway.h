// SPDX-License-Identifier: Apache-2.0
// Does the robot do what its motors are told? Where it runs away, nothing that a controller computes is worth
// giving to it any more.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "common/robot/robot.h"
#include "common/robot/robot_model.h"

namespace telekerf::robot {

/// May the world push the tool harder than its motors can?
enum class Pushed : std::uint8_t { kNo, kYes };

/// What a controller finds that cannot be (control::JointPlausibility).
struct Doubt {
  enum class Kind : std::uint8_t {
    kNone,
    kReading,  ///< `value`, m: the reading is so far off where the currents have moved the joint
    kForce,    ///< `value`, m/s^2: the joint seems to be pushed by so much
  };
  Kind kind = Kind::kNone;
  int joint = 0;
  double value = 0.0;
  explicit operator bool() const noexcept { return kind != Kind::kNone; }
};

/// Reads what goes by in every control step: written(), then read(), and at() where the tool is known. Trips
/// for good. Only the sentence allocates.
///
/// Two signs are judged of every robot. A force that acts against its sign: the accelerations go against the
/// changes of the currents, as no hand makes them go, however strong it is, because the loop answers its slow
/// push. A loop that is later than it was designed for: the currents swing from one side to the other faster
/// than a hand can. A robot that is pushed is judged within its workspace: outside a strong hand moves it
/// where its motors are of little use. Of a robot that nobody pushes, so is the place: beyond a stroke, far
/// outside of the workspace, faster than it is ever asked to be.
class RunawayWatch {
 public:
  enum class Cause : std::uint8_t {
    kNone,
    kSign,
    kSwing,
    kStroke,
    kSpeed,
    kWorkspace,
    kReading,
    kForce,
    kNotFinite,
  };

  RunawayWatch(const RobotModel& model, double period_s, Pushed pushed);

  void written(const Vec3& currents_a) noexcept;
  /// A reading that is new; `steps`: since the one before, 1 if none is missing. One that is not finite is
  /// no place of any robot, so it trips.
  void read(const JointReading& reading, std::uint64_t steps) noexcept;
  /// Measured tool, workpiece frame, of a step with a reading.
  void at(const Vec3& tool_m) noexcept;
  /// What the controller finds, every step.
  void doubted(const Doubt& doubt) noexcept;

  bool tripped() const noexcept { return cause_ != Cause::kNone; }
  Cause cause() const noexcept { return cause_; }
  /// What happened and what may be wrong.
  std::string sentence() const;

 private:
  void trip(Cause cause, int joint, double value) noexcept;
  void judge_place(const JointReading& reading) noexcept;
  void judge_sign(const Vec3& acceleration_m_per_s2) noexcept;
  void judge_swing() noexcept;

  double stroke_min_m_, stroke_max_m_;
  double radius_m_, half_height_m_;
  double peak_a_;
  double step_m_per_s2_;  ///< acceleration of a joint by a motor's peak force
  Vec3 max_speed_m_per_s_;
  double period_s_;
  bool pushed_;

  /// Places and currents of the last steps without a gap.
  static constexpr std::size_t kSpan = 5;
  std::array<Vec3, kSpan + 1> joints_m_{};
  std::array<Vec3, kSpan> currents_a_{};
  std::size_t written_ = 0;
  std::size_t readings_ = 0;  ///< since the last gap

  /// Fading moments of a joint's mean current, in peaks, and of its acceleration.
  struct Moments {
    double x = 0.0, y = 0.0, xx = 0.0, yy = 0.0, xy = 0.0;
  };
  std::array<Moments, 3> moments_{};
  std::array<int, 3> against_{};  ///< steps in a row
  struct Swings {
    int side = 0;  ///< of the last current that was a large one
    double count = 0.0;
  };
  std::array<std::array<Swings, 3>, 2> swings_{};
  std::array<bool, 3> within_stroke_{};  ///< each joint has been
  bool within_workspace_ = false;        ///< the tool has been
  bool within_now_ = false;
  Cause cause_ = Cause::kNone;
  int joint_ = 0;
  double value_ = 0.0;
};

}  // namespace telekerf::robot
