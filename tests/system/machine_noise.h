// SPDX-License-Identifier: Apache-2.0
// What real processes may be held to on the machine that they ran on.
#pragma once

#include <algorithm>
#include <nlohmann/json.hpp>

namespace telekerf::integration {

/// Of a control loop: 1 on a quiet machine; 10 where other work took more than 2 % of its time, or kept more than 2 % of the
/// readings of a drive in another process from it. The tight figures of such runs are held in virtual time.
inline double slack_of_loop(double rate_hz, double wanted_hz, double missed_share) {
  return rate_hz >= 0.98 * wanted_hz && missed_share <= 0.02 ? 1.0 : 10.0;
}

/// How much wider than on a quiet machine a run's bounds are. `report`: report.json of a run at 1 kHz.
inline double slack_of(const nlohmann::json& report) {
  const double steps = std::max(1.0, report.at("tracking").value("samples", 0.0));
  double slack = 1.0;
  for (const char* const side : {"master", "slave"}) {
    const nlohmann::json& loop = report.at("loop").at(side);
    slack = std::max(slack, slack_of_loop(loop.at("rate_hz").get<double>(), 1000.0,
                                          loop.at("readings_missed").get<double>() / steps));
  }
  return slack;
}

/// `timing`: timing.json of automatic machining at 2.4 kHz.
inline double slack_of_machining(const nlohmann::json& timing) {
  const double rate_hz = timing.at("rate_hz").get<double>();
  const double steps = std::max(1.0, rate_hz * timing.at("time_s").get<double>());
  return slack_of_loop(rate_hz, 2400.0, timing.at("readings_missed").get<double>() / steps);
}

}  // namespace telekerf::integration
