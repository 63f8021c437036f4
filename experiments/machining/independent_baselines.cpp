// SPDX-License-Identifier: Apache-2.0
#include "experiments/machining/independent_baselines.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include "common/control/disturbance_observer.h"

namespace telekerf::experiments {
namespace {

using nlohmann::ordered_json;

const char* name_of(machining::ModelUse use) {
  switch (use) {
    case machining::ModelUse::kNone:
      return "none";
    case machining::ModelUse::kJoints:
      return "joints";
    case machining::ModelUse::kWhole:
      return "whole";
  }
  return "unknown";
}

constexpr int kSeeds = 5;  ///< of which a ratio's median and worst are told

double ratio_with_seed(const machining::TimedPath& plan, const geometry::Polyline& contour,
                       ContourRunSettings ours, ContourRunSettings theirs, std::uint64_t seed) {
  ours.seed = theirs.seed = seed;
  return normal_error_ratio(measure(run_contour(plan, contour, ours), ours),
                            measure(run_contour(plan, contour, theirs), theirs));
}

ordered_json side_by_side(const machining::TimedPath& plan, const geometry::Polyline& contour,
                          const ContourRunSettings& settings, const ContourRunSettings& independent) {
  const auto ours = measure(run_contour(plan, contour, settings), settings);
  const auto theirs = measure(run_contour(plan, contour, independent), independent);
  std::vector<double> ratios{normal_error_ratio(ours, theirs)};
  for (int n = 1; n < kSeeds; ++n)
    ratios.push_back(
        ratio_with_seed(plan, contour, settings, independent, settings.seed + static_cast<std::uint64_t>(n)));
  std::sort(ratios.begin(), ratios.end());
  return {{"normal_error_um", ours["normal_error_um"]},
          {"independent_normal_error_um", theirs["normal_error_um"]},
          {"mean_mm_s", ours["tangential_speed"]["mean_mm_s"]},
          {"independent_mean_mm_s", theirs["tangential_speed"]["mean_mm_s"]},
          {"ripple_everywhere_percent", ours["tangential_speed"]["ripple_everywhere_percent"]},
          {"independent_ripple_everywhere_percent", theirs["tangential_speed"]["ripple_everywhere_percent"]},
          {"normal_error_ratio", normal_error_ratio(ours, theirs)},
          {"seeds", kSeeds},
          {"normal_error_ratio_median", ratios[kSeeds / 2]},
          {"normal_error_ratio_worst", ratios.back()},
          {"independent_tuning", tuning(independent)}};
}

ContourRunSettings independent(ContourRunSettings settings, machining::ModelUse model, double observer_rad_s,
                               double velocity_rad_s) {
  settings.controller = machining::ControllerKind::kIndependent;
  settings.follower.independent_model = model;
  settings.follower.observer_rad_s = observer_rad_s;
  settings.follower.velocity_rad_s = velocity_rad_s;
  return settings;
}

/// True positions of a joint of unit mass after one wrong reading of 1 m, until the loop has come to rest.
std::vector<double> answer_to_a_reading(double law_rad_s, const machining::PathFollowerSettings& s) {
  constexpr double kSeconds = 2.0;
  const double dt = 1.0 / s.control_hz;
  control::DisturbanceObserver observer({.period_s = dt,
                                         .bandwidth_rad_per_s = s.observer_rad_s,
                                         .velocity_bandwidth_rad_per_s = s.velocity_rad_s,
                                         .loop_delay = s.loop_delay});
  std::array<double, control::kMaxLoopDelay + 1> sent{};
  double position = 0.0, velocity = 0.0;
  std::vector<double> out;
  for (int i = 0; i < static_cast<int>(kSeconds * s.control_hz); ++i) {
    out.push_back(position);
    observer.update({position + (i == 0 ? 1.0 : 0.0), 0.0, 0.0}, true);
    for (std::size_t k = sent.size() - 1; k > 0; --k) sent[k] = sent[k - 1];
    sent[0] = -law_rad_s * law_rad_s * observer.joints_m()[0] -
              2.0 * law_rad_s * observer.joint_velocity_m_per_s()[0] + observer.disturbance_n()[0];
    observer.applied({sent[0], 0.0, 0.0}, robot::Mat3::Identity());
    const double acts = sent[static_cast<std::size_t>(s.loop_delay)];
    position += dt * velocity + 0.5 * dt * dt * acts;
    velocity += dt * acts;
  }
  return out;
}

}  // namespace

double closed_loop_hz(double law_rad_s, const machining::PathFollowerSettings& settings) {
  const std::vector<double> answer = answer_to_a_reading(law_rad_s, settings);
  const auto gain = [&](double hz) {
    const std::complex<double> step = std::polar(1.0, -2.0 * std::numbers::pi * hz / settings.control_hz);
    std::complex<double> turn = 1.0, sum = 0.0;
    for (const double x : answer) {
      sum += x * turn;
      turn *= step;
    }
    return std::abs(sum);
  };
  double hz = 0.5 * settings.control_hz;
  while (hz > 1.0 && gain(hz) < std::numbers::sqrt2 / 2.0) hz /= 1.005;
  return hz;
}

ContourRunSettings tuned_independent(ContourRunSettings settings) {
  settings.follower.along_rad_s = 170.0;
  return independent(settings, machining::ModelUse::kNone, 400.0, 600.0);
}

ContourRunSettings assisted_independent(const ContourRunSettings& settings) {
  return independent(settings, machining::ModelUse::kJoints, 1400.0, 3200.0);
}

ordered_json tuning(const ContourRunSettings& s) {
  const bool independent = s.controller == machining::ControllerKind::kIndependent;
  ordered_json out{{"along_rad_s", s.follower.along_rad_s}};
  if (!independent) out["across_rad_s"] = s.follower.across_rad_s;
  out.update({{"observer_rad_s", s.follower.observer_rad_s},
              {"velocity_rad_s", s.follower.velocity_rad_s},
              {"closed_loop_along_hz", closed_loop_hz(s.follower.along_rad_s, s.follower)},
              {"model", name_of(machining::model_use(s.controller, s.follower))},
              {"preview", s.follower.preview},
              {"loop_delay", s.follower.loop_delay}});
  return out;
}

double normal_error_ratio(const ordered_json& ours, const ordered_json& theirs) {
  return ours["normal_error_um"]["rms"].get<double>() / theirs["normal_error_um"]["rms"].get<double>();
}

ordered_json equal_terms(const machining::TimedPath& plan, const geometry::Polyline& contour,
                         const ContourRunSettings& used) {
  ordered_json out;
  for (const auto model : {machining::ModelUse::kNone, machining::ModelUse::kWhole}) {
    ContourRunSettings settings = used;
    settings.follower.model = settings.follower.independent_model = model;
    ContourRunSettings other = settings;
    other.controller = machining::ControllerKind::kIndependent;
    out[model == machining::ModelUse::kNone ? "both_without_model" : "both_with_model"] =
        side_by_side(plan, contour, settings, other);
  }
  out["independent_tuned"] = side_by_side(plan, contour, used, tuned_independent(used));
  out["independent_assisted"] = side_by_side(plan, contour, used, assisted_independent(used));
  ContourRunSettings perfect = used;
  perfect.perfect_sensor = true;
  out["independent_assisted_perfect_sensor"] =
      side_by_side(plan, contour, perfect, assisted_independent(perfect));
  return out;
}

}  // namespace telekerf::experiments
