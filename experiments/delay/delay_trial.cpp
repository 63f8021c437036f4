// SPDX-License-Identifier: Apache-2.0
#include "experiments/delay/delay_trial.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/robot/drivers/simulated_robot.h"
#include "common/runtime/error_statistics.h"
#include "experiments/simulation/simulation.h"
#include "experiments/simulation/virtual_link.h"
#include "slave/station.h"

namespace telekerf::experiments {
namespace {

constexpr std::int64_t kTickNs = 1'000'000;
constexpr std::uint32_t kEpoch = 1;
constexpr double kSilence_s = 0.5;  // before another slave would be listened to

ErrorStatistics statistics_of(const std::vector<double>& errors) {
  ErrorStatistics spread;
  for (const double error : errors) {
    if (std::isfinite(error)) spread.add(error);
  }
  return spread;
}

/// Between two ticks: while a correction of the play-out goes by.
Vec3 at(const std::vector<Vec3>& by_tick, double tick) {
  const auto before = static_cast<std::size_t>(tick);
  const Vec3& after = by_tick[std::min(before + 1, by_tick.size() - 1)];
  return by_tick[before] + (tick - static_cast<double>(before)) * (after - by_tick[before]);
}

double median_of(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Bounded and not growing: in the last quarter never 10 mm, and its median no more than half a millimetre or
/// 1.5 x that of the quarter before. (Medians, because a blackout of the link costs its time and is no
/// growth.)
bool is_stable(const std::vector<double>& errors) {
  const auto quarter = [&](std::size_t n) {
    std::vector<double> values;
    for (std::size_t i = n * errors.size() / 4; i < (n + 1) * errors.size() / 4; ++i) {
      if (std::isfinite(errors[i])) values.push_back(errors[i]);
    }
    return values;
  };
  const std::vector<double> before = quarter(2);
  const std::vector<double> last = quarter(3);
  if (before.empty() || last.size() < 100) return false;
  const double median = median_of(last);
  return *std::max_element(last.begin(), last.end()) < 10e-3 &&
         (median < 0.5e-3 || median < 1.5 * median_of(before));
}

}  // namespace

HandRecord record_hand(const std::string& image, double duration_s, std::uint64_t seed) {
  simulation::SimulationSettings settings;
  settings.image = image;
  HandRecord record;
  record.contour = simulation::find_contour(settings);
  master::StationSettings station_settings;
  station_settings.seed = seed;
  master::Station station(station_settings);
  const auto task = station.prepare(record.contour);
  record.beta = station_settings.beta;
  const auto ticks = static_cast<std::size_t>(duration_s * 1e3);
  std::int64_t now_ns = 0;
  while (record.tool.size() < ticks) {
    const auto out = station.step(now_ns, task.get(), {}, {});
    now_ns += kTickNs;
    if (out.mode != master::MasterMode::kGuiding) continue;
    record.tool.push_back({out.tool_m, out.velocity_m_per_s, out.acceleration_m_per_s2});
  }
  RunRecord rows;
  station.report(rows);
  for (std::size_t i = rows.master.size() - ticks; i < rows.master.size(); ++i) {
    const auto& at = rows.master[i].tool_m;
    record.true_tool_m.emplace_back(at[0], at[1], at[2]);
  }
  return record;
}

DelayResult run_trial(const HandRecord& hand, const DelayTrial& trial) {
  auto stream_settings = trial.master.validated().node.command;
  if (trial.wrong_start) {
    stream_settings.wrong_position_m = Vec3(0.01, 0.0, 0.0);
    stream_settings.wrong_velocity_m_per_s = Vec3(0.05, 0.0, 0.0);
  }
  master::CommandStream stream(stream_settings, kEpoch);
  streaming::StateReceiver feedback(kSilence_s, kEpoch, stream_settings.ticks_per_sample);
  slave::StationSettings slave_settings = trial.slave;
  slave_settings.seed = trial.seed;
  slave_settings.record_s = 1.0;
  slave_settings.node.touched = trial.push_n != 0.0;
  slave::Station slave(slave_settings);
  const auto corridor = slave.prepare(hand.contour);

  simulation::VirtualLink<CommandBlock> forward(trial.network.forward, trial.seed,
                                                netem::Direction::kForward);
  simulation::VirtualLink<StateBlock> backward(trial.network.backward, trial.seed,
                                               netem::Direction::kBackward);
  std::vector<Received<CommandBlock>> commands;
  std::vector<Received<StateBlock>> states;
  std::vector<Vec3> predicted(hand.tool.size());
  std::vector<bool> aligned(hand.tool.size());
  DelayResult result;
  result.error_m.assign(hand.tool.size(), std::numeric_limits<double>::quiet_NaN());
  result.prediction_error_m = result.error_m;
  bool heard = false;
  std::uint32_t engage = 0;
  bool joined = false;  // the first approach has ended, on both sides
  std::uint64_t payload_bytes = 0;
  std::uint64_t on_wire = 0;
  for (std::size_t tick = 0; tick < hand.tool.size(); ++tick) {
    const auto now_ns = static_cast<std::int64_t>(tick) * kTickNs;
    states.clear();
    backward.deliver(now_ns, states);
    for (const auto& state : states) stream.received(feedback.receive(state));
    heard = heard || !states.empty();
    // An operator who engages anew whenever the slave asks for it.
    if (heard) engage = std::max(engage, feedback.header().engage + 1);
    const auto block = stream.step(now_ns, tick,
                                   {.tool = hand.tool[tick],
                                    .beta = hand.beta,
                                    .contour_id = hand.contour.id,
                                    .engaged = heard,
                                    .engage = engage,
                                    .echo_sequence = feedback.heard() ? feedback.header().sequence : 0,
                                    .echo_sent_ns = feedback.heard() ? feedback.header().sent_ns : 0});
    predicted[tick] = stream.observed().slave.position_m;
    aligned[tick] = stream.observed().aligned;
    if (block) {
      payload_bytes += block->payload.size;
      on_wire += forward.push(now_ns, *block);
    }

    commands.clear();
    forward.deliver(now_ns, commands);
    if (tick == hand.tool.size() / 2) slave.machine().plant()->set_tool_force(Vec3(trial.push_n, 0.0, 0.0));
    const Vec3 tool_m = *slave.machine().true_tool_m();
    const auto out = slave.step(now_ns, corridor.get(), commands, {});
    if (out.state) backward.push(now_ns, *out.state);
    if (out.applied_tick < 0.0) continue;
    const auto applied = static_cast<std::size_t>(out.applied_tick);
    joined = joined || (aligned[applied] && out.settled);
    if (!joined) continue;
    result.error_m[applied] = (tool_m - hand.beta * at(hand.true_tool_m, out.applied_tick)).norm();
    result.prediction_error_m[applied] = (tool_m - at(predicted, out.applied_tick)).norm();
  }

  const auto is_counted = [](double error) { return std::isfinite(error); };
  const auto first = std::find_if(result.error_m.begin(), result.error_m.end(), is_counted);
  const auto last = std::find_if(result.error_m.rbegin(), result.error_m.rend(), is_counted).base();
  const std::vector<double> error(first, std::max(first, last));
  const ErrorStatistics tracking = statistics_of(result.error_m);
  const ErrorStatistics predictions = statistics_of(result.prediction_error_m);
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  result.counted = tracking.count;
  result.tracking_rmse_um = tracking.count == 0 ? kNone : tracking.rms() * 1e6;
  result.tracking_max_um = tracking.count == 0 ? kNone : tracking.max * 1e6;
  result.prediction_rmse_um = predictions.count == 0 ? kNone : predictions.rms() * 1e6;
  result.prediction_max_um = predictions.count == 0 ? kNone : predictions.max * 1e6;
  if (error.empty()) result.settle_s = kNone;
  for (std::size_t i = 0; i < error.size(); ++i) {
    if (error[i] > 1e-3) result.settle_s = static_cast<double>(i + 1) * 1e-3;
  }
  result.stable = is_stable(error);
  const double seconds = static_cast<double>(hand.tool.size()) * 1e-3;
  result.payload_bytes_per_s = static_cast<double>(payload_bytes) / seconds;
  result.wire_bytes_per_s = static_cast<double>(on_wire) / seconds;
  result.total_ms = stream.observed().delay_s * 1e3;
  return result;
}

}  // namespace telekerf::experiments
