// SPDX-License-Identifier: Apache-2.0
// telekerf-robot: a simulated robot in a process of its own, for `drive = udp:127.0.0.1:PORT`.
#include <fmt/format.h>

#include <cstdint>
#include <cstdio>
#include <string>

#include "common/robot/drivers/simulated_robot.h"
#include "common/robot/drivers/udp_robot.h"
#include "common/runtime/loop.h"
#include "common/runtime/program.h"
#include "common/runtime/startup_error.h"

namespace telekerf::robot {
namespace {

struct Flags {
  std::string robot = "slave-keops";
  double mismatch = 0.1;
  std::uint64_t seed = 1;
  int port = 7000;
  std::string key;
};

int run(const Flags& flags) {
  const RobotModel model = load_robot(flags.robot);
  SimulatedRobot plant(mismatched(model, flags.mismatch, flags.seed), flags.seed,
                       model.in_base(Vec3::Zero()));
  UdpDrive drive(plant, static_cast<std::uint16_t>(flags.port), flags.key);
  catch_stop_signals();
  fmt::print("robot: {} is simulated at udp:127.0.0.1:{}\n", model.name, drive.port());
  std::fflush(stdout);
  std::uint64_t steps = 0;
  while (!stop_requested() && !plant.broken()) steps += drive.serve_for(0.1);
  fmt::print("robot: {} steps, {} datagrams refused\n", steps, drive.refused());
  if (plant.broken())
    throw hardware_error("the robot left the poses that it can take; is its controller stable?");
  return 0;
}

void add_parameters(Flags& flags, Settings& settings) {
  settings.add("robot", flags.robot, kRobot, "robot: a shipped name or a file");
  settings.add("mismatch", flags.mismatch, {.min = 0, .max = 0.5}, "how far it is off its file, as a share");
  settings.add("seed", flags.seed, kSeeds, "of what is random in it");
  settings.add("port", flags.port, {.min = 0, .max = 65535}, "UDP port on this host, 0: any free one");
  settings.add("key", flags.key, kFile, "seals its datagrams; without: none");
}

}  // namespace
}  // namespace telekerf::robot

int main(int argc, char** argv) {
  using namespace telekerf::robot;
  return telekerf::run_program(
      argc, argv, "telekerf-robot",
      "A simulated robot in a process of its own: --drive udp:127.0.0.1:PORT moves it", Flags{},
      add_parameters, run);
}
