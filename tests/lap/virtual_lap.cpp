// SPDX-License-Identifier: Apache-2.0
#include "tests/lap/virtual_lap.h"

#include <cmath>
#include <unordered_map>
#include <vector>

#include "common/robot/robot_model.h"
#include "netem/emulator.h"

namespace telekerf::lap {
namespace {

/// What a block costs beside its payload: RTPS, UDP, IP and Ethernet (89) and the block's own head.
constexpr std::uint32_t kBesidePayload = 89 + 76;

/// The virtual-time driver of the emulator for one kind of message.
template <class T>
class VirtualLink {
 public:
  VirtualLink(const netem::DirectionProfile& profile, std::uint64_t seed, netem::Direction direction)
      : emulator_(profile, netem::StreamKey{seed, 0, direction}) {}

  void push(std::int64_t now_ns, const T& message, std::uint32_t bytes) {
    const std::uint64_t tag = next_++;
    waiting_.emplace(tag, message);
    if (emulator_.push(now_ns, bytes, tag).lost()) waiting_.erase(tag);
  }
  void deliver(std::int64_t now_ns, std::vector<Received<T>>& out) {
    while (const auto delivery = emulator_.pop(now_ns)) {
      const auto found = waiting_.find(delivery->tag);
      // Damaged datagrams fail their checksum at the receiver.
      if (found != waiting_.end() && !delivery->corrupted) out.push_back({found->second, delivery->due_ns});
    }
    // Copies of a message share its tag, so it is kept until nothing older than it can still arrive.
    if (!emulator_.next_deadline()) waiting_.clear();
  }

 private:
  netem::Emulator emulator_;
  std::unordered_map<std::uint64_t, T> waiting_;
  std::uint64_t next_ = 0;
};

}  // namespace

ContourMessage find_contour(const LapSettings& settings) {
  vision::ContourRequest request;
  request.image = settings.image;
  if (settings.width_mm > 0.0) request.width_m = settings.width_mm * 1e-3;
  request.workspace_radius_m = robot::load_robot(settings.slave.robot).workspace.radius_m;
  return vision::find_contour(request);
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
      if (out.command) forward.push(master_ns, *out.command, out.command->payload.size + kBesidePayload);
      master_ns += master_period_ns;
    } else {
      commands.clear();
      forward.deliver(slave_ns, commands);
      const auto out = slave.step(slave_ns, corridor.get(), commands, {});
      if (out.state) backward.push(slave_ns, *out.state, out.state->payload.size + kBesidePayload);
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
