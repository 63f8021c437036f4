// SPDX-License-Identifier: Apache-2.0
#include "experiments/chaos/chaos_run.h"

#include <algorithm>
#include <optional>

#include "experiments/chaos/injection.h"
#include "experiments/chaos/world.h"
#include "experiments/simulation/simulation.h"

namespace telekerf::experiments {
namespace {

constexpr double kLeastHealed_s = 7.0;
constexpr double kLeastFaults_s = 1.0;
/// The lap goes on: it still cuts in so much of the run's end.
constexpr double kLast_s = 1.0;

}  // namespace

ChaosContours chaos_contours(const master::StationSettings& master, const slave::StationSettings& slave) {
  simulation::SimulationSettings settings;
  settings.master = master;
  settings.slave = slave;
  ChaosContours contours;
  contours.work = simulation::find_contour(settings);
  settings.image = "blob";
  contours.other = simulation::find_contour(settings);
  contours.impostor = contours.other;
  contours.impostor.id = contours.work.id;
  return contours;
}

double shortest_s(ChaosMode mode) noexcept {
  return mode == ChaosMode::kSafety ? kLeastFaults_s : kLeastFaults_s + kLeastHealed_s;
}

double heal_s(double duration_s, ChaosMode mode) noexcept {
  if (mode == ChaosMode::kSafety) return duration_s;
  return std::max(0.0, duration_s - std::max(duration_s / 3.0, kLeastHealed_s));
}

ChaosOutcome run_chaos(const ChaosSettings& settings, const ChaosContours& contours) {
  const bool heals = settings.mode == ChaosMode::kLiveness;
  const double healed_s = heal_s(settings.duration_s, settings.mode);
  const Schedule schedule = draw_schedule(settings.seed, settings.kinds, healed_s);
  Injection injection(schedule);
  World world(settings, contours, schedule);
  const std::int64_t end_ns = ns(settings.duration_s);
  bool healed = !heals;
  std::optional<double> inside_j;
  for (std::int64_t now_ns = 0; now_ns < end_ns; now_ns = world.next_ns()) {
    injection.turn(now_ns, world);
    if (!healed && now_ns >= ns(healed_s)) {
      healed = true;
      world.heal(now_ns);
    }
    world.step(now_ns, injection.attacks());
    if (!inside_j && now_ns >= end_ns - ns(kLast_s)) inside_j = world.checker().findings().energy_inside_j;
  }
  const bool recovered = world.checker().findings().energy_inside_j > inside_j.value_or(0.0);
  if (heals && !recovered) world.checker().not_recovered(end_ns);
  ChaosOutcome out = world.end();
  out.recovered = heals && recovered;
  return out;
}

}  // namespace telekerf::experiments
