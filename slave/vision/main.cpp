// SPDX-License-Identifier: Apache-2.0
// telekerf-vision: the picture over the workpiece -> the contour, latched for everyone in the cell.
#include <fmt/format.h>

#include <chrono>
#include <thread>

#include "common/bus/bus_flags.h"
#include "common/bus/endpoints.h"
#include "common/geometry/polyline.h"
#include "common/robot/robot_model.h"
#include "common/runtime/loop.h"
#include "slave/vision/contour_source.h"

namespace telekerf::vision {
namespace {

struct Flags {
  BusFlags bus;
  std::string image = "heart";
  std::string mode = "auto";
  double width_mm = 0.0;
  std::string robot = "slave-keops";
};

void say(const ContourMessage& contour) {
  const geometry::Polyline line{contour.points_m, contour.closed};
  const Vec2 size = geometry::bounding_box(line.points_m).size() * 1e3;
  fmt::print("vision: {} ({}): {} points, {:.1f} mm long, {:.1f} x {:.1f} mm, {:.4f} mm a pixel\n",
             contour.source, contour.mode, contour.points_m.size(), geometry::length_m(line) * 1e3, size.x(),
             size.y(), contour.metres_per_pixel * 1e3);
  std::fflush(stdout);
}

int run(const Flags& flags) {
  ContourRequest request;
  request.image = flags.image;
  request.mode = flags.mode;
  if (flags.width_mm > 0.0) request.width_m = flags.width_mm * 1e-3;
  request.workspace_radius_m = robot::load_robot(flags.robot).workspace.radius_m;
  const ContourMessage contour = find_contour(request);
  say(contour);

  catch_stop_signals();
  Bus bus(flags.bus.bus_settings(Site::kSlave, "vision"));
  Writer<ContourMessage> writer(bus);
  writer.write(contour);
  while (!stop_requested()) std::this_thread::sleep_for(std::chrono::milliseconds(50));
  return 0;
}

}  // namespace
}  // namespace telekerf::vision

int main(int argc, char** argv) {
  CLI::App app("Finds the contour in a picture and publishes it", "telekerf-vision");
  telekerf::vision::Flags flags;
  telekerf::Settings settings;
  settings.add("image", flags.image, "picture: a shipped name or a file");
  settings.add("mode", flags.mode, "from pixels to points", {"auto", "outline", "stroke", "thesis"});
  settings.add("width_mm", flags.width_mm, {.min = 0, .max = 10000},
               "width of the whole picture; 0: the contour is fitted to 60 % of the workspace");
  settings.add("robot", flags.robot, "the slave's robot: a shipped name or a file");
  flags.bus.declare(settings);
  settings.attach(app);
  telekerf::Action action = [&] {
    settings.fill();
    return run(flags);
  };
  return telekerf::run_program(app, argc, argv, action);
}
