// SPDX-License-Identifier: Apache-2.0
// telekerf-inspect drive: moves a robot gently and measures how old its readings are (`drive_delay_s`).
#include <fmt/format.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "common/control/drive_delay.h"
#include "common/reporting/tables.h"
#include "common/robot/supervisor.h"
#include "common/runtime/loop.h"
#include "common/runtime/results.h"
#include "common/runtime/startup_error.h"
#include "tools/inspect/commands.h"

namespace telekerf::inspect {
namespace {

using control::DriveTrial;
using Json = nlohmann::ordered_json;

struct DriveOptions {
  std::string robot = "slave-keops";
  robot::RobotSupervisorSettings machine;
  robot::Simulation simulation;
  double control_hz = 1000.0;
  double force_n = 0.0;
  double travel_mm = 4.0;
  double duration_s = 4.0;
  bool move = false;
  bool json = false;
  std::string out;
};

void require_force(const DriveOptions& o, const robot::RobotModel& model) {
  if (o.force_n <= model.motor.peak_force_n) return;
  throw usage_error(fmt::format("--force-n {:g} is more than peak_force_n = {:g} of {}; take less", o.force_n,
                                model.motor.peak_force_n, model.name));
}

/// Nothing moves that nobody has said may move.
void require_leave(const DriveOptions& o, double force_n, const robot::Robot& robot) {
  if (!robot.capabilities().simulated && !o.move) {
    throw usage_error(
        fmt::format("drive = {}: the measurement shakes every joint for {:g} s with up to {:g} N and lets "
                    "none go farther "
                    "than {:g} mm; clear the robot's surroundings, lock the laser, and say --move",
                    o.machine.drive, o.duration_s, force_n, o.travel_mm));
  }
}

/// Nothing is driven against the end of a rail.
void require_stroke(const DriveOptions& o, const robot::RobotModel& model, const Vec3& joints_m) {
  const double travel_m = 1e-3 * o.travel_mm;
  for (int i = 0; i < 3; ++i) {
    if (joints_m[i] - travel_m > model.geometry.stroke_min_m &&
        joints_m[i] + travel_m < model.geometry.stroke_max_m)
      continue;
    throw hardware_error(
        fmt::format("drive = {}: joint {} stands at {:.2f} mm, nearer than travel_mm = {:g} to an end of its "
                    "stroke ({:g} to {:g} "
                    "mm); move the tool towards the middle of its workspace",
                    o.machine.drive, i + 1, 1e3 * joints_m[i], o.travel_mm, 1e3 * model.geometry.stroke_min_m,
                    1e3 * model.geometry.stroke_max_m));
  }
}

/// Runs the trial: a plant of this process as fast as it can be computed, anything else by the clock.
void run_trial(DriveTrial& trial, robot::RobotSupervisor& machine, double control_hz) {
  const auto step = [&](std::int64_t) {
    machine.write(trial.step(machine.read()));
    machine.advance();
    return trial.state() == DriveTrial::State::kRunning && !machine.failed() && !stop_requested();
  };
  catch_stop_signals();
  if (machine.plant() != nullptr) {
    while (step(0)) {
    }
  } else {
    run_loop(control_hz, step);
  }
  machine.release();
}

void require_done(const DriveOptions& o, const DriveTrial& trial, const robot::RobotSupervisor& machine) {
  if (machine.failed()) throw hardware_error(machine.failure());
  if (trial.state() == DriveTrial::State::kRunning)
    throw environment_error("stopped before the drive was measured; the currents are zero");
  if (trial.state() == DriveTrial::State::kDone) return;
  const std::string what = trial.state() == DriveTrial::State::kTooFar
                               ? fmt::format("a joint went {:.1f} mm, more than travel_mm = {:g}",
                                             1e3 * trial.farthest_m(), o.travel_mm)
                               : std::string("its readings are no pose of the robot's file");
  throw hardware_error(
      fmt::format("drive = {}: {}, so the currents are zero; are the signs of joints and currents and the "
                  "force constant right? "
                  "If they are, take a larger --travel-mm",
                  o.machine.drive, what));
}

/// As it stands in a robot file: hundredths of a millisecond are more than any loop feels.
std::string file_line(double delay_s) { return fmt::format("drive_delay_s = {:.5f}", delay_s); }

Json json_of(const DriveOptions& o, const robot::RobotModel& model, const DriveTrial& trial,
             const control::DriveDelay& delay) {
  Json joints = Json::array();
  for (const auto& joint : delay.joints) {
    joints.push_back(
        {{"delay_s", joint.delay_s}, {"acceleration_ratio", joint.gain}, {"explained", joint.explained}});
  }
  return {{"robot", model.name},
          {"drive", o.machine.drive},
          {"control_hz", o.control_hz},
          {"drive_delay_s", delay.delay_s},
          {"deviation_s", delay.deviation_s},
          {"spread_s", delay.spread_s},
          {"file_drive_delay_s", model.drive_delay_s},
          {"joints", joints},
          {"steps", delay.steps},
          {"readings_missed", delay.missed},
          {"force_n", trial.force_n()},
          {"travel_m", trial.farthest_m()},
          {"robot_file", file_line(delay.delay_s)}};
}

void print_table(const DriveOptions& o, const robot::RobotModel& model, const DriveTrial& trial,
                 const control::DriveDelay& delay) {
  const double period_s = 1.0 / o.control_hz;
  std::string table;
  const auto line = [&table](const std::string& what, const std::string& value) {
    table += reporting::table_row(what, value);
  };
  line("robot, drive", fmt::format("{}, {}, {:g} Hz", model.name, o.machine.drive, o.control_hz));
  line("moved",
       fmt::format("up to {:.2f} N a motor, {:.2f} mm a joint", trial.force_n(), 1e3 * trial.farthest_m()));
  line("delay",
       fmt::format("{:.3f} ms = {:.2f} control periods", 1e3 * delay.delay_s, delay.delay_s / period_s));
  line("deviation (joints, quarters)",
       fmt::format("{:.3f} ms, all within {:.3f} ms", 1e3 * delay.deviation_s, 1e3 * delay.spread_s));
  for (std::size_t i = 0; i < delay.joints.size(); ++i) {
    const auto& joint = delay.joints[i];
    line(fmt::format("joint {}", i + 1),
         fmt::format("{:.3f} ms; accelerates {:.2f} times as the file says; {:.1f} % explained",
                     1e3 * joint.delay_s, joint.gain, 100.0 * joint.explained));
  }
  line("steps used", fmt::format("{}; {:.1f} % of the readings missed", delay.steps, 100.0 * delay.missed));
  line("the file says", file_line(model.drive_delay_s));
  line("at the head of the robot file", file_line(delay.delay_s));
  if (delay.delay_s > control::kMaxLoopDelay * period_s) {
    line("too long at this rate",
         fmt::format("stations refuse more than {} control periods; lower their rate",
                     control::kMaxLoopDelay));
  }
  fmt::print("{}", table);
}

int run_drive(const DriveOptions& o) {
  if (!o.out.empty()) refuse_unwritable("--out", o.out);
  const robot::RobotModel model = robot::load_robot(o.robot);
  require_force(o, model);
  DriveTrial trial(model, {.control_hz = o.control_hz,
                           .force_n = o.force_n,
                           .travel_m = 1e-3 * o.travel_mm,
                           .duration_s = o.duration_s});
  robot::Drive drive = robot::open_drive(o.machine.drive, {model, o.control_hz, o.simulation});
  require_leave(o, trial.force_n(), *drive.robot);
  robot::RobotSupervisor machine(model, o.machine, o.control_hz, std::move(drive));
  require_stroke(o, model, machine.wait_until_ready().joints_m);
  run_trial(trial, machine, o.control_hz);
  require_done(o, trial, machine);
  const auto delay =
      control::estimate_drive_delay(trial.samples(), model.friction, 1.0 / o.control_hz, trial.highest_hz());
  if (!delay) {
    throw hardware_error(
        fmt::format("drive = {}: its delay cannot be told: {}; take more --force-n or --duration-s, or "
                    "a lower --control-hz if it is older than some periods, and check masses, signs and "
                    "force constant of {}",
                    o.machine.drive, delay.error(), model.name));
  }
  const Json json = json_of(o, model, trial, *delay);
  if (o.json) {
    fmt::print("{}\n", json_text(json));
  } else {
    print_table(o, model, trial, *delay);
  }
  if (!o.out.empty()) {
    make_folder("--out", o.out);
    write_json(std::filesystem::path(o.out) / "drive.json", json);
  }
  return 0;
}

void add_drive_parameters(DriveOptions& o, Settings& s) {
  s.add("robot", o.robot, kRobot, "robot: a shipped name or a file");
  o.machine.add_parameters(s);
  s.add("mismatch", o.simulation.mismatch, {.min = 0, .max = 0.5},
        "how far the simulated robot is off its file, as a share");
  s.add("seed", o.simulation.seed, kSeeds, "of the simulated robot");
  s.add("control_hz", o.control_hz, {.min = 200, .max = 20000, .unit = "Hz"},
        "control rate, as the station's");
  s.add("force_n", o.force_n, {.min = 0, .max = 1000, .unit = "N"},
        "largest force of a motor beside the robot's weight, 0: 40 % of the continuous one");
  s.add("travel_mm", o.travel_mm, {.min = 0.5, .max = 50, .unit = "mm"},
        "a joint that goes farther ends it, currents zero");
  s.add("duration_s", o.duration_s, {.min = 1, .max = 60, .unit = "s"},
        "of the shaking, after a second of holding");
  s.add("move", o.move, "a robot that is not simulated here may move");
  s.add("json", o.json, "one JSON object instead of a table");
  s.add("out", o.out, kFolder, "for drive.json");
}

}  // namespace

void add_drive_command(Program& program) {
  program.add("drive", "Moves a robot gently and measures how old its drive's readings are", DriveOptions{},
              add_drive_parameters, run_drive);
}

}  // namespace telekerf::inspect
