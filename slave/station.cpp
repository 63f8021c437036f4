// SPDX-License-Identifier: Apache-2.0
#include "slave/station.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/runtime/startup_error.h"
#include "slave/laser/dose_limits.h"

namespace telekerf::slave {
void StationSettings::add_parameters(Settings& settings) {
  settings.add("robot", robot, kRobot, "robot: a shipped name or a file");
  machine.add_parameters(settings);
  beam.add_parameters(settings);
  settings.add("mismatch", mismatch, {.min = 0, .max = 0.5},
               "how far the simulated robot is off its file, as a share");
  settings.add("seed", seed, kSeeds, "of the simulated robot");
  settings.add("control_hz", node.control_hz, {.min = 200, .max = 20000, .unit = "Hz"},
               "control rate, a multiple of stream_hz");
  settings.add("stream_hz", node.stream_hz, {.min = 100, .max = 10000, .unit = "Hz"},
               "samples a second in the state stream");
  add_node_parameters(settings);
}

void StationSettings::add_node_parameters(Settings& settings) {
  settings.add("codec", codec, codec::kCodecs, "of the state stream");
  settings.add("block", node.feedback.block, {.min = 4, .max = 64}, "samples a block of the state stream");
  settings.add("keep", node.feedback.keep, {.min = 1, .max = 64},
               "coefficients kept of a block's positions, an axis");
  settings.add("max_rms", node.feedback.max_rms, {.min = 0, .max = 1},
               "RMS error of a block's positions that is kept instead [m], 0: keep");
  settings.add("force_keep", node.force.keep, {.min = 1, .max = 64},
               "coefficients kept of a block's forces, an axis");
  settings.add("force_max_rms", node.force.max_rms, {.min = 0, .max = 1000},
               "RMS error of a block's forces that is kept instead [N], 0: force_keep");
  settings.add("redundancy", node.feedback.redundancy, {.min = 0, .max = 7},
               "previous blocks repeated in a packet");
  settings.add("bandwidth_rad_s", node.bandwidth_rad_s, {.min = 0, .max = 5000, .unit = "rad/s"},
               "of the tracking law, 0: chosen from robot, rate and drive");
  settings.add("observer_rad_s", node.observer_rad_s, {.min = 0, .max = 15000, .unit = "rad/s"},
               "of the disturbance observer, 0: chosen likewise");
  settings.add("stale_s", node.command_timeout_s, {.min = 0.02, .max = 10, .unit = "s"},
               "no command for this long: hold, laser off");
  settings.add("beam_age_s", node.interlock.beam_age_s, {.min = 0.02, .max = 2, .unit = "s"},
               "commands older than this, measured there and back, give no light");
  settings.add("touched", node.touched, "something may push the tool: an unknown force is no fault");
  settings.add("look_age_s", node.interlock.max_look_age_s, {.min = 0, .max = 3600, .unit = "s"},
               "no light after vision has not seen the contour where it is for this long; 0: not asked");
  settings.add("bare_accelerations", node.bare_accelerations, kBareAccelerations,
               "of law remote-acceleration, what the slave makes of them");
  settings.add("laser_w", node.laser_w, {.min = 0, .max = 1000, .unit = "W"},
               "laser power at laser_speed_mm_s; it follows the tool's speed up to 1.5 times");
  settings.add("laser_speed_mm_s", laser_speed_mm_s, {.min = 0.5, .max = 200, .unit = "mm/s"},
               "speed of the tool that gets laser_w");
  laser::add_dose_parameters(node.interlock, settings);
  codec::refuse_unread(settings, {"", "force_"});
}

StationSettings StationSettings::validated() const {
  StationSettings settings = *this;
  const double ratio = node.control_hz / node.stream_hz;
  if (ratio < 1.0 || std::abs(ratio - std::round(ratio)) > 1e-9) {
    throw configuration_error(fmt::format("control_hz = {:g} must be a whole multiple of stream_hz = {:g}",
                                          node.control_hz, node.stream_hz));
  }
  beam.validate(node.laser_w);
  settings.node.real_laser = !beam.simulated();
  settings.node.beam_power.speed_m_per_s = 1e-3 * laser_speed_mm_s;
  laser::require_dose(node.interlock, node.laser_w, laser_speed_mm_s, "laser_speed_mm_s");
  settings.node.feedback.sample_period_ns = static_cast<std::uint32_t>(std::llround(1e9 / node.stream_hz));
  settings.node.feedback = codec::with_codec(settings.node.feedback, codec).validated();
  codec::StreamSettings& force = settings.node.force;
  force.kind = settings.node.feedback.kind;
  force.block = settings.node.feedback.block;
  force.redundancy = settings.node.feedback.redundancy;
  force.sample_period_ns = settings.node.feedback.sample_period_ns;
  force = force.validated();
  return settings;
}

Station::Station(const StationSettings& settings, robot::Drive drive, std::unique_ptr<laser::Laser> laser)
    : settings_(settings.validated()),
      model_(robot::load_robot(settings_.robot)),
      machine_(model_, settings_.machine, settings_.node.control_hz,
               drive.robot ? std::move(drive)
                           : robot::open_drive(settings_.machine.drive,
                                               {model_,
                                                settings_.node.control_hz,
                                                // Another machine than the master's with the same seed.
                                                {settings_.mismatch, settings_.seed + 1000, {}}})),
      beam_(settings_.beam, settings_.node.laser_w, settings_.node.control_hz, std::move(laser)),
      node_(model_, settings_.node, settings_.epoch),
      monitor_(model_, settings_.node.interlock.max_height_m),
      recorder_(static_cast<std::size_t>(settings_.record_s * settings_.node.control_hz)) {
  control::require_stable(control::loop_conditions(model_, settings_.node.control_hz), node_.bandwidths(),
                          "bandwidth_rad_s", "observer_rad_s");
  const laser::InterlockSettings& guards = settings_.node.interlock;
  const double unknown_m = 0.5 * model_.limits.acceleration_m_per_s2 * guards.reaction_s * guards.reaction_s;
  if (unknown_m > guards.corridor_m - guards.measurement_m) {
    throw configuration_error(fmt::format(
        "robot = {}: at acceleration_m_per_s2 = {:g} the tool leaves the corridor faster than the laser "
        "is off, so nothing could be cut; lower it",
        model_.name, model_.limits.acceleration_m_per_s2));
  }
}

std::unique_ptr<Corridor> Station::prepare(const ContourMessage& contour) const {
  double reach_m = 0.0;
  for (const auto& point : contour.points_m) reach_m = std::max(reach_m, point.norm());
  if (reach_m > model_.workspace.radius_m) {
    throw input_error(
        fmt::format("the contour reaches {:.1f} mm from the workspace's centre, but {} reaches {:.1f} mm; "
                    "use a smaller --width-mm",
                    reach_m * 1e3, model_.name, model_.workspace.radius_m * 1e3));
  }
  const geometry::Polyline line{contour.points_m, contour.closed};
  return std::make_unique<Corridor>(
      Corridor{contour.id, geometry::NearestIndex(line),
               laser::CorridorRaster(line, settings_.node.interlock.corridor_m, model_.workspace.radius_m)});
}

SlaveOutputs Station::step(std::int64_t now_ns, const Corridor* corridor,
                           std::span<const Received<CommandBlock>> commands, const StopOrder& stop,
                           double look_age_s) noexcept {
  SlaveInputs inputs;
  inputs.joints = machine_.read();
  if (!machine_.started()) {  // nobody knows where the tool is: nothing to decide, nothing to report
    beam_.off();
    machine_.write(Vec3::Zero());
    SlaveOutputs out;
    out.stop = stop.number;
    return out;
  }
  inputs.commands = commands;
  inputs.stop = stop;
  inputs.corridor = corridor;
  inputs.fault = machine_.failed() || beam_.failed();
  inputs.look_age_s = look_age_s;
  inputs.emission_agrees = beam_.emission_agrees();
  inputs.monitor_agrees = monitor_.agrees();
  SlaveOutputs out = node_.step(now_ns, inputs);
  if (out.command_age_s >= 0.0) age_.add(out.command_age_s);
  if (inputs.joints.valid) machine_.watch(out.tool_m, node_.doubt());
  if (machine_.failed()) {
    out.laser_w = 0.0;
    out.permit = {};
  }
  out.laser_w = beam_.emit(std::move(out.permit), now_ns, out.laser_w, false);
  monitor_.step(inputs.joints, corridor != nullptr && corridor->raster ? &*corridor->raster : nullptr,
                out.mode == SlaveMode::kStopped, out.laser_w > 0.0);
  machine_.write(out.currents_a);
  const SlaveRow row{tick_,
                     static_cast<double>(now_ns) * 1e-9,
                     out.applied_tick,
                     out.reference.position_m,
                     machine_.true_tool_m().value_or(out.tool_m),
                     out.laser_w,
                     static_cast<int>(out.interlock),
                     out.settled,
                     out.force_n};
  ring_ != nullptr ? ring_->push(slave_columns(), row) : recorder_.push(row);
  ++tick_;
  machine_.advance();
  return out;
}

void Station::report(RunRecord& record) const {
  record.slave = recorder_.rows();
  record.slave_drive = {settings_.machine.drive, machine_.plant() != nullptr};
  const SlaveCounters counters = node_.counters();
  Metrics& f = record.slave_figures;
  f["rate_hz"] = settings_.node.control_hz;
  f["control_period_s"] = control_period_s();
  f["blocks"] = static_cast<double>(counters.blocks);
  f["lost"] = static_cast<double>(counters.lost);
  f["stale"] = static_cast<double>(counters.stale);
  f["refused"] = static_cast<double>(counters.refused);
  f["late_steps"] = static_cast<double>(counters.late_steps);
  f["missed_ticks"] = static_cast<double>(counters.missed_ticks);
  const auto states = static_cast<double>(std::max<std::uint64_t>(counters.states, 1));
  const double samples = 3.0 * settings_.node.feedback.block * states;
  f["block"] = settings_.node.feedback.block;
  f["keep"] = settings_.node.feedback.keep;
  f["max_rms"] = settings_.node.feedback.max_rms;
  f["force_keep"] = settings_.node.force.keep;
  f["force_max_rms"] = settings_.node.force.max_rms;
  f["position_bits_per_sample"] = 8.0 * static_cast<double>(counters.position_bytes) / samples;
  f["force_bits_per_sample"] = 8.0 * static_cast<double>(counters.force_bytes) / samples;
  f["payload_bytes_per_s"] = static_cast<double>(counters.position_bytes + counters.force_bytes) /
                             (std::max(static_cast<double>(tick_), 1.0) * control_period_s());
  f["playout_corrections"] = static_cast<double>(node_.playout().corrections());
  f["playout_ms"] = node_.playout().wait_s() * 1e3;
  if (age_.count > 0) {
    f["command_age_mean_ms"] = 1e3 * age_.sum_s / static_cast<double>(age_.count);
    f["command_age_max_ms"] = 1e3 * age_.max_s;
  }
  f["beam_age_ms"] = 1e3 * settings_.node.interlock.beam_age_s;
  f["laser_clipped"] = static_cast<double>(beam_.clipped());
  f["laser_unpermitted"] = static_cast<double>(beam_.unpermitted());
  f["laser_untold"] = static_cast<double>(beam_.write_failures());
  f["laser_refused"] = static_cast<double>(beam_.refused());
  f["drive_refused"] = static_cast<double>(machine_.refused());
  f["readings_missed"] = static_cast<double>(machine_.readings_missed());
  f["dropped_rows"] = static_cast<double>(recorder_.dropped());
}

}  // namespace telekerf::slave
