// SPDX-License-Identifier: Apache-2.0
// Where is the slave now, if its states are an eighth of a second old?
//
// A slave starts 5 mm away from where the observer believes it to be, and something pushes it with 0.2 m/s^2
// all the time. Commands need 125 ms to reach it, measurements 125 ms to come back. You see how far the
// newest measurement is away from the slave, and how far the prediction is: within seconds it has found the
// start and the push.
#include <fmt/format.h>

#include <cmath>
#include <vector>

#include "master/observer/network_observer.h"

int main() {
  using namespace telekerf;
  using control::KinematicState;
  const std::int64_t way = 125;  // ticks of a millisecond
  const double period_s = 1e-3;
  const Vec3 push(0.2, 0.0, 0.0);
  master::ObserverSettings settings;  // its estimator: the predictor
  settings.period_s = period_s;
  master::NetworkObserver observer(Law::kRemoteAcceleration, settings);
  KinematicState slave{.position_m = Vec3(5e-3, 0.0, 0.0)};
  KinematicState model;  // what the commands alone would do
  observer.reset(0, model);

  std::vector<Vec3> commands, predictions_m;
  std::vector<master::SlaveSample> samples;  // what the slave measures as it obeys command i
  double error_m = 0.0;
  for (std::int64_t tick = 0; tick < 8000; ++tick) {
    const KinematicState now = observer.predicted_state(model);
    predictions_m.push_back(now.position_m);
    const Vec3 wish(0.3 * std::sin(3e-3 * static_cast<double>(tick)),
                    0.3 * std::cos(2e-3 * static_cast<double>(tick)), 0.0);
    commands.push_back(wish - 4.0 * now.velocity_m_per_s - 4.0 * now.position_m);
    observer.predict(tick, model, commands.back());
    model.acceleration_m_per_s2 = commands.back();
    model = advanced(model, period_s);

    const std::int64_t obeyed = tick - way;  // the command that arrives now
    if (obeyed < 0) continue;
    const auto i = static_cast<std::size_t>(obeyed);
    error_m = (predictions_m[i] - slave.position_m).norm();
    samples.push_back({obeyed, tick, true, slave.position_m, slave.velocity_m_per_s});
    slave.acceleration_m_per_s2 = commands[i] + push;
    slave = advanced(slave, period_s);
    if (obeyed < way) continue;
    const master::SlaveSample& arrived = samples[i - static_cast<std::size_t>(way)];
    observer.correct({&arrived, 1});
    if ((tick + 1) % 1000 == 0) {
      fmt::print("{} s: newest measurement {:5.2f} mm away, prediction {:8.4f} mm\n", (tick + 1) / 1000,
                 1e3 * (slave.position_m - arrived.position_m).norm(), 1e3 * error_m);
    }
  }
  fmt::print("push that the observer believes in: {:.3f} m/s^2\n", observer.disturbance_m_per_s2().x());
  return error_m < 10e-6 ? 0 : 1;
}
