// SPDX-License-Identifier: Apache-2.0
#include "master/station.h"

#include <fmt/format.h>

#include <cmath>

#include "common/runtime/refusal.h"

namespace telekerf::master {
namespace {

Triple triple(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

}  // namespace

StationSettings StationSettings::validated() const {
  StationSettings settings = *this;
  const double ratio = node.control_hz / node.stream_hz;
  if (ratio < 1.0 || std::abs(ratio - std::round(ratio)) > 1e-9) {
    throw Refusal(fmt::format("control_hz = {:g} must be a whole multiple of stream_hz = {:g}", node.control_hz,
                              node.stream_hz));
  }
  settings.node.command.sample_period_ns = static_cast<std::uint32_t>(std::llround(1e9 / node.stream_hz));
  settings.node.command = settings.node.command.validated();
  return settings;
}

Station::Station(const StationSettings& settings)
    : settings_(settings.validated()),
      model_(robot::load_robot(settings_.robot)),
      robot_(robot::mismatched(model_, settings_.mismatch, settings_.seed), settings_.seed,
             model_.in_base(Vec3::Zero())),
      node_(model_, settings_.node, settings_.epoch),
      recorder_(static_cast<std::size_t>(settings_.record_s * settings_.node.control_hz)) {}

std::unique_ptr<Task> Station::prepare(const ContourMessage& contour) const {
  Guide guide = make_guide(contour, settings_.beta, settings_.node.constraint);
  double reach_m = 0.0;
  for (const auto& point : guide.curve.line().points_m) reach_m = std::max(reach_m, point.norm());
  if (reach_m > model_.workspace.radius_m) {
    throw Refusal(fmt::format(
        "the contour reaches {:.1f} mm from the centre of the master's workspace at beta = {:g}, but {} reaches {:.1f} mm; "
        "use a larger --beta or a smaller --width-mm",
        reach_m * 1e3, settings_.beta, model_.name, model_.workspace.radius_m * 1e3));
  }
  SimulatedHand hand(guide.curve.line(), settings_.hand, settings_.seed);
  return std::make_unique<Task>(Task{std::move(guide), std::move(hand)});
}

MasterOutputs Station::step(std::int64_t now_ns, Task* task, bool engage, std::span<const Received<StateBlock>> states,
                            std::span<const EventMessage> events) noexcept {
  const Tick tick = node_.tick();
  const double now_s = static_cast<double>(tick) * control_period_s();
  const Vec3 tool_m = model_.in_workpiece(robot_.true_tool_in_base_m());

  MasterInputs inputs;
  inputs.joints = robot_.read();
  inputs.states = states;
  inputs.events = events;
  inputs.engage = engage;
  HandSample hand;
  if (task != nullptr) {
    inputs.guide = &task->guide;
    hand = task->hand.sample(now_s, tool_m, robot_.true_tool_velocity_m_per_s(), guided_);
    inputs.button = hand.button;
  }
  const MasterOutputs out = node_.step(now_ns, inputs);
  guided_ = out.mode == MasterMode::kGuiding || out.mode == MasterMode::kEngaged;
  robot_.write(out.currents_a);
  robot_.set_tool_force(hand.force_n);
  recorder_.push({tick, static_cast<double>(now_ns) * 1e-9, triple(tool_m), triple(hand.force_n), out.constraint_n,
                  guided_, out.mode == MasterMode::kEngaged, inputs.button});
  robot_.advance(control_period_s());
  return out;
}

void Station::report(RunRecord& record) const {
  record.master = recorder_.rows();
  const LinkMeter& link = node_.link();
  const auto& command = settings_.node.command;
  const double run_s = static_cast<double>(node_.tick()) * control_period_s();
  const auto packets = static_cast<double>(link.packets());
  Figures& f = record.master_figures;
  f["beta"] = settings_.beta;
  f["seed"] = static_cast<double>(settings_.seed);
  f["rate_hz"] = settings_.node.control_hz;
  f["rtt_p50_ms"] = link.rtt_quantile_ms(0.50);
  f["rtt_p95_ms"] = link.rtt_quantile_ms(0.95);
  f["rtt_p99_ms"] = link.rtt_quantile_ms(0.99);
  f["lost"] = static_cast<double>(link.lost());
  f["block"] = command.block;
  f["keep"] = command.keep;
  f["block_ms"] = (command.block - 1) * 1e-6 * command.sample_period_ns;
  f["packets_per_s"] = run_s > 0.0 ? packets / run_s : 0.0;
  f["payload_bytes_per_s"] = run_s > 0.0 ? static_cast<double>(link.payload_bytes()) / run_s : 0.0;
  // All coded bytes, redundant copies and block heads included, over the axis samples they newly carry.
  f["bits_per_sample"] =
      packets > 0.0 ? 8.0 * static_cast<double>(link.payload_bytes()) / (packets * 3.0 * command.block) : 0.0;
  f["dropped_rows"] = static_cast<double>(recorder_.dropped());
  record.words["law"] = "local";
  record.words["estimator"] = "none";
  record.words["codec"] = codec::to_string(command.kind);
}

}  // namespace telekerf::master
