// SPDX-License-Identifier: Apache-2.0
#include "experiments/simulation/simulation.h"

#include <cmath>
#include <vector>

#include "common/robot/robot_model.h"
#include "experiments/simulation/virtual_link.h"

namespace telekerf::lap {
ContourMessage find_contour(const LapSettings& settings) {
  vision_process::ContourRequest request;
  request.image = settings.image;
  if (settings.width_mm > 0.0) request.width_m = settings.width_mm * 1e-3;
  request.workspace_radius_m = robot::load_robot(settings.slave.robot).workspace.radius_m;
  return vision_process::find_contour(request);
}

RunRecord run_lap(const LapSettings& settings) { return run_lap(settings, find_contour(settings)); }

RunRecord run_lap(const LapSettings& settings, const ContourMessage& contour) {
  master::StationSettings master_settings = settings.master;
  slave::StationSettings slave_settings = settings.slave;
  master_settings.seed = slave_settings.seed = settings.seed;
  master::Station master(master_settings);
  slave::Station slave(slave_settings);
  const auto task = master.prepare(contour);
  const auto corridor = slave.prepare(contour);

  VirtualLink<CommandBlock> forward(settings.network.forward, settings.seed, netem::Direction::kForward);
  VirtualLink<StateBlock> backward(settings.network.backward, settings.seed, netem::Direction::kBackward);
  std::vector<Received<CommandBlock>> commands;
  std::vector<Received<StateBlock>> states;

  const auto end_ns = static_cast<std::int64_t>(settings.duration_s * 1e9);
  const auto master_period_ns = std::llround(master.control_period_s() * 1e9);
  const auto slave_period_ns = std::llround(slave.control_period_s() * 1e9);
  std::int64_t master_ns = 0;
  std::int64_t slave_ns = 0;
  while (std::min(master_ns, slave_ns) < end_ns) {
    if (master_ns <= slave_ns) {
      states.clear();
      backward.deliver(master_ns, states);
      const auto out = master.step(master_ns, task.get(), true, states, {});
      if (out.command) forward.push(master_ns, *out.command, wire_bytes(*out.command));
      master_ns += master_period_ns;
    } else {
      commands.clear();
      forward.deliver(slave_ns, commands);
      const auto out = slave.step(slave_ns, corridor.get(), commands, {});
      if (out.state) backward.push(slave_ns, *out.state, wire_bytes(*out.state));
      slave_ns += slave_period_ns;
    }
  }

  RunRecord record;
  for (const auto& point : contour.points_m) record.contour_m.push_back({point.x(), point.y()});
  record.contour_closed = contour.closed;
  record.words["image"] = contour.source;
  record.words["mode"] = contour.mode;
  record.words["netem"] = settings.network.name;
  master.report(record);
  slave.report(record);
  return record;
}

}  // namespace telekerf::lap
