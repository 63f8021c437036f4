// SPDX-License-Identifier: Apache-2.0
#include "experiments/constraint/constraint_acceptance.h"

#include <algorithm>
#include <cmath>

namespace telekerf::experiments {
namespace {

using master::OperatorDisturbance;

constexpr double kLong = 1000.0;

/// A hand that does nothing but disturb.
TrialSettings still(std::uint64_t seed, double duration_s, std::vector<OperatorDisturbance> disturbances) {
  TrialSettings settings;
  settings.station.seed = seed;
  settings.duration_s = duration_s;
  disturbances.insert(disturbances.begin(),
                      OperatorDisturbance{OperatorDisturbance::Kind::kLetGo, 0.0, kLong, 0.0, 0.0, 0.0});
  settings.station.hand.disturbances = std::move(disturbances);
  return settings;
}

/// First row in which the hand was guided, and rows a second.
struct Clock {
  std::size_t start = 0;
  double rate_hz = 1000.0;
  explicit Clock(const Trial& trial) {
    while (start < trial.rows.size() && std::isnan(trial.off_m[start])) ++start;
  }
  std::size_t row(double since_s) const {
    return start + static_cast<std::size_t>(std::lround(since_s * rate_hz));
  }
};

double distance(const MasterRow& a, const MasterRow& b) {
  return std::hypot(a.tool_m[0] - b.tool_m[0], a.tool_m[1] - b.tool_m[1]);
}

/// Distance that a hand with a constant force along the circle comes between two moments.
double travelled(std::uint64_t seed, double along_n, double from_s, double to_s) {
  const Trial trial = run_trial(
      circle_outline(8e-3),
      still(seed, to_s + 2.0, {{OperatorDisturbance::Kind::kFight, 0.5, kLong, 0.0, along_n, 0.0}}));
  const Clock clock(trial);
  double sum = 0.0;
  for (std::size_t i = clock.row(from_s) + 1; i < std::min(clock.row(to_s), trial.rows.size()); ++i) {
    sum += distance(trial.rows[i], trial.rows[i - 1]);
  }
  return sum;
}

/// Least force for which the tool comes at least this far, by halving.
double least_force(std::uint64_t seed, double distance_m, double from_s, double to_s) {
  double low = 0.0;
  double high = 2.0;
  for (int i = 0; i < 9; ++i) {
    const double middle = 0.5 * (low + high);
    (travelled(seed, middle, from_s, to_s) >= distance_m ? high : low) = middle;
  }
  return high;
}

}  // namespace

Decay measure_decay(std::uint64_t seed, double mismatch) {
  TrialSettings settings = still(seed, 5.0, {{OperatorDisturbance::Kind::kFight, 0.2, kLong, 1.0, 0.0, 0.0}});
  settings.station.mismatch = mismatch;
  settings.station.corridor_mm = 0.1;  // near enough that the speed of return is not bounded
  settings.station.node.constraint.entry_s = 0.0;
  constexpr double kClose = 1.8;
  settings.form = [](double since_s) {
    return since_s >= kClose ? std::optional(master::ConstraintMode{}) : std::nullopt;
  };
  const Trial trial = run_trial(circle_outline(8e-3), settings);
  const Clock clock(trial);
  const std::size_t first = clock.row(kClose);
  Decay decay;
  decay.chosen_rad_s = trial.bandwidth_rad_s;
  constexpr std::size_t kRows = 60;
  const double start = trial.off_m[first];
  const auto ideal = [&](double w, double t) { return start * (1.0 + w * t) * std::exp(-w * t); };
  const auto squares = [&](double w) {
    double sum = 0.0;
    for (std::size_t i = 0; i < kRows; ++i) {
      sum += std::pow(trial.off_m[first + i] - ideal(w, static_cast<double>(i) / clock.rate_hz), 2);
    }
    return sum;
  };
  decay.rate_rad_s = 20.0;
  for (double w = 20.0; w < 1000.0; w += 0.25) {
    if (squares(w) < squares(decay.rate_rad_s)) decay.rate_rad_s = w;
  }
  for (std::size_t i = 0; i < kRows; ++i) {
    const double t = static_cast<double>(i) / clock.rate_hz;
    decay.t_s.push_back(t);
    decay.error_m.push_back(trial.off_m[first + i]);
    decay.ideal_m.push_back(ideal(decay.chosen_rad_s, t));
    decay.worst_residual_m =
        std::max(decay.worst_residual_m, std::abs(trial.off_m[first + i] - ideal(decay.rate_rad_s, t)));
  }
  return decay;
}

double glide_force_n(std::uint64_t seed) {
  constexpr double kSpeed = 0.02;
  const double drag = master::ConstraintSettings{}.damping_n_s_per_m * kSpeed;
  return least_force(seed, kSpeed * 4.0, 2.5, 6.5) - drag;
}

double breakaway_force_n(std::uint64_t seed) { return least_force(seed, 0.5e-3, 0.5, 1.5); }

double drift_m_per_s(const ContourMessage& contour, std::uint64_t seed) {
  TrialSettings settings;
  settings.station.seed = seed;
  settings.duration_s = 15.0;
  settings.station.hand.disturbances = {{OperatorDisturbance::Kind::kLetGo, 3.0, kLong, 0.0, 0.0, 0.0}};
  const Trial trial = run_trial(contour, settings);
  const Clock clock(trial);
  const std::size_t from = clock.row(4.5);
  const std::size_t to = clock.row(12.5);
  return distance(trial.rows[from], trial.rows[std::min(to, trial.rows.size() - 1)]) / 8.0;
}

double letting_go_m(const ContourMessage& contour, std::uint64_t seed) {
  TrialSettings settings;
  settings.station.seed = seed;
  settings.station.hand_speed_mm_s = 30.0;
  settings.duration_s = 30.0;
  // Out of the work, and every second time out of a steady push to one side.
  auto& disturbances = settings.station.hand.disturbances;
  std::vector<double> moments;
  for (int i = 0; 1.0 + 0.9 * i < 27.0; ++i) {
    const double at = 1.0 + 0.9 * i;
    if (i % 2 == 1)
      disturbances.push_back(
          {OperatorDisturbance::Kind::kFight, at - 0.2, 0.2, i % 4 == 1 ? 3.0 : -3.0, 0.5, 0.0});
    disturbances.push_back({OperatorDisturbance::Kind::kLetGo, at, 0.3, 0.0, 0.0, 0.0});
    moments.push_back(at);
  }
  const Trial trial = run_trial(contour, settings);
  const Clock clock(trial);
  double largest = 0.0;
  for (const double at : moments) {
    const std::size_t first = clock.row(at);
    for (std::size_t i = first; i < std::min(first + 200, trial.off_m.size()); ++i) {
      largest = std::max(largest, std::abs(trial.off_m[i] - trial.off_m[first]));
    }
  }
  return largest;
}

Fight fight(double force_n, std::uint64_t seed) {
  Fight out;
  out.force_n = force_n;
  constexpr double kAt = 1.0;
  constexpr double kFor = 0.5;
  const Trial trial =
      run_trial(circle_outline(8e-3),
                still(seed, 7.0, {{OperatorDisturbance::Kind::kFight, kAt, kFor, force_n, 0.0, 0.0}}));
  const Clock clock(trial);
  out.saturated = trial.saturated;
  out.broken = trial.broken;
  double side = 1.0;
  for (std::size_t i = clock.row(kAt); i < trial.rows.size(); ++i) {
    const double off = trial.off_m[i];
    if (i < clock.row(kAt + kFor)) {
      if (std::abs(off) > out.pushed_off_m) {
        out.pushed_off_m = std::abs(off);
        side = std::copysign(1.0, off);
      }
      continue;
    }
    out.pushed_off_m = std::max(out.pushed_off_m, side * off);
    out.overshoot_m = std::max(out.overshoot_m, -side * off);
    // The tool flies on for a moment after the hand is gone; what counts is the way back.
    if (i > clock.row(kAt + kFor + 0.1))
      out.return_m_per_s = std::max(out.return_m_per_s, std::abs(off - trial.off_m[i - 1]) * clock.rate_hz);
    if (std::abs(off) > 50e-6) out.back_s = static_cast<double>(i - clock.row(kAt + kFor)) / clock.rate_hz;
  }
  return out;
}

Region measure_region(std::uint64_t seed) {
  TrialSettings settings;
  settings.station.seed = seed;
  settings.duration_s = 14.0;
  settings.station.corridor_mm = 0.5;
  settings.form = [](double since_s) -> std::optional<master::ConstraintMode> {
    if (since_s < 6.0) return std::nullopt;
    return since_s < 9.0 ? master::ConstraintMode{} : master::ConstraintMode{0.5e-3, 0.0};
  };
  const Trial trial = run_trial(circle_outline(8e-3), settings);
  const Clock clock(trial);
  Region region;
  for (std::size_t i = clock.start; i < trial.off_m.size(); ++i) {
    region.used_m = std::max(region.used_m, std::abs(trial.off_m[i]));
  }
  region.beyond_wall_m = region.used_m - 0.5e-3;
  return region;
}

}  // namespace telekerf::experiments
