// SPDX-License-Identifier: Apache-2.0
#include "experiments/delay/delay_ideal.h"

#include <algorithm>
#include <cmath>

#include "master/observer/network_observer.h"

namespace telekerf::experiments {
namespace {

using master::KinematicState;

master::ObserverSettings settings_of(master::MakeEstimator estimator, double period_s) {
  master::ObserverSettings settings;
  settings.estimator = estimator;
  settings.period_s = period_s;
  return settings;
}

class IdealLoop {
 public:
  IdealLoop(master::MakeEstimator estimator, int delay, double period_s, const IdealStart& start)
      : observer_(Law::kRemoteAcceleration, settings_of(estimator, period_s)),
        delay_(delay),
        period_s_(period_s),
        disturbance_(start.disturbance_m_per_s2) {
    KinematicState first;
    first.position_m.x() = start.position_m;
    first.velocity_m_per_s.x() = start.velocity_m_per_s;
    truth_.push_back(first);
    observer_.reset(0, KinematicState{});
  }
  /// Predicted for the command of this very step.
  KinematicState predicted() {
    const auto k = static_cast<std::int64_t>(truth_.size()) - 1;
    if (k >= delay_) {
      const KinematicState& then = truth_[static_cast<std::size_t>(k - delay_)];
      const master::SlaveSample sample{k - delay_, k, true, then.position_m, then.velocity_m_per_s};
      observer_.correct(std::span(&sample, 1));
    }
    return observer_.predicted_state(KinematicState{});
  }
  void apply(double u) {
    observer_.predict(static_cast<std::int64_t>(truth_.size()) - 1, KinematicState{}, Vec3(u, 0, 0));
    KinematicState now = truth_.back();
    now.acceleration_m_per_s2 = Vec3(u + disturbance_, 0, 0);
    truth_.push_back(master::advanced(now, period_s_));
  }
  double position_m() const { return truth_.back().position_m.x(); }

 private:
  master::NetworkObserver observer_;
  int delay_;
  double period_s_;
  double disturbance_;
  std::vector<KinematicState> truth_;
};

}  // namespace

std::vector<double> prediction_error(master::MakeEstimator estimator, double delay_s, double duration_s,
                                     const IdealStart& start) {
  constexpr double kPeriod = 1e-3;
  IdealLoop loop(estimator, static_cast<int>(std::lround(delay_s / kPeriod)), kPeriod, start);
  std::vector<double> errors;
  for (double t = 0.0; t < duration_s; t += kPeriod) {
    errors.push_back(std::abs(loop.predicted().position_m.x() - loop.position_m()));
    loop.apply(4.0 * std::cos(20.0 * t));  // 10 mm at 20 rad/s
  }
  return errors;
}

bool law_is_stable(master::MakeEstimator estimator, double w_rad_s, double delay_s) {
  // A hundred samples a delay, whatever it is; eighty delays, or settling times where those are longer.
  constexpr int kDelay = 100;
  const double period_s = delay_s / kDelay;
  IdealLoop loop(estimator, kDelay, period_s, {.position_m = 0.01});
  const int steps = static_cast<int>(kDelay * std::clamp(20.0 / (w_rad_s * delay_s), 80.0, 400.0));
  double early = 0.0;
  double late = 0.0;
  for (int i = 0; i < steps; ++i) {
    const KinematicState seen = loop.predicted();
    loop.apply(-2.0 * w_rad_s * seen.velocity_m_per_s.x() - w_rad_s * w_rad_s * seen.position_m.x());
    const double size = std::abs(loop.position_m());
    if (!(size < 1e6)) return false;
    if (i > steps / 4 && i <= steps / 2) early = std::max(early, size);
    if (i > 3 * steps / 4) late = std::max(late, size);
  }
  return late < early || late < 1e-9;
}

}  // namespace telekerf::experiments
