// SPDX-License-Identifier: Apache-2.0
#include "experiments/haptics/port_trial.h"

#include <algorithm>
#include <cmath>

#include "experiments/draw.h"
#include "master/haptics/energy_tank.h"

namespace telekerf::experiments {
namespace {

constexpr double kDt_s = 1e-3;
constexpr int kSteps = 4000;
constexpr double kMost_n = 8.0;

/// Speeds that arrive late: kept by the step at which they come.
class LateCopy {
 public:
  LateCopy(Draw& draw, double first) : draw_(draw), known_(first), coming_(kSteps + 1, NAN) {
    rtt_s_ = draw.between(0.0, 0.5);
    jitter_s_ = draw.between(0.0, 0.08);
    loss_ = draw.between(0.0, 0.3);
  }
  double step(int k, double speed) {
    if (draw_.between(0.0, 1.0) > loss_) {
      const double at_s = k * kDt_s + std::max(0.0, rtt_s_ + jitter_s_ * draw_.between(-1.7, 1.7));
      const auto at = static_cast<std::size_t>(at_s / kDt_s);
      if (at < coming_.size()) coming_[at] = speed;
    }
    const double news = coming_[static_cast<std::size_t>(k)];
    if (std::isfinite(news)) known_ = news;
    return known_;
  }

 private:
  Draw& draw_;
  double known_;
  std::vector<double> coming_;
  double rtt_s_ = 0.0, jitter_s_ = 0.0, loss_ = 0.0;
};

struct OneRun {
  double most_j = 0.0;
  double fastest_m_per_s = 0.0;
  double felt_share = 0.0;
};

OneRun run_one(PortLaw law, bool adversary, std::uint64_t seed) {
  Draw draw(seed);
  const double mass = draw.between(0.3, 4.0) + draw.between(0.0, 1.5), drag = draw.between(0.0, 8.0);
  const double stiffness = draw.between(0.0, 400.0), damping = draw.between(0.0, 15.0);
  const double gain = draw.factor(5.0, 3000.0), wish = draw.between(2e-3, 30e-3);
  LateCopy copy(draw, wish);
  const master::EnergyTankSettings settings;
  master::EnergyTank tank(settings);
  const double mobility = 0.5 * kDt_s / mass;
  double v = 0.0, x = 0.0, goal = 0.0, cut = wish, given_j = 0.0, wished_n = 0.0, felt_n = 0.0;
  OneRun out;
  for (int k = 0; k < kSteps; ++k) {
    cut += kDt_s / 0.02 * (v - cut);
    double wished = gain * (wish - copy.step(k, cut));
    if (adversary) wished = std::copysign(kMost_n, v) * (draw.between(0.0, 1.0) < 0.9 ? 1.0 : -1.0);
    wished = std::clamp(wished, -kMost_n, kMost_n);
    goal += (0.6 + 0.4 * std::sin(2.0 * k * kDt_s)) * wish * kDt_s;
    const double hand = stiffness * (goal - x) - damping * v + draw.between(-0.5, 0.5);
    const double free = v + mobility * (hand - drag * v);
    double force = wished;
    if (law == PortLaw::kObserver && given_j > settings.initial_j && wished * v > 0.0 && v * v > 1e-12)
      force = std::clamp(wished - (given_j - settings.initial_j) / (kDt_s * v * v) * v, -4.0 * kMost_n,
                         4.0 * kMost_n);
    if (law == PortLaw::kTank) force *= tank.share(wished, free, mobility, kDt_s);
    const double mean = free + mobility * force;
    const double drag_j = std::max(0.0, drag * v * mean * kDt_s);
    if (law == PortLaw::kTank && !tank.pay(force, mean, drag_j, kDt_s)) given_j = INFINITY;  // cannot be
    given_j += force * mean * kDt_s - drag_j;
    v = 2.0 * mean - v;
    x += mean * kDt_s;
    out.most_j = std::max(out.most_j, given_j);
    out.fastest_m_per_s = std::max(out.fastest_m_per_s, std::abs(v));
    wished_n += std::abs(wished);
    felt_n += std::abs(force);
  }
  out.felt_share = wished_n > 0.0 ? felt_n / wished_n : 1.0;
  return out;
}

}  // namespace

PortResult run_port(PortLaw law, bool adversary, int runs, std::uint64_t seed) {
  // Sums of some thousand steps; a port that gives more gives millijoules.
  constexpr double kRounding_j = 1e-12;
  const double start_j = master::EnergyTankSettings{}.initial_j;
  PortResult out{.law = law, .adversary = adversary, .worst_j = -start_j, .given_j = {}};
  for (int i = 0; i < runs; ++i) {
    const OneRun one = run_one(law, adversary, seed + static_cast<std::uint64_t>(i));
    out.above += one.most_j > start_j + kRounding_j ? 1 : 0;
    out.worst_j = std::max(out.worst_j, one.most_j - start_j);
    out.fastest_m_per_s = std::max(out.fastest_m_per_s, one.fastest_m_per_s);
    out.felt_share += one.felt_share / runs;
    out.given_j.push_back(one.most_j);
  }
  std::sort(out.given_j.begin(), out.given_j.end());
  return out;
}

std::string word_of(PortLaw law) {
  switch (law) {
    case PortLaw::kNone:
      return "none";
    case PortLaw::kObserver:
      return "observer-controller";
    case PortLaw::kTank:
      return "tank";
  }
  return "";
}

}  // namespace telekerf::experiments
