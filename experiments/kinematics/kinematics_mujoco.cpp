// SPDX-License-Identifier: Apache-2.0
#include "experiments/kinematics/kinematics_mujoco.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>

#include "common/runtime/startup_error.h"

namespace telekerf::experiments {
namespace {

constexpr double kRodHalfDistance_m = 0.02;  // between the two rods of a parallelogram

std::string words(const Vec3& v) { return fmt::format("{:.17g} {:.17g} {:.17g}", v.x(), v.y(), v.z()); }

/// MJCF text. Slides stand at 0 for joints 0; a tendon's rest length is its length in this pose, so the pose
/// of the file is one where each rod has its length exactly: straight out from its carriage, the tool being
/// moved later.
std::string mjcf(const robot::RobotModel& robot, const Vec3& joints_m, const Vec3& tool_m,
                 double timestep_s) {
  const auto& g = robot.geometry;
  // Time constant and impedance of the constraints: as stiff as the engine allows at this step.
  const std::string stiff =
      fmt::format("solref=\"{:.17g} 1\" solimp=\"0.9999 0.9999 0.001 0.5 2\"", 2 * timestep_s);
  std::string bodies, tool_sites, tendons, equalities;
  for (std::size_t i = 0; i < 3; ++i) {
    const double theta = g.rail_angle_rad[i], alpha = g.attack_angle_rad[i];
    const Vec3 outward(std::cos(theta), std::sin(theta), 0);
    const Vec3 sideways(-std::sin(theta), std::cos(theta), 0);
    const Vec3 rail = -std::cos(alpha) * outward + std::sin(alpha) * Vec3::UnitZ();
    const Vec3 at = g.base_radius_m * outward + joints_m[static_cast<int>(i)] * rail;
    bodies += fmt::format(
        "<body pos=\"{}\"><joint name=\"rail{}\" type=\"slide\" axis=\"{}\"/>"
        "<inertial pos=\"0 0 0\" mass=\"{:.17g}\" diaginertia=\"1e-4 1e-4 1e-4\"/>",
        words(at), i, words(rail), robot.motor.mass_kg);
    for (const int side : {-1, 1}) {
      const Vec3 offset = side * kRodHalfDistance_m * sideways;
      const std::string name = fmt::format("{}{}", i, side < 0 ? 'a' : 'b');
      bodies += fmt::format("<site name=\"carriage{}\" pos=\"{}\"/>", name, words(offset));
      tool_sites += fmt::format("<site name=\"tool{}\" pos=\"{}\"/>", name,
                                words(Vec3(g.tool_radius_m * outward + offset)));
      tendons +=
          fmt::format("<spatial name=\"rod{}\"><site site=\"carriage{}\"/><site site=\"tool{}\"/></spatial>",
                      name, name, name);
      equalities += fmt::format("<tendon tendon1=\"rod{}\" {}/>", name, stiff);
    }
    bodies += "</body>";
  }
  return fmt::format(
      "<mujoco><compiler angle=\"radian\"/>"
      "<option timestep=\"{:.17g}\" gravity=\"{}\" integrator=\"Euler\" solver=\"Newton\" iterations=\"100\" "
      "tolerance=\"1e-14\"><flag contact=\"disable\"/></option>"
      "<worldbody>{}<body name=\"tool\" pos=\"{}\"><freejoint name=\"free\"/>"
      "<inertial pos=\"0 0 0\" mass=\"{:.17g}\" diaginertia=\"1e-4 1e-4 1e-4\"/>{}</body></worldbody>"
      "<tendon>{}</tendon><equality>{}</equality></mujoco>",
      timestep_s, words(robot.gravity_m_per_s2), bodies, words(tool_m), std::max(robot.tool_mass_kg, 1e-6),
      tool_sites, tendons, equalities);
}

mjModel* compile(const std::string& xml) {
  // The model is handed over in memory.
  const auto files = std::make_unique<mjVFS>();
  mj_defaultVFS(files.get());
  mj_makeEmptyFileVFS(files.get(), "delta.xml", static_cast<int>(xml.size()));
  std::memcpy(files->filedata[0], xml.data(), xml.size());
  char error[500] = "";
  mjModel* model = mj_loadXML("delta.xml", files.get(), error, sizeof(error));
  mj_deleteVFS(files.get());
  if (model == nullptr) throw environment_error(fmt::format("MuJoCo refuses the model: {}", error));
  return model;
}

}  // namespace

struct MujocoDelta::Engine {
  mjModel* model = nullptr;
  mjData* data = nullptr;
  Vec3 start_joints_m = Vec3::Zero();
  std::array<double, 3> rod_length_m{};
  int tool_body = 0;
  int free_q = 0, free_v = 0;
  std::array<int, 3> slide_q{}, slide_v{};

