// SPDX-License-Identifier: Apache-2.0
#include "experiments/codec/codec_recordings.h"

#include <algorithm>
#include <cmath>

#include "common/codec/decoder.h"
#include "experiments/simulation/simulation.h"
#include "experiments/simulation/virtual_link.h"

namespace telekerf::experiments {
namespace {

constexpr std::int64_t kTickNs = 1'000'000;

codec::Trace empty(const char* name) { return {name, {"x", "y", "z"}, {{}, {}, {}}, 1000.0}; }

void append(codec::Trace& trace, const Vec3& sample) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    trace.values[axis].push_back(sample[static_cast<Eigen::Index>(axis)]);
  }
}

}  // namespace

double noise_of(const codec::Trace& trace) {
  double squares = 0;
  std::size_t count = 0;
  for (const auto& x : trace.values) {
    for (std::size_t n = 3; n < x.size(); ++n) {
      squares += std::pow(x[n] - 3 * x[n - 1] + 3 * x[n - 2] - x[n - 3], 2) / 20.0;
      ++count;
    }
  }
  return std::max(std::sqrt(squares / static_cast<double>(std::max<std::size_t>(count, 1))), 1e-9);
}

std::vector<SeededTrace> recorded_traces(double seconds, std::uint64_t seed) {
  simulation::SimulationSettings settings;
  settings.master.seed = settings.slave.seed = seed;
  settings.master.codec = *codec::kCodecs.find("raw");  // whole samples in every packet: what was commanded
  settings.network = netem::load_profile("thesis-constant");
  const ContourMessage contour = simulation::find_contour(settings);
  master::Station master(settings.master);
  slave::Station slave(settings.slave);
  const auto task = master.prepare(contour);
  const auto corridor = slave.prepare(contour);
  simulation::VirtualLink<CommandBlock> forward(settings.network.forward, seed, netem::Direction::kForward);
  simulation::VirtualLink<StateBlock> backward(settings.network.backward, seed, netem::Direction::kBackward);
  std::vector<Received<CommandBlock>> commands;
  std::vector<Received<StateBlock>> states;
  codec::BlockDecoder decoder;

  codec::Trace command = empty("demo-command");
  codec::Trace hand = empty("demo-hand");
  codec::Trace tool = empty("demo-tool");
  codec::Trace force = empty("demo-force");
  codec::Trace push = empty("demo-push");
  const auto wanted = static_cast<std::size_t>(seconds * 1e3);
  for (std::int64_t now_ns = 0; command.size() < wanted; now_ns += kTickNs) {
    states.clear();
    backward.deliver(now_ns, states);
    const auto out = master.step(now_ns, task.get(), states, {});
    const bool joined = out.mode == master::MasterMode::kEngaged && out.observed.aligned;
    if (out.command) {
      const auto packet = decoder.decode(out.command->payload.view(), {});
      if (joined && packet) append(command, (*packet)->blocks_newest_first[0].samples[0]);
      forward.push(now_ns, *out.command);
    }
    commands.clear();
    forward.deliver(now_ns, commands);
    const auto at_slave = slave.step(now_ns, corridor.get(), commands, {});
    if (at_slave.state) backward.push(now_ns, *at_slave.state);
    if (!joined) continue;
    append(hand, out.tool_m);
    append(push, out.hand_n);
    append(tool, at_slave.tool_m);
    append(force, at_slave.force_n);
  }
  std::vector<SeededTrace> all;
  const auto add = [&](codec::Trace& trace, const char* unit, bool is_position) {
    const double fine = noise_of(trace);
    all.push_back({std::move(trace), unit, fine, is_position});
  };
  add(command, "m/s2", false);
  add(hand, "m", true);
  add(tool, "m", true);
  add(force, "N", false);
  add(push, "N", false);
  return all;
}

}  // namespace telekerf::experiments
