// SPDX-License-Identifier: Apache-2.0
// telekerf-inspect robot: kinematics and workspace of a robot file; metres in base, one JSON object out.
#include <cstdio>
#include <nlohmann/json.hpp>
#include <vector>

#include "common/robot/hall_calibration.h"
#include "common/robot/robot_model.h"
#include "common/runtime/results.h"
#include "common/runtime/startup_error.h"
#include "tools/inspect/commands.h"
#include "tools/inspect/robot_picture.h"

namespace telekerf::inspect {
namespace {

using Json = nlohmann::ordered_json;
using robot::Mat3;

struct RobotOptions {
  std::string robot;
  std::vector<double> ik, fk, jacobian;
  bool workspace = false;
  bool hall = false;
  std::string picture;
};

Vec3 vector_of(const std::vector<double>& values) { return {values.at(0), values.at(1), values.at(2)}; }

Json json_of(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

/// Row-major: tool velocity = jacobian * joint velocity.
Json json_of(const Mat3& m) {
  Json rows = Json::array();
  for (int i = 0; i < 3; ++i) rows.push_back({m(i, 0), m(i, 1), m(i, 2)});
  return rows;
}

template <typename T>
T value_or_refuse(const tl::expected<T, robot::KinematicsError>& result, const std::string& robot) {
  if (!result) throw input_error(robot + ": " + robot::describe(result.error()));
  return *result;
}

/// A configuration and its conditioning.
Json pose(const robot::RobotModel& model, const robot::DeltaKinematics& kinematics, const Vec3& joints,
          const Vec3& tool) {
  const robot::Conditioning conditioning = kinematics.conditioning(joints, tool);
  return {{"robot", model.name},
          {"joints_m", json_of(joints)},
          {"tool_m", json_of(tool)},
          {"condition", conditioning.condition},
          {"serial_margin", conditioning.serial_margin},
          {"parallel_margin", conditioning.parallel_margin},
          {"working_mode", kinematics.working_mode_at(joints, tool)}};
}

Json workspace(const robot::RobotModel& model, const robot::DeltaKinematics& kinematics) {
  const robot::Workspace& w = model.workspace;
  const Vec3 centre_joints = value_or_refuse(kinematics.inverse(w.centre_m), model.name);
  return {{"robot", model.name},
          {"centre_m", json_of(w.centre_m)},
          {"radius_m", w.radius_m},
          {"height_m", w.height_m},
          {"condition", kinematics.conditioning(centre_joints, w.centre_m).condition},
          {"worst_condition", robot::worst_condition(kinematics, w)}};
}

/// Error of the Hall positions over the stroke, without and with calibration; one joint, sensors drawn from
/// seed 1.
Json hall(const robot::RobotModel& model) {
  const robot::HallAccuracy before =
      robot::hall_accuracy(model.sensor, model.geometry.stroke_max_m - model.geometry.stroke_min_m, 1, false);
  const robot::HallAccuracy after =
      robot::hall_accuracy(model.sensor, model.geometry.stroke_max_m - model.geometry.stroke_min_m, 1, true);
  return {{"robot", model.name},
          {"pitch_m", model.sensor.pitch_m},
          {"before", {{"rms_m", before.rms_m}, {"worst_m", before.worst_m}}},
          {"after", {{"rms_m", after.rms_m}, {"worst_m", after.worst_m}}}};
}

int run_robot(const RobotOptions& options) {
  if (!options.ik.empty() + !options.fk.empty() + !options.jacobian.empty() + options.workspace +
          options.hall !=
      1)
    throw usage_error("say what to show, one of --ik, --fk, --jacobian, --workspace, --hall");
  if (!options.picture.empty() && !options.workspace) throw usage_error("--picture needs --workspace");
  const robot::RobotModel model = robot::load_robot(options.robot, options.workspace);
  const robot::DeltaKinematics kinematics(model.geometry);
  Json out;
  if (!options.ik.empty()) {
    const Vec3 tool = vector_of(options.ik);
    out = pose(model, kinematics, value_or_refuse(kinematics.inverse(tool), model.name), tool);
  } else if (!options.fk.empty() || !options.jacobian.empty()) {
    const Vec3 joints = vector_of(options.fk.empty() ? options.jacobian : options.fk);
    const Vec3 tool = value_or_refuse(kinematics.forward(joints), model.name);
    out = pose(model, kinematics, joints, tool);
    if (!options.jacobian.empty()) {
      out["jacobian"] = json_of(value_or_refuse(kinematics.jacobian(joints, tool), model.name));
    }
  } else if (options.hall) {
    out = hall(model);
  } else {
    out = workspace(model, kinematics);
    if (!options.picture.empty()) {
      draw_workspace(model, options.picture);
      out["picture"] = options.picture;
    }
  }
  std::printf("%s\n", json_text(out).c_str());
  return 0;
}

void add_robot_parameters(RobotOptions& o, Settings& s) {
  const Bounds metres{.min = -10, .max = 10, .unit = "m"};
  s.add("robot", o.robot, kRobot, "a shipped name or the path of a robot file").as_argument();
  s.add("ik", o.ik, 3, metres, "joints of tool position X Y Z");
  s.add("fk", o.fk, 3, metres, "tool position of joints D1 D2 D3");
  s.add("jacobian", o.jacobian, 3, metres, "tool velocity per joint velocity at joints D1 D2 D3");
  s.add("workspace", o.workspace, "largest upright cylinder, conditioning");
  s.add("hall", o.hall, "position error of the Hall sensors before and after calibration");
  s.add("picture", o.picture, kFile, "draws the workspace into this PNG");
}

}  // namespace

void add_robot_command(Program& program) {
  program.add("robot", "Kinematics and workspace of a robot (metres, base frame)", RobotOptions{},
              add_robot_parameters, run_robot);
}

}  // namespace telekerf::inspect
