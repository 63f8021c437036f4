// SPDX-License-Identifier: Apache-2.0
// telekerf-plant: the slave's robot and laser, simulated in a process of their own that judges what was
// burnt. A slave that hangs or is killed does not take them with it.
#include <fmt/format.h>

#include <cstdio>
#include <memory>
#include <string>

#include "common/bus/bus_flags.h"
#include "common/bus/contour_subscriber.h"
#include "common/bus/process.h"
#include "common/robot/drivers/simulated_robot.h"
#include "common/robot/drivers/udp_robot.h"
#include "common/runtime/clock.h"
#include "common/runtime/program.h"
#include "common/runtime/real_time.h"
#include "common/runtime/results.h"
#include "tools/plant/plant_laser.h"

namespace telekerf::plant {
namespace {

constexpr const char* kLit = "lit";
constexpr const char* kDark = "dark";

struct Flags {
  Flags() = default;  // no aggregate, see RobotSupervisorSettings
  BusFlags bus;
  std::string robot = "slave-keops";
  double mismatch = 0.1;
  std::uint64_t seed = 1;
  int drive_port = 0;
  PlantLaserSettings laser;
  std::string record;
};

int run(const Flags& flags) {
  if (!flags.record.empty()) make_folder("--record", flags.record);
  const robot::RobotModel model = robot::load_robot(flags.robot);
  const Vec3 origin_m = model.in_base(Vec3::Zero());
  robot::SimulatedRobot robot(robot::mismatched(model, flags.mismatch, flags.seed), flags.seed, origin_m);
  robot::UdpDrive drive(robot, static_cast<std::uint16_t>(flags.drive_port), flags.laser.key);

  Process process(flags.bus.bus_settings(Site::kSlave, "plant"), "plant", kDark);
  using geometry::NearestIndex;
  ContourSubscriber<NearestIndex> contour(
      process.bus(),
      [](const ContourMessage& message) {
        return std::make_unique<NearestIndex>(geometry::Polyline{message.points_m, message.closed});
      },
      ContourSubscriber<NearestIndex>::Part::kLooksOn);
  PlantLaser laser(drive.context(), flags.laser, robot, origin_m, model.workspace.radius_m,
                   [&] { return contour.current(); });
  process.status().say(
      fmt::format("drive udp:127.0.0.1:{}, laser plant:127.0.0.1:{}", drive.port(), laser.port()));

  const RealTimePriority priority(kLoopPriority);  // granted or not
  std::uint64_t steps = 0;
  while (!stop_requested() && !robot.broken() && !process.ended()) {
    steps += drive.serve_for(0.02);
    laser.book_until(monotonic_ns());
    process.status().state(laser.lit() ? kLit : kDark);
    process.lookout().refused(Lookout::Device::kDrive, drive.refused());
    process.lookout().refused(Lookout::Device::kLaser, laser.ignored());
  }

  const LightBook& book = laser.book();
  if (!flags.record.empty()) {
    nlohmann::ordered_json report = book.report();
    report["robot_steps"] = steps;
    report["robot_broken"] = robot.broken();
    report["drive_refused"] = drive.refused();
    report["laser_obeyed"] = laser.obeyed();
    report["laser_ignored"] = laser.ignored();
    report["laser_stuck"] = laser.stuck();
    write_json(std::filesystem::path(flags.record) / "plant.json", report);
  }
  process.status().say(fmt::format(
      "{:.2f} J inside the corridor, {:.2f} J outside, at most {:.2f} J within 0.1 mm; dark at most {:.1f} "
      "ms "
      "after the last word",
      book.energy_j() - book.outside_j(), book.outside_j(), book.dose_j(), 1e3 * book.dark_after_s()));
  return book.outside_j() > 0.0 ? 1 : 0;
}

void add_parameters(Flags& flags, Settings& settings) {
  settings.add("robot", flags.robot, kRobot, "robot: a shipped name or a file");
  settings.add("mismatch", flags.mismatch, {.min = 0, .max = 0.5}, "how far it is off its file, as a share");
  settings.add("seed", flags.seed, kSeeds, "of what is random in it");
  settings.add("drive_port", flags.drive_port, {.min = 0, .max = 65535},
               "UDP port on this host, 0: any free one");
  settings.add("laser_port", flags.laser.port, {.min = 0, .max = 65535},
               "UDP port on this host, 0: any free one");
  settings.add("key", flags.laser.key, kFile, "seals the datagrams of drive and laser; without: none");
  settings.add("max_w", flags.laser.max_w, {.min = 0.1, .max = 1000, .unit = "W"},
               "largest power of the laser");
  settings.add("stuck_after_j", flags.laser.stuck_after_j, {.min = 0, .max = 10000, .unit = "J"},
               "for trials: after so much light its modulator sticks at max_w; 0: never");
  settings.add("record", flags.record, kFolder, "for plant.json, the book of the light");
  flags.bus.add_parameters(settings);
}

}  // namespace
}  // namespace telekerf::plant

int main(int argc, char** argv) {
  using namespace telekerf::plant;
  return telekerf::run_program(
      argc, argv, "telekerf-plant",
      "The slave's robot and laser, simulated in a process of their own that books the light by the clock",
      Flags{}, add_parameters, run);
}
