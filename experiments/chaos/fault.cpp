// SPDX-License-Identifier: Apache-2.0
#include "experiments/chaos/fault.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "experiments/draw.h"
#include "netem/core/random.h"

namespace telekerf::experiments {
namespace {

/// No fault before this: both stations are up by then.
constexpr double kFirst_s = 0.5;
/// Steps of a swizzle follow each other by as much as this.
constexpr double kSwizzleStep_s = 0.4;
constexpr double kRestart_s = 1.5;  ///< at most, until a process is there again
constexpr double kLongestDelay_s = 1.5;

/// How often a kind comes and how long it holds.
struct Rate {
  double every_s;  ///< mean time from one end to the next beginning
  double least_s, most_s;
};

Rate rate_of(FaultKind kind) noexcept {
  switch (kind) {
    case FaultKind::kLoss:
    case FaultKind::kReorder:
    case FaultKind::kDuplicate:
    case FaultKind::kCorrupt:
      return {4.0, 0.1, 3.0};
    case FaultKind::kDelay:
      return {6.0, 0.3, 3.0};
    case FaultKind::kOutageForward:
    case FaultKind::kOutageBackward:
    case FaultKind::kOutage:
      return {6.0, 0.05, 2.5};
    case FaultKind::kSwizzle:
      return {8.0, 0.5, 2.0};
    case FaultKind::kSlaveClock:
    case FaultKind::kMasterClock:
      return {5.0, 1.0, 6.0};
    case FaultKind::kSlaveAsleep:
    case FaultKind::kMasterAsleep:
      return {6.0, 0.002, 2.0};
    case FaultKind::kSlaveRestart:
    case FaultKind::kMasterRestart:
      return {9.0, 0.2, kRestart_s};
    case FaultKind::kContour:
    case FaultKind::kImpostor:
    case FaultKind::kBeta:
      return {8.0, 0.001, 0.002};
    case FaultKind::kStop:
      return {7.0, 0.3, 2.0};
    case FaultKind::kChatter:
      return {4.0, 0.2, 2.0};
    case FaultKind::kSensorDropout:
      return {5.0, 0.001, 0.06};
    case FaultKind::kSensorSlip:
      return {12.0, 0.001, 0.002};
    case FaultKind::kSensorStuck:
      return {7.0, 0.002, 0.3};
    case FaultKind::kLaserDeaf:
    case FaultKind::kLaserStuck:
      return {7.0, 0.002, 0.5};
    case FaultKind::kForger:
    case FaultKind::kReplayer:
      return {6.0, 0.1, 3.0};
    case FaultKind::kSecondMaster:
      return {9.0, 3.0, 6.0};
  }
  return {6.0, 0.1, 1.0};
}

std::uint64_t seed_of(std::uint64_t seed, std::uint64_t part) noexcept {
  return netem::mixed(netem::mixed(seed + 1) ^ (part + 1) * 0x9E3779B97F4A7C15ULL);
}

/// Clogged one by one, released in another order.
void add_swizzle(const FaultWindow& window, Draw& draw, std::vector<FaultWindow>& out) {
  std::vector<FaultKind> lines{FaultKind::kOutageForward, FaultKind::kOutageBackward, FaultKind::kSlaveAsleep,
                               FaultKind::kMasterAsleep};
  const auto shuffled = [&](std::vector<FaultKind> order) {
    for (std::size_t i = order.size() - 1; i > 0; --i) std::swap(order[i], order[draw.word() % (i + 1)]);
    return order;
  };
  const std::vector<FaultKind> clogged = shuffled(lines);
  const std::vector<FaultKind> released = shuffled(lines);
  const double step_s = draw.between(0.0, kSwizzleStep_s);
  for (std::size_t i = 0; i < clogged.size(); ++i) {
    const auto place = std::find(released.begin(), released.end(), clogged[i]) - released.begin();
    const double later_s = step_s * static_cast<double>(lines.size());
    FaultWindow one = window;
    one.kind = clogged[i];
    one.from_s += step_s * static_cast<double>(i);
    one.to_s = std::max(one.from_s + 1e-3, window.to_s + step_s * static_cast<double>(place) - later_s);
    out.push_back(one);
  }
}

void add_windows(FaultKind kind, std::uint64_t seed, double until_s, std::vector<FaultWindow>& out) {
  Draw draw(seed_of(seed, static_cast<std::uint64_t>(kind)));
  const Rate rate = rate_of(kind);
  double now_s = kFirst_s;
  while (true) {
    FaultWindow window{.kind = kind};
    now_s += draw.between(0.0, 2.0 * rate.every_s);
    window.from_s = now_s;
    window.to_s = now_s + draw.factor(rate.least_s, rate.most_s);
    window.strength = draw.between(0.0, 1.0);
    window.word = draw.word();
    if (window.from_s >= until_s) return;
    now_s = window.to_s;
    if (kind == FaultKind::kSwizzle) {
      Draw order(window.word);
      add_swizzle(window, order, out);
    } else {
      out.push_back(window);
    }
  }
}

/// What one window does to a direction.
void impose(const FaultWindow& window, bool forward, netem::Conditions& out) {
  const auto lose = [&](double share) {
    out.loss.model = netem::LossModel::kBernoulli;
    out.loss.loss = std::max(out.loss.loss, share);
  };
  switch (window.kind) {
    case FaultKind::kLoss:
      if (window.word % 3 != (forward ? 1U : 2U)) lose(0.1 + 0.8 * window.strength);
      break;
    case FaultKind::kReorder:
      out.order = netem::Order::kReorder;
      out.reorder = 0.05 + 0.45 * window.strength;
      out.reorder_gap = 1 + static_cast<int>(window.word % 8);
      break;
    case FaultKind::kDuplicate:
      out.duplicate = 0.05 + 0.95 * window.strength;
      break;
    case FaultKind::kCorrupt:
      out.corrupt = 0.05 + 0.75 * window.strength;
      break;
    case FaultKind::kDelay:
      out.delay.delay_s += 0.05 + (kLongestDelay_s - 0.05) * window.strength * window.strength;
      break;
    case FaultKind::kOutageForward:
      if (forward) lose(1.0);
      break;
    case FaultKind::kOutageBackward:
      if (!forward) lose(1.0);
      break;
    case FaultKind::kOutage:
      lose(1.0);
      break;
    default:
      break;
  }
}

}  // namespace

std::vector<FaultKind> drawn_kinds(std::uint64_t seed) {
  Draw draw(seed_of(seed, 1000));
  const double share = draw.between(0.05, 0.3);
  std::vector<FaultKind> kinds;
  for (const auto& row : kFaultRows) {
    if (draw.between(0.0, 1.0) < share) kinds.push_back(row.value);
  }
  if (kinds.empty()) kinds.push_back(draw.one_of(kFaultRows).value);
  return kinds;
}

Schedule draw_schedule(std::uint64_t seed, const std::vector<FaultKind>& kinds, double until_s) {
  Schedule schedule;
  Draw draw(seed_of(seed, 1001));
  schedule.rtt_s = draw.factor(0.002, 0.15);
  schedule.jitter_s = draw.between(0.0, 0.05) * schedule.rtt_s;
  schedule.kinds = kinds;
  for (const FaultKind kind : kinds) add_windows(kind, seed, until_s, schedule.windows);
  for (FaultWindow& window : schedule.windows) window.to_s = std::min(window.to_s, until_s);
  std::stable_sort(schedule.windows.begin(), schedule.windows.end(),
                   [](const FaultWindow& a, const FaultWindow& b) { return a.from_s < b.from_s; });
  return schedule;
}

netem::DirectionProfile link_profile(const Schedule& schedule, bool forward) {
  netem::Conditions base;
  base.delay.distribution =
      schedule.jitter_s > 0.0 ? netem::DelayDistribution::kNormal : netem::DelayDistribution::kConstant;
  base.delay.delay_s = 0.5 * schedule.rtt_s;
  base.delay.jitter_s = schedule.jitter_s;
  std::vector<double> edges{0.0};
  for (const FaultWindow& window : schedule.windows) {
    if (window.kind > FaultKind::kOutage) continue;
    edges.push_back(window.from_s);
    edges.push_back(window.to_s);
  }
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  netem::DirectionProfile profile;
  profile.stages.clear();
  for (const double from_s : edges) {
    netem::Stage stage{.from_s = from_s, .conditions = base};
    for (const FaultWindow& window : schedule.windows) {
      if (window.holds(from_s)) impose(window, forward, stage.conditions);
    }
    profile.stages.push_back(stage);
  }
  return profile;
}

}  // namespace telekerf::experiments
