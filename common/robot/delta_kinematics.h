// SPDX-License-Identifier: Apache-2.0
// Closed-form kinematics of any prismatic delta: attack angle, rail angle and rod length per leg (thesis ch.
// 6).
//
// Frames: base, origin in the middle of the rails, z along the tool's side. Leg i in base (eq. 97-104):
//   carriage P_ci = Rz(theta_i) [r_b - d_i c(alpha_i), 0, d_i s(alpha_i)]  (positive d: inward and up),
//   tool joint P_ei = tool + Rz(theta_i) [r_e, 0, 0], and |P_ei - P_ci| = l_i.
// Moving r_e to the carriage makes one sphere a leg: |tool - S_i(d_i)| = l_i, S_i = P_ci - Rz(theta_i) [r_e,
// 0, 0]. Everything here is noexcept, free of allocation, and fixed in the number of operations.
#pragma once

#include <Eigen/Core>
#include <array>
#include <tl/expected.hpp>

#include "common/robot/kinematics_error.h"
#include "common/runtime/vectors.h"

namespace telekerf::robot {

using Mat3 = Eigen::Matrix3d;

/// The tool stands above (eq. 131) or below (as in most printers) the plane of the carriages.
enum class AssemblyMode : std::uint8_t { kAbove, kBelow };

struct DeltaGeometry {
  double base_radius_m = 0.12;
  double tool_radius_m = 0.03;
  std::array<double, 3> rod_length_m{0.15, 0.15, 0.15};
  std::array<double, 3> rail_angle_rad{};    ///< theta_i, about z
  std::array<double, 3> attack_angle_rad{};  ///< alpha_i: 0 horizontal, pi/2 vertical
  AssemblyMode assembly_mode = AssemblyMode::kAbove;
  /// +1: eq. 137's root (f_di < 0); -1: the other one (f_di > 0).
  std::array<int, 3> working_mode{1, 1, 1};
  double stroke_min_m = -1.0;
  double stroke_max_m = 1.0;
};

/// How far a pose is from where the machine loses a direction. Both margins lie in [0, 1]; 0 is singular.
struct Conditioning {
  double condition = 0.0;        ///< ratio of the largest to the smallest singular value of the Jacobian
  double serial_margin = 0.0;    ///< smallest |cos| between a rod and its rail, |f_di| / l_i (eq. 142)
  double parallel_margin = 0.0;  ///< volume that the three unit rods span, |det J_2| / (l_1 l_2 l_3)
  int serial_leg = 0;            ///< leg of the serial margin
  double distance() const noexcept {
    return serial_margin < parallel_margin ? serial_margin : parallel_margin;
  }
};

/// Everything that a controller needs about one configuration, computed once a tick.
struct DeltaState {
  Vec3 joints_m = Vec3::Zero();
  Vec3 joint_velocity_m_per_s = Vec3::Zero();
  Vec3 tool_m = Vec3::Zero();  ///< in base
  Vec3 tool_velocity_m_per_s = Vec3::Zero();
  Mat3 jacobian = Mat3::Identity();  ///< tool velocity = jacobian * joint velocity (eq. 27)
  Mat3 inverse_jacobian = Mat3::Identity();
  Mat3 jacobian_rate = Mat3::Zero();  ///< 1/s
  /// J^-1 (xdd - Jdot qd), from eq. 28.
  Vec3 joint_acceleration(const Vec3& tool_acceleration) const noexcept;
  /// J qdd + Jdot qd, eq. 28.
  Vec3 tool_acceleration(const Vec3& joint_acceleration) const noexcept;
};

class DeltaKinematics {
 public:
  template <typename T>
  using Result = tl::expected<T, KinematicsError>;

  explicit DeltaKinematics(const DeltaGeometry& geometry) noexcept;

  const DeltaGeometry& geometry() const noexcept { return geometry_; }

  /// Tool position in base from joint positions (eq. 106-131), on the assembly mode's side.
  [[nodiscard]] Result<Vec3> forward(const Vec3& joints_m) const noexcept;
  /// Joint positions from the tool position in base (eq. 132-137), on the working mode's roots.
  [[nodiscard]] Result<Vec3> inverse(const Vec3& tool_m) const noexcept;

  /// J_x of eq. 146: tool velocity = J_x * joint velocity. `joints_m` and `tool_m` must belong together.
  [[nodiscard]] Result<Mat3> jacobian(const Vec3& joints_m, const Vec3& tool_m) const noexcept;
  /// J_1^-1 J_2: joint velocity = result * tool velocity. Also J_x^-T: joint force = J_x^T * tool force.
  [[nodiscard]] Result<Mat3> inverse_jacobian(const Vec3& joints_m, const Vec3& tool_m) const noexcept;
  /// Time derivative of J_x: J_2^-1 (J_1dot - J_2dot J_x); the velocities must belong together, too.
  [[nodiscard]] Result<Mat3> jacobian_rate(const Vec3& joints_m, const Vec3& tool_m,
                                           const Vec3& joint_velocity_m_per_s,
                                           const Vec3& tool_velocity_m_per_s) const noexcept;
  /// Forward kinematics and all maps of one configuration.
  [[nodiscard]] Result<DeltaState> state(const Vec3& joints_m,
                                         const Vec3& joint_velocity_m_per_s) const noexcept;

  [[nodiscard]] Conditioning conditioning(const Vec3& joints_m, const Vec3& tool_m) const noexcept;

  /// +1 or -1 per leg: the working mode in which this configuration stands (sign of -f_di).
  std::array<int, 3> working_mode_at(const Vec3& joints_m, const Vec3& tool_m) const noexcept;
  /// Unit vector of rail i in base, the direction of positive d_i.
  const Vec3& rail(int leg) const noexcept { return rail_[static_cast<std::size_t>(leg)]; }
  /// P_ci of eq. 101 in base.
  Vec3 carriage(int leg, double joint_m) const noexcept;

 private:
  struct Rows {  // eq. 139-145, index [leg][axis]: row i of J_2, and the diagonal of J_1
    double j2[3][3];
    double f_d[3];
  };
  struct Maps;  // inverse of J_2, and J_x
  Vec3 centre(std::size_t leg, double joint_m) const noexcept { return origin_[leg] + joint_m * rail_[leg]; }
  Rows rows(const Vec3& joints_m, const Vec3& tool_m) const noexcept;
  bool invert(const Rows& rows, Maps& maps) const noexcept;     // false: det J_2 = 0
  int leg_square_to_its_rail(const Rows& rows) const noexcept;  // -1: none
  void rate_into(Mat3& out, const Maps& maps, const Vec3& qd, const Vec3& xd) const noexcept;

  DeltaGeometry geometry_;
  std::array<Vec3, 3> rail_;    // dS_i/dd_i
  std::array<Vec3, 3> origin_;  // S_i at d_i = 0
  double volume_scale_;         // l_1 l_2 l_3
};

}  // namespace telekerf::robot
