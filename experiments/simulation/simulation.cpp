// SPDX-License-Identifier: Apache-2.0
#include "experiments/simulation/simulation.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "common/robot/robot_model.h"
#include "common/runtime/startup_error.h"
#include "experiments/simulation/virtual_link.h"
#include "master/operator/replayed_hand.h"

namespace telekerf::simulation {
namespace {

/// What one station has not heard yet.
class Announcements {
 public:
  explicit Announcements(const std::vector<TimedEvent>& events) : events_(events) {}
  const std::vector<EventMessage>& due(std::int64_t now_ns) {
    due_.clear();
    while (next_ < events_.size() && events_[next_].at_s * 1e9 <= static_cast<double>(now_ns)) {
      due_.push_back(events_[next_++].event);
    }
    return due_;
  }

 private:
  const std::vector<TimedEvent>& events_;
  std::size_t next_ = 0;
  std::vector<EventMessage> due_;
};

StopOrder stop_at(const std::vector<TimedStop>& stops, std::int64_t now_ns) {
  StopOrder order;
  for (const TimedStop& stop : stops)
    if (stop.at_s * 1e9 <= static_cast<double>(now_ns)) order = stop.order;
  return order;
}

}  // namespace

ContourMessage find_contour(const SimulationSettings& settings) {
  vision_process::ContourRequest request;
  request.image = settings.image;
  if (settings.width_mm > 0.0) request.width_m = settings.width_mm * 1e-3;
  request.workspace_radius_m = robot::load_robot(settings.slave.robot).workspace.radius_m;
  request.hand_radius_m = settings.master.beta * robot::load_robot(settings.master.robot).workspace.radius_m;
  return vision_process::find_contour(request);
}

RunRecord simulate(const SimulationSettings& settings) { return simulate(settings, find_contour(settings)); }

RunRecord simulate(const SimulationSettings& settings, const ContourMessage& contour) {
  master::StationSettings master_settings = settings.master;
  slave::StationSettings slave_settings = settings.slave;
  master_settings.seed = slave_settings.seed = settings.seed;
  master::Station master(master_settings, {}, {},
                         settings.hand.empty() ? nullptr : std::make_unique<master::ReplayedHand>(settings.hand));
  slave::Station slave(slave_settings);
  std::vector<std::unique_ptr<master::GuidedContour>> guided;  // the station may still use an old one
  guided.push_back(master.prepare(contour));
  const auto corridor = slave.prepare(contour);

  VirtualLink<CommandBlock> forward(settings.network.forward, settings.seed, netem::Direction::kForward);
  VirtualLink<StateBlock> backward(settings.network.backward, settings.seed, netem::Direction::kBackward);
  std::vector<Received<CommandBlock>> commands;
  std::vector<Received<StateBlock>> states;
  Announcements at_master(settings.events);

  const auto end_ns = static_cast<std::int64_t>(settings.duration_s * 1e9);
  const auto slave_later_ns = static_cast<std::int64_t>(settings.slave_starts_s * 1e9);
  const auto master_period_ns = std::llround(master.control_period_s() * 1e9);
  const auto slave_period_ns = std::llround(slave.control_period_s() * 1e9);
  std::int64_t master_ns = std::max<std::int64_t>(0, -slave_later_ns);
  std::int64_t slave_ns = std::max<std::int64_t>(0, slave_later_ns);
  while (std::min(master_ns, slave_ns) < end_ns) {
    if (master_ns <= slave_ns) {
      states.clear();
      backward.deliver(master_ns, states);
      master::GuidedContour* const task =
          master.node().tick() < settings.contour_from_tick ? nullptr : guided.back().get();
      const auto out = master.step(master_ns, task, states, at_master.due(master_ns),
                                   stop_at(settings.stops, master_ns));
      if (out.command) forward.push(master_ns, *out.command);
      if (out.prepare_anew) {
        try {
          guided.push_back(master.prepare(contour));
        } catch (const StartupError&) {
          // Refused: what is in force stays.
        }
      }
      master_ns += master_period_ns;
    } else {
      commands.clear();
      forward.deliver(slave_ns, commands);
      const auto out = slave.step(slave_ns, corridor.get(), commands, stop_at(settings.stops, slave_ns));
      if (out.state) backward.push(slave_ns, *out.state);
      slave_ns += slave_period_ns;
    }
  }

  if (master.machine().failed()) throw hardware_error("master: " + master.machine().failure());
  if (slave.machine().failed()) throw hardware_error("slave: " + slave.machine().failure());

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

}  // namespace telekerf::simulation