  ~Engine() {
    mj_deleteData(data);
    mj_deleteModel(model);
  }
};

MujocoDelta::MujocoDelta(MujocoDelta&&) noexcept = default;
MujocoDelta::~MujocoDelta() = default;

MujocoDelta::MujocoDelta(const robot::RobotModel& robot, const Vec3& joints_m, const Vec3& tool_in_base_m,
                         double timestep_s)
    : engine_(std::make_unique<Engine>()) {
  engine_->model = compile(mjcf(robot, joints_m, tool_in_base_m, timestep_s));
  engine_->data = mj_makeData(engine_->model);
  engine_->start_joints_m = joints_m;
  engine_->rod_length_m = robot.geometry.rod_length_m;
  engine_->tool_body = mj_name2id(engine_->model, mjOBJ_BODY, "tool");
  const int free = mj_name2id(engine_->model, mjOBJ_JOINT, "free");
  engine_->free_q = engine_->model->jnt_qposadr[free];
  engine_->free_v = engine_->model->jnt_dofadr[free];
  for (std::size_t i = 0; i < 3; ++i) {
    const int rail = mj_name2id(engine_->model, mjOBJ_JOINT, fmt::format("rail{}", i).c_str());
    engine_->slide_q[i] = engine_->model->jnt_qposadr[rail];
    engine_->slide_v[i] = engine_->model->jnt_dofadr[rail];
  }
  // The constraint is length = rest length; the rest length is the rod's, not the one of the start pose.
  for (int t = 0; t < engine_->model->ntendon; ++t) {
    engine_->model->tendon_length0[t] = engine_->rod_length_m[static_cast<std::size_t>(t / 2)];
  }
  forward();
}

void MujocoDelta::set_motor_force(const Vec3& force_n) {
  for (std::size_t i = 0; i < 3; ++i)
    engine_->data->qfrc_applied[engine_->slide_v[i]] = force_n[static_cast<int>(i)];
}

void MujocoDelta::set_tool_force(const Vec3& force_in_base_n) {
  for (int i = 0; i < 3; ++i) engine_->data->xfrc_applied[6 * engine_->tool_body + i] = force_in_base_n[i];
}

void MujocoDelta::step() { mj_step(engine_->model, engine_->data); }

void MujocoDelta::forward() { mj_forward(engine_->model, engine_->data); }

void MujocoDelta::place(const Vec3& joints_m, const Vec3& tool_in_base_m) {
  for (std::size_t i = 0; i < 3; ++i) {
    const int k = static_cast<int>(i);
    engine_->data->qpos[engine_->slide_q[i]] = joints_m[k] - engine_->start_joints_m[k];
    engine_->data->qpos[engine_->free_q + k] = tool_in_base_m[k];
  }
  mju_zero(engine_->data->qvel, engine_->model->nv);
}

double MujocoDelta::time_s() const { return engine_->data->time; }

Vec3 MujocoDelta::joints_m() const {
  Vec3 joints;
  for (std::size_t i = 0; i < 3; ++i) joints[static_cast<int>(i)] = engine_->data->qpos[engine_->slide_q[i]];
  return joints + engine_->start_joints_m;
}

Vec3 MujocoDelta::joint_velocity_m_per_s() const {
  Vec3 velocity;
  for (std::size_t i = 0; i < 3; ++i)
    velocity[static_cast<int>(i)] = engine_->data->qvel[engine_->slide_v[i]];
  return velocity;
}

Vec3 MujocoDelta::tool_m() const { return Vec3(engine_->data->qpos + engine_->free_q); }

Vec3 MujocoDelta::tool_velocity_m_per_s() const { return Vec3(engine_->data->qvel + engine_->free_v); }

Vec3 MujocoDelta::rod_error_m() const {
  // Of the present pose: the engine's tendon lengths belong to the start of the last step.
  mj_kinematics(engine_->model, engine_->data);
  mj_tendon(engine_->model, engine_->data);
  Vec3 error;
  for (std::size_t i = 0; i < 3; ++i) {
    const double pair_m = 0.5 * (engine_->data->ten_length[2 * i] + engine_->data->ten_length[2 * i + 1]);
    error[static_cast<int>(i)] = pair_m - engine_->rod_length_m[i];
  }
  return error;
}

double MujocoDelta::tilt_rad() const {
  const double* q = engine_->data->qpos + engine_->free_q + 3;
  return 2 * std::atan2(std::sqrt(q[1] * q[1] + q[2] * q[2] + q[3] * q[3]), std::abs(q[0]));
}

}  // namespace telekerf::experiments
