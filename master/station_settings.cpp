// SPDX-License-Identifier: Apache-2.0
#include "master/station_settings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/runtime/startup_error.h"
#include "master/law.h"
#include "master/observer/estimators.h"
#include "master/operator/operator_input.h"
#include "master/operator_requests.h"
#include "master/stream_choice.h"

namespace telekerf::master {
namespace {

/// Finest step of coded accelerations, m/s^2.
constexpr double kAccelerationQuantum = 1e-2;
/// Silence after which a slave stops, unless it is told otherwise.
constexpr double kSlaveStale_s = 0.15;
/// w / stream rate: at 1 the law's sampled loop is no longer stable.
constexpr double kFastestLaw = 0.8;

}  // namespace

void StationSettings::add_parameters(Settings& settings) {
  settings.add("robot", robot, kRobot, "robot: a shipped name or a file");
  settings.add("beta", beta, {.min = kSmallestBeta, .max = kLargestBeta},
               "slave motion = beta x master motion");
  machine.add_parameters(settings);
  settings.add("hand", hand_device, device_form(hand_forms(), validate_hand),
               "who moves a simulated master: the simulated operator, the console's page, a device, a "
               "program, a record");
  settings.add(
      "spacemouse_mm_per_count", cap.mm_per_count, {.min = 1e-4, .max = 0.1, .unit = "mm"},
      "hand spacemouse: how far in front of the tool it pulls, for a count of its cap (of about 350)");
  settings.add("spacemouse_dead_counts", cap.dead_counts, {.min = 0, .max = 200},
               "hand spacemouse: counts of its cap that are taken for rest");
  settings.add("button", button, device_form(operator_input_forms(), validate_operator_input),
               "who holds the laser button while the slave follows; hand: the hand itself");
  settings.add("mismatch", mismatch, {.min = 0, .max = 0.5},
               "how far the simulated robot is off its file, as a share");
  settings.add("seed", seed, kSeeds, "of the simulated robot and hand");
  settings.add("control_hz", node.control_hz, {.min = 200, .max = 20000, .unit = "Hz"},
               "control rate, a multiple of stream_hz");
  settings.add("stream_hz", node.stream_hz, {.min = 100, .max = 10000, .unit = "Hz"},
               "samples a second in the command stream");
  settings.add("beam_age_s", beam_age_s, {.min = 0.02, .max = 2, .unit = "s"},
               "as the slave's: one that is silent for longer, and for 0.5 s at least, is let go");
  add_stream_parameters(settings);
  add_guidance_parameters(settings);
}

void StationSettings::add_guidance_parameters(Settings& settings) {
  settings.add("half_window", node.constraint.half_window, {.min = 1, .max = 32},
               "points to either side of the circle fit");
  settings.add("curve", node.constraint.curve, kCurves, "what the hand is guided along");
  settings.add("corridor_mm", corridor_mm, {.min = 0, .max = 10, .unit = "mm"},
               "half width of a corridor in which the hand is free, 0: guided on the curve");
  settings.add("corridor_stiffness_n_per_m", node.constraint.stiffness_n_per_m,
               {.min = 0, .max = 20000, .unit = "N/m"}, "spring inside the corridor, towards the curve");
  settings.add("constraint_rad_s", node.constraint_rad_s, {.min = 0, .max = 5000, .unit = "rad/s"},
               "bandwidth across the curve, 0: chosen from robot, rate and drive");
  settings.add("virtual_mass_kg", node.constraint.mass_kg, {.min = 0.1, .max = 20, .unit = "kg"},
               "that the hand moves along the curve");
  settings.add("virtual_drag_ns_per_m", node.constraint.damping_n_s_per_m,
               {.min = 0, .max = 200, .unit = "N s/m"}, "damping along the curve");
  settings.add("observer_rad_s", node.observer_rad_s, {.min = 0, .max = 15000, .unit = "rad/s"},
               "of the disturbance observer, 0: chosen likewise");
  settings.add("hand_speed_mm_s", hand_speed_mm_s, {.min = 0.1, .max = 200, .unit = "mm/s"},
               "mean speed of the simulated hand");
  settings.add("hand_sideways_n", hand.max_sideways_n, {.min = 0, .max = 30, .unit = "N"},
               "how hard the simulated hand pushes off the curve at most; two thirds of it in the mean (rms)");
  settings.add("felt_depth_mm", felt_depth_mm, {.min = 0, .max = 20, .unit = "mm"},
               "depth of the cut that the hand feels itself held to, 0: it feels nothing of the cut");
  settings.add("felt_depth_speed_mm2_per_s", felt_depth_speed_mm2_per_s,
               {.min = 0.01, .max = 1000, .unit = "mm2/s"},
               "depth of a line times the beam's speed, of this material and power");
  settings.add("felt_max_n", node.constraint.felt.max_n, {.min = 0, .max = 10, .unit = "N"},
               "largest force that is felt of the cut");
  settings.not_with({"corridor_stiffness_n_per_m"}, "corridor_mm", {"0"});
  settings.not_with({"felt_depth_speed_mm2_per_s", "felt_max_n"}, "felt_depth_mm", {"0"});
}

void StationSettings::add_stream_parameters(Settings& settings) {
  settings.add("law", node.command.law, kLaws, "who computes the slave's acceleration");
  settings.add("estimator", node.command.observer.estimator, kEstimators,
               "how the slave's state is predicted");
  settings.add("codec", codec, codec::kCodecs, "of the command stream");
  settings.add("tracking_rad_s", tracking_rad_s, {.min = 0, .max = 5000, .unit = "rad/s"},
               "bandwidth of the law that makes the commands, 0: 400, less on a slow stream");
  settings.add("timing_error_s", node.command.timing_error_s, {.min = 1e-4, .max = 1, .unit = "s"},
               "of the slave's answer, that remote-acceleration's loop across the delay bears");
  settings.add("thesis_cutoff_rad_s", node.command.observer.thesis_cutoff_rad_s,
               {.min = 0.1, .max = 1000, .unit = "rad/s"}, "estimator thesis: g of eq. 93's low-pass");
  settings.add("innovation_gain_per_s", node.command.observer.innovation_gain_per_s,
               {.min = 0, .max = 1000, .unit = "1/s"},
               "estimator delayed-innovation: gain, 0: 1/(e D) of the delay D that is seen");
  settings.add("predictor_rad_s", node.command.observer.predictor_rad_s,
               {.min = 0.1, .max = 1000, .unit = "rad/s"},
               "estimator predictor of remote-acceleration: poles of position and velocity");
  settings.add("disturbance_rad_s", node.command.observer.disturbance_rad_s,
               {.min = 0, .max = 1000, .unit = "rad/s"},
               "estimator predictor of remote-acceleration: pole of the disturbance");
  settings.add("block", node.command.codec.block, kBlockSamples, "samples a block of the command stream");
  settings.add("keep", node.command.codec.keep, kKeptCoefficients, "coefficients kept a block and axis");
  settings.add("max_rms", node.command.codec.max_rms, {.min = 0, .max = 1000},
               "RMS error of a block that is kept instead [m/s^2; law local: m], 0: keep");
  settings.add("redundancy", node.command.codec.redundancy, kCopies, "previous blocks repeated in a packet");
  settings.add("max_redundancy", node.command.max_redundancy, {.min = 0, .max = 7},
               "and at most, after losses that these did not cover; redundancy if that is more");
  codec::refuse_unread(settings, {""});
  settings.not_with({"max_redundancy"}, "codec", {"raw"});
  settings.only_with({"thesis_cutoff_rad_s"}, "estimator", {"thesis", "thesis-convergent"});
  settings.only_with({"innovation_gain_per_s"}, "estimator", {"delayed-innovation", "thesis-convergent"});
  settings.only_with({"predictor_rad_s", "disturbance_rad_s"}, "estimator", {"predictor"});
  settings.not_with({"tracking_rad_s"}, "law", {"local"});
  settings.only_with({"timing_error_s", "predictor_rad_s", "disturbance_rad_s"}, "law",
                     {"remote-acceleration"});
}

StationSettings StationSettings::validated() const {
  StationSettings settings = *this;
  settings.node.stale_s = std::max(MasterSettings{}.stale_s, beam_age_s);
  settings.hand.speed_m_per_s = hand_speed_mm_s * 1e-3;
  settings.node.constraint.corridor_m = corridor_mm * 1e-3;
  settings.node.constraint.felt.depth_m = felt_depth_mm * 1e-3;
  settings.node.constraint.felt.depth_speed_m2_per_s = felt_depth_speed_mm2_per_s * 1e-6;
  const double ratio = node.control_hz / node.stream_hz;
  if (ratio < 1.0 || std::abs(ratio - std::round(ratio)) > 1e-9) {
    throw configuration_error(fmt::format("control_hz = {:g} must be a whole multiple of stream_hz = {:g}",
                                          node.control_hz, node.stream_hz));
  }
  auto& command = settings.node.command;
  const double block_s = command.codec.block / node.stream_hz;
  // What is lost comes again with the next block.
  if (2.0 * block_s >= kSlaveStale_s) {
    throw configuration_error(fmt::format(
        "block = {} samples at stream_hz = {:g} take {:.0f} ms and must take less than {:.0f}: a slave that "
        "hears nothing for {:.0f} ms stops, and what is lost comes again with the next block; use a smaller "
        "block or a faster stream",
        command.codec.block, node.stream_hz, block_s * 1e3, 0.5 * kSlaveStale_s * 1e3, kSlaveStale_s * 1e3));
  }
  if (tracking_rad_s > kFastestLaw * node.stream_hz) {
    throw configuration_error(
        fmt::format("tracking_rad_s = {:g} is too fast for stream_hz = {:g}: at most {:g}; 0 chooses it",
                    tracking_rad_s, node.stream_hz, kFastestLaw * node.stream_hz));
  }
  command.tracking_rad_s =
      tracking_rad_s > 0.0 ? tracking_rad_s : std::min(LawSettings{}.tracking_rad_s, 0.4 * node.stream_hz);
  command.ticks_per_sample = static_cast<int>(std::lround(ratio));
  command.codec.sample_period_ns = static_cast<std::uint32_t>(std::llround(1e9 / node.stream_hz));
  command.codec.anchored = command.law == Law::kLocal;
  // A loop that spans the delay predicts a hasty approach badly.
  if (command.law == Law::kRemoteAcceleration)
    command.approach = {.rate_rad_per_s = std::min(20.0, command.tracking_rad_s),
                        .max_acceleration_m_per_s2 = 0.5};
  command.codec.integrated = command.law != Law::kLocal;
  // Of a block's mean, one step moves the tool by 0.3 um within 16 ms.
  if (command.codec.integrated) command.codec.quantum = kAccelerationQuantum;
  command.codec = codec::with_codec(command.codec, codec).validated();
  return settings;
}

}  // namespace telekerf::master
