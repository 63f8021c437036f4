// SPDX-License-Identifier: Apache-2.0
#include "common/robot/delta_kinematics.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
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

void cross(const double* a, const double* b, double* out) noexcept {
  out[0] = a[1] * b[2] - a[2] * b[1];
  out[1] = a[2] * b[0] - a[0] * b[2];
  out[2] = a[0] * b[1] - a[1] * b[0];
}

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
  double a[3], b[3], s3[3];
  double aa = 0, bb = 0;
  for (int axis = 0; axis < 3; ++axis) {
    s3[axis] = origin_[2][axis] + joints_m[2] * rail_[2][axis];
    a[axis] = origin_[0][axis] + joints_m[0] * rail_[0][axis] - s3[axis];
    b[axis] = origin_[1][axis] + joints_m[1] * rail_[1][axis] - s3[axis];
    aa += a[axis] * a[axis];
    bb += b[axis] * b[axis];
  }
  double n[3];
  cross(a, b, n);
  if (n[2] * n[2] <= kCollinear * kCollinear * aa * bb) return fail(Kind::kParallelSingular);

  const double ka = 0.5 * (aa + (l[2] - l[0]) * (l[2] + l[0]));
  const double kb = 0.5 * (bb + (l[2] - l[1]) * (l[2] + l[1]));
  const double per_n2 = 1 / (n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
  const double mixed[3] = {per_n2 * (ka * b[0] - kb * a[0]), per_n2 * (ka * b[1] - kb * a[1]),
                           per_n2 * (ka * b[2] - kb * a[2])};
  double foot[3];  // nearest point of the line to S_3
  cross(mixed, n, foot);
  const double height2 = l[2] * l[2] - (foot[0] * foot[0] + foot[1] * foot[1] + foot[2] * foot[2]);
  if (height2 < 0) {
    // All three rods miss by the same height; the one that is short by the largest share is named.
    const Vec3 at(foot);
    const std::array<double, 3> reach{(at - Vec3(a)).norm(), (at - Vec3(b)).norm(), at.norm()};
    std::size_t worst = 0;
    for (std::size_t i = 1; i < 3; ++i) {
      if (reach[i] / l[i] > reach[worst] / l[worst]) worst = i;
    }
    return fail(Kind::kUnreachable, static_cast<int>(worst), reach[worst] - l[worst]);
  }
  const bool along_n = (n[2] > 0) == (geometry_.assembly_mode == AssemblyMode::kAbove);
  const double up = (along_n ? 1.0 : -1.0) * std::sqrt(height2 * per_n2);
  return Vec3(s3[0] + foot[0] + up * n[0], s3[1] + foot[1] + up * n[1], s3[2] + foot[2] + up * n[2]);
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
    const double across2 = (w - along * rail_[i]).squaredNorm();
    const double quarter_delta = l * l - across2;  // Delta_i / 4
    if (quarter_delta < 0) return fail(Kind::kUnreachable, leg, std::sqrt(across2) - l);
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

// From here on plain loops over three: Eigen's packets of two do not fit three, and cost twice the time.
struct DeltaKinematics::Maps {
  double j2_inverse[3][3];  // [axis][leg]
  double jacobian[3][3];    // [axis][leg]

  void jacobian_into(Mat3& out) const noexcept {
    for (int axis = 0; axis < 3; ++axis) {
      for (int leg = 0; leg < 3; ++leg) out(axis, leg) = jacobian[axis][leg];
    }
  }
};

DeltaKinematics::Rows DeltaKinematics::rows(const Vec3& joints_m, const Vec3& tool_m) const noexcept {
  Rows rows;
  for (std::size_t i = 0; i < 3; ++i) {
    const double d = joints_m[static_cast<int>(i)];
    rows.f_d[i] = 0;
    for (int axis = 0; axis < 3; ++axis) {
      rows.j2[i][axis] = origin_[i][axis] + d * rail_[i][axis] - tool_m[axis];  // eq. 139-141
      rows.f_d[i] += rows.j2[i][axis] * rail_[i][axis];                         // eq. 142
    }
  }
  return rows;
}

bool DeltaKinematics::invert(const Rows& rows, Maps& maps) const noexcept {
  const auto& a = rows.j2;
  double cofactor[3][3];  // [leg][axis]: the cross product of the other two rows
  for (int i = 0; i < 3; ++i) {
    const double* b = a[(i + 1) % 3];
    const double* c = a[(i + 2) % 3];
    cross(b, c, cofactor[i]);
  }
  const double determinant = a[0][0] * cofactor[0][0] + a[0][1] * cofactor[0][1] + a[0][2] * cofactor[0][2];
  // Not written as "<=": a NaN must fail.
  if (!(std::abs(determinant) > kSingularMargin * volume_scale_)) return false;
  const double scale = 1 / determinant;
  for (int axis = 0; axis < 3; ++axis) {
    for (int leg = 0; leg < 3; ++leg) {
      maps.j2_inverse[axis][leg] = scale * cofactor[leg][axis];
      maps.jacobian[axis][leg] = maps.j2_inverse[axis][leg] * rows.f_d[leg];  // eq. 146
    }
  }
  return true;
}

int DeltaKinematics::leg_square_to_its_rail(const Rows& rows) const noexcept {
  for (std::size_t i = 0; i < 3; ++i) {
    if (!(std::abs(rows.f_d[i]) > kSingularMargin * geometry_.rod_length_m[i])) return static_cast<int>(i);
  }
  return -1;
}

// With S_i' = u_i d_i': f_xi' .. f_zi' are the row (S_i' - tool')^T, and f_di' = (S_i' - tool') . u_i.
void DeltaKinematics::rate_into(Mat3& out, const Maps& maps, const Vec3& qd, const Vec3& xd) const noexcept {
  double inner[3][3];  // J_1dot - J_2dot J_x, [leg][leg]
  for (std::size_t i = 0; i < 3; ++i) {
    double rate[3];
    double f_d_rate = 0;
    for (int axis = 0; axis < 3; ++axis) {
      rate[axis] = qd[static_cast<int>(i)] * rail_[i][axis] - xd[axis];
      f_d_rate += rate[axis] * rail_[i][axis];
    }
    for (std::size_t k = 0; k < 3; ++k) {
      inner[i][k] =
          (i == k ? f_d_rate : 0.0) -
          (rate[0] * maps.jacobian[0][k] + rate[1] * maps.jacobian[1][k] + rate[2] * maps.jacobian[2][k]);
    }
  }
  for (int axis = 0; axis < 3; ++axis) {
    for (int k = 0; k < 3; ++k) {
      out(axis, k) = maps.j2_inverse[axis][0] * inner[0][k] + maps.j2_inverse[axis][1] * inner[1][k] +
                     maps.j2_inverse[axis][2] * inner[2][k];
    }
  }
}

DeltaKinematics::Result<Mat3> DeltaKinematics::jacobian(const Vec3& joints_m,
                                                        const Vec3& tool_m) const noexcept {
  Result<Mat3> result;
  Maps maps;
  if (invert(rows(joints_m, tool_m), maps)) {
    maps.jacobian_into(*result);
  } else {
    result = fail(Kind::kParallelSingular);
  }
  return result;
}

DeltaKinematics::Result<Mat3> DeltaKinematics::inverse_jacobian(const Vec3& joints_m,
                                                                const Vec3& tool_m) const noexcept {
  const Rows at = rows(joints_m, tool_m);
  const int square = leg_square_to_its_rail(at);
  if (square >= 0) return fail(Kind::kSerialSingular, square);
  Mat3 inverse;
  for (int leg = 0; leg < 3; ++leg) {
    for (int axis = 0; axis < 3; ++axis) inverse(leg, axis) = at.j2[leg][axis] / at.f_d[leg];
  }
  return inverse;
}

DeltaKinematics::Result<Mat3> DeltaKinematics::jacobian_rate(
    const Vec3& joints_m, const Vec3& tool_m, const Vec3& joint_velocity_m_per_s,
    const Vec3& tool_velocity_m_per_s) const noexcept {
  Result<Mat3> result;
  Maps maps;
  if (invert(rows(joints_m, tool_m), maps)) {
    rate_into(*result, maps, joint_velocity_m_per_s, tool_velocity_m_per_s);
  } else {
    result = fail(Kind::kParallelSingular);
  }
  return result;
}

DeltaKinematics::Result<DeltaState> DeltaKinematics::state(
    const Vec3& joints_m, const Vec3& joint_velocity_m_per_s) const noexcept {
  Result<DeltaState> result;  // filled in place: it is large
  DeltaState& state = *result;
  const auto tool = forward(joints_m);
  if (!tool) {
    result = tl::unexpected<KinematicsError>(tool.error());
    return result;
  }
  const Rows at = rows(joints_m, *tool);
  Maps maps;
  if (!invert(at, maps)) {
    result = fail(Kind::kParallelSingular);
    return result;
  }
  const int square = leg_square_to_its_rail(at);
  if (square >= 0) {
    result = fail(Kind::kSerialSingular, square);
    return result;
  }
  state.joints_m = joints_m;
  state.joint_velocity_m_per_s = joint_velocity_m_per_s;
  state.tool_m = *tool;
  maps.jacobian_into(state.jacobian);
  for (int leg = 0; leg < 3; ++leg) {
    for (int axis = 0; axis < 3; ++axis) state.inverse_jacobian(leg, axis) = at.j2[leg][axis] / at.f_d[leg];
  }
  for (int axis = 0; axis < 3; ++axis) {
    state.tool_velocity_m_per_s[axis] = maps.jacobian[axis][0] * joint_velocity_m_per_s[0] +
                                        maps.jacobian[axis][1] * joint_velocity_m_per_s[1] +
                                        maps.jacobian[axis][2] * joint_velocity_m_per_s[2];
  }
  rate_into(state.jacobian_rate, maps, joint_velocity_m_per_s, state.tool_velocity_m_per_s);
  return result;
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
  const Eigen::Map<const Mat3> transposed(&at.j2[0][0]);
  result.parallel_margin = std::abs(transposed.determinant()) / volume_scale_;
  result.condition = std::numeric_limits<double>::infinity();
  if (result.distance() <= kSingularMargin) return result;
  // Singular values of J_x^-1 = J_1^-1 J_2 have the same ratio; its Gram matrix has their squares.
  const Mat3 inverse = Vec3(at.f_d).cwiseInverse().asDiagonal() * transposed.transpose();
  Eigen::SelfAdjointEigenSolver<Mat3> gram;
  gram.computeDirect(inverse * inverse.transpose(), Eigen::EigenvaluesOnly);
  const double smallest = gram.eigenvalues()[0];
  if (smallest > 0) result.condition = std::sqrt(gram.eigenvalues()[2] / smallest);
  return result;
}

std::array<int, 3> DeltaKinematics::working_mode_at(const Vec3& joints_m, const Vec3& tool_m) const noexcept {
  const Rows at = rows(joints_m, tool_m);
  const auto& f_d = at.f_d;
  return {f_d[0] < 0 ? 1 : -1, f_d[1] < 0 ? 1 : -1, f_d[2] < 0 ? 1 : -1};
}

}  // namespace telekerf::robot
