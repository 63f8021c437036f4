// SPDX-License-Identifier: Apache-2.0
#include "common/robot/delta_kinematics.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <cmath>
#include <limits>

namespace telekerf::robot {
namespace {

using Kind = KinematicsError::Kind;

// Below these margins (dimensionless, see Conditioning) a matrix counts as singular: a velocity map would
// then amplify rounding to more than a millionth of itself.
constexpr double kSingularMargin = 1e-9;
// Carriages whose projection on xy is a line decide no "above" (eq. 118: det A = 0). Relative to their
// distances.
constexpr double kCollinear = 1e-9;
// A measured joint may round over the end of its stroke.
constexpr double kStrokeSlack = 1e-9;

bool finite(const Vec3& v) noexcept { return std::isfinite(v.x() + v.y() + v.z()); }

tl::unexpected<KinematicsError> fail(Kind kind, int leg = -1, double value_m = 0,
                                     double bound_m = 0) noexcept {
  return tl::unexpected<KinematicsError>(KinematicsError{kind, leg, value_m, bound_m});
}

}  // namespace

Vec3 DeltaState::joint_acceleration(const Vec3& tool_acceleration) const noexcept {
  return inverse_jacobian * (tool_acceleration - jacobian_rate * joint_velocity_m_per_s);
}

Vec3 DeltaState::tool_acceleration(const Vec3& joint_acceleration) const noexcept {
  return jacobian * joint_acceleration + jacobian_rate * joint_velocity_m_per_s;
}

DeltaKinematics::DeltaKinematics(const DeltaGeometry& geometry) noexcept
    : geometry_(geometry), volume_scale_(1) {
  for (std::size_t i = 0; i < 3; ++i) {
    const double theta = geometry.rail_angle_rad[i];
    const double alpha = geometry.attack_angle_rad[i];
    const Vec3 outward(std::cos(theta), std::sin(theta), 0);
    rail_[i] = -std::cos(alpha) * outward + std::sin(alpha) * Vec3::UnitZ();
    origin_[i] = (geometry.base_radius_m - geometry.tool_radius_m) * outward;
    volume_scale_ *= geometry.rod_length_m[i];
  }
}

Vec3 DeltaKinematics::carriage(int leg, double joint_m) const noexcept {
  const auto i = static_cast<std::size_t>(leg);
  const double theta = geometry_.rail_angle_rad[i];
  return centre(i, joint_m) + geometry_.tool_radius_m * Vec3(std::cos(theta), std::sin(theta), 0);
}

// Eq. 111-131 with the origin moved to S_3, which keeps lambda_i (eq. 110) free of cancellation. Two
// differences of the sphere equations give a line (eq. 118), the third sphere two points on it (eq. 130). In
// vectors: 2 a.Y = |a|^2 + l_3^2 - l_1^2 and 2 b.Y = |b|^2 + l_3^2 - l_2^2, line direction n = a x b, then
// |Y| = l_3.
DeltaKinematics::Result<Vec3> DeltaKinematics::forward(const Vec3& joints_m) const noexcept {
  if (!finite(joints_m)) return fail(Kind::kNotFinite);
  for (int i = 0; i < 3; ++i) {
    if (joints_m[i] < geometry_.stroke_min_m - kStrokeSlack) {
      return fail(Kind::kOutOfStroke, i, joints_m[i], geometry_.stroke_min_m);
    }
    if (joints_m[i] > geometry_.stroke_max_m + kStrokeSlack) {
      return fail(Kind::kOutOfStroke, i, joints_m[i], geometry_.stroke_max_m);
    }
  }
  const auto& l = geometry_.rod_length_m;
  const Vec3 s3 = centre(2, joints_m[2]);
  const Vec3 a = centre(0, joints_m[0]) - s3;
  const Vec3 b = centre(1, joints_m[1]) - s3;
  const Vec3 n = a.cross(b);
  const double n2 = n.squaredNorm();
  const double aa = a.squaredNorm();
  const double bb = b.squaredNorm();
  if (std::abs(n.z()) <= kCollinear * std::sqrt(aa * bb)) return fail(Kind::kParallelSingular);

  const double ka = 0.5 * (aa + (l[2] - l[0]) * (l[2] + l[0]));
  const double kb = 0.5 * (bb + (l[2] - l[1]) * (l[2] + l[1]));
  const Vec3 foot = (ka * b.cross(n) + kb * n.cross(a)) / n2;  // nearest point of the line to S_3
  const double foot_m = foot.norm();
  const double height2 = (l[2] - foot_m) * (l[2] + foot_m);
  if (height2 < 0) {
    // All three rods miss by the same height; the one that is short by the largest share is named.
    const std::array<double, 3> reach{(foot - a).norm(), (foot - b).norm(), foot_m};
    int worst = 0;
    for (int i = 1; i < 3; ++i) {
      if (reach[i] / l[i] > reach[worst] / l[worst]) worst = i;
    }
    return fail(Kind::kUnreachable, worst, reach[worst] - l[worst]);
  }
  const double up = n.z() > 0 ? 1.0 : -1.0;
  const double side = geometry_.assembly_mode == AssemblyMode::kAbove ? up : -up;
  return s3 + foot + side * std::sqrt(height2 / n2) * n;
}

// Eq. 132-137: with w from the rail's origin to the tool, mu_1 = -2 w.u and mu_2 = |w|^2 - l^2. The
// discriminant is formed from the tool's distance to the rail's line, so that eq. 136's cancellation (mu_1^2
// >> mu_2) cannot happen.
DeltaKinematics::Result<Vec3> DeltaKinematics::inverse(const Vec3& tool_m) const noexcept {
  if (!finite(tool_m)) return fail(Kind::kNotFinite);
  Vec3 joints;
  for (std::size_t i = 0; i < 3; ++i) {
    const int leg = static_cast<int>(i);
    const double l = geometry_.rod_length_m[i];
    const Vec3 w = tool_m - origin_[i];
    const double along = w.dot(rail_[i]);
    const double across = (w - along * rail_[i]).norm();
    const double quarter_delta = (l - across) * (l + across);  // Delta_i / 4
    if (quarter_delta < 0) return fail(Kind::kUnreachable, leg, across - l);
    joints[leg] = along - geometry_.working_mode[i] * std::sqrt(quarter_delta);
    if (joints[leg] < geometry_.stroke_min_m - kStrokeSlack) {
      return fail(Kind::kOutOfStroke, leg, joints[leg], geometry_.stroke_min_m);
    }
    if (joints[leg] > geometry_.stroke_max_m + kStrokeSlack) {
      return fail(Kind::kOutOfStroke, leg, joints[leg], geometry_.stroke_max_m);
    }
  }
  // The joints belong to this tool position only on the assembly mode's side of the carriages.
  const Vec3 s3 = centre(2, joints[2]);
  const Vec3 n = (centre(0, joints[0]) - s3).cross(centre(1, joints[1]) - s3);
  const double height = (n.z() > 0 ? 1.0 : -1.0) * n.dot(tool_m - s3);
  const bool above = height >= 0;
  if (above != (geometry_.assembly_mode == AssemblyMode::kAbove)) return fail(Kind::kOtherAssembly);
  return joints;
}

DeltaKinematics::Rows DeltaKinematics::rows(const Vec3& joints_m, const Vec3& tool_m) const noexcept {
  Rows rows;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3 from_tool = centre(i, joints_m[static_cast<int>(i)]) - tool_m;  // eq. 139-141
    rows.j2.row(static_cast<int>(i)) = from_tool.transpose();
    rows.f_d[static_cast<int>(i)] = from_tool.dot(rail_[i]);  // eq. 142
  }
  return rows;
}

DeltaKinematics::Result<Mat3> DeltaKinematics::inverse_of_j2(const Rows& rows) const noexcept {
  // Not written as "<=": a NaN must fail.
  if (!(std::abs(rows.j2.determinant()) > kSingularMargin * volume_scale_))
    return fail(Kind::kParallelSingular);
  return rows.j2.inverse();
}

DeltaKinematics::Result<Mat3> DeltaKinematics::inverse_jacobian_of(const Rows& rows) const noexcept {
  for (int i = 0; i < 3; ++i) {
    if (!(std::abs(rows.f_d[i]) > kSingularMargin * geometry_.rod_length_m[static_cast<std::size_t>(i)])) {
      return fail(Kind::kSerialSingular, i);
    }
  }
  return Mat3(rows.f_d.cwiseInverse().asDiagonal() * rows.j2);
}

// With S_i' = u_i d_i': f_xi' .. f_zi' are the row (S_i' - tool')^T, and f_di' = (S_i' - tool') . u_i.
Mat3 DeltaKinematics::jacobian_rate_of(const Mat3& j2_inverse, const Mat3& jacobian, const Vec3& qd,
                                       const Vec3& xd) const noexcept {
  Mat3 j2_rate;
  Vec3 f_d_rate;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3 rate = qd[static_cast<int>(i)] * rail_[i] - xd;
    j2_rate.row(static_cast<int>(i)) = rate.transpose();
    f_d_rate[static_cast<int>(i)] = rate.dot(rail_[i]);
  }
  const Mat3 j1_rate = f_d_rate.asDiagonal();
  return j2_inverse * (j1_rate - j2_rate * jacobian);
}

DeltaKinematics::Result<Mat3> DeltaKinematics::jacobian(const Vec3& joints_m,
                                                        const Vec3& tool_m) const noexcept {
  const Rows at = rows(joints_m, tool_m);
  const auto j2_inverse = inverse_of_j2(at);
  if (!j2_inverse) return tl::unexpected<KinematicsError>(j2_inverse.error());
  return Mat3(*j2_inverse * at.f_d.asDiagonal());
}

DeltaKinematics::Result<Mat3> DeltaKinematics::inverse_jacobian(const Vec3& joints_m,
                                                                const Vec3& tool_m) const noexcept {
  return inverse_jacobian_of(rows(joints_m, tool_m));
}

DeltaKinematics::Result<Mat3> DeltaKinematics::jacobian_rate(
    const Vec3& joints_m, const Vec3& tool_m, const Vec3& joint_velocity_m_per_s,
    const Vec3& tool_velocity_m_per_s) const noexcept {
  const Rows at = rows(joints_m, tool_m);
  const auto j2_inverse = inverse_of_j2(at);
  if (!j2_inverse) return tl::unexpected<KinematicsError>(j2_inverse.error());
  const Mat3 jacobian = *j2_inverse * at.f_d.asDiagonal();
  return jacobian_rate_of(*j2_inverse, jacobian, joint_velocity_m_per_s, tool_velocity_m_per_s);
}

DeltaKinematics::Result<DeltaState> DeltaKinematics::state(
    const Vec3& joints_m, const Vec3& joint_velocity_m_per_s) const noexcept {
  const auto tool = forward(joints_m);
  if (!tool) return tl::unexpected<KinematicsError>(tool.error());
  const Rows at = rows(joints_m, *tool);
  const auto j2_inverse = inverse_of_j2(at);
  if (!j2_inverse) return tl::unexpected<KinematicsError>(j2_inverse.error());
  const auto inverse_jacobian = inverse_jacobian_of(at);
  if (!inverse_jacobian) return tl::unexpected<KinematicsError>(inverse_jacobian.error());

  DeltaState state;
  state.joints_m = joints_m;
  state.joint_velocity_m_per_s = joint_velocity_m_per_s;
  state.tool_m = *tool;
  state.jacobian = *j2_inverse * at.f_d.asDiagonal();
  state.inverse_jacobian = *inverse_jacobian;
  state.tool_velocity_m_per_s = state.jacobian * joint_velocity_m_per_s;
  state.jacobian_rate =
      jacobian_rate_of(*j2_inverse, state.jacobian, joint_velocity_m_per_s, state.tool_velocity_m_per_s);
  return state;
}

Conditioning DeltaKinematics::conditioning(const Vec3& joints_m, const Vec3& tool_m) const noexcept {
  const Rows at = rows(joints_m, tool_m);
  Conditioning result;
  result.serial_margin = 1;
  for (int i = 0; i < 3; ++i) {
    const double margin = std::abs(at.f_d[i]) / geometry_.rod_length_m[static_cast<std::size_t>(i)];
    if (margin < result.serial_margin) {
      result.serial_margin = margin;
      result.serial_leg = i;
    }
  }
  result.parallel_margin = std::abs(at.j2.determinant()) / volume_scale_;
  result.condition = std::numeric_limits<double>::infinity();
  if (result.distance() <= kSingularMargin) return result;
  // Singular values of J_x^-1 = J_1^-1 J_2 have the same ratio; its Gram matrix has their squares.
  const Mat3 inverse = at.f_d.cwiseInverse().asDiagonal() * at.j2;
  Eigen::SelfAdjointEigenSolver<Mat3> gram;
  gram.computeDirect(inverse * inverse.transpose(), Eigen::EigenvaluesOnly);
  const double smallest = gram.eigenvalues()[0];
  if (smallest > 0) result.condition = std::sqrt(gram.eigenvalues()[2] / smallest);
  return result;
}

std::array<int, 3> DeltaKinematics::working_mode_at(const Vec3& joints_m, const Vec3& tool_m) const noexcept {
  const Vec3 f_d = rows(joints_m, tool_m).f_d;
  return {f_d[0] < 0 ? 1 : -1, f_d[1] < 0 ? 1 : -1, f_d[2] < 0 ? 1 : -1};
}

}  // namespace telekerf::robot
