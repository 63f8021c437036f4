// SPDX-License-Identifier: Apache-2.0
// What real processes may be held to on the machine that they ran on.
#pragma once

#include <algorithm>
#include <nlohmann/json.hpp>

namespace telekerf::integration {

/// How much wider than on a quiet machine a run's bounds are: 1, or 10 where other work took more than 2 % of
/// the time of either control loop. The tight figures of such runs are held in virtual time.
/// `report`: report.json of a run at 1 kHz.
inline double slack_of(const nlohmann::json& report) {
  double slowest_hz = 1000.0;
  for (const char* const side : {"master", "slave"})
    slowest_hz = std::min(slowest_hz, report.at("loop").at(side).at("rate_hz").get<double>());
  return slowest_hz >= 980.0 ? 1.0 : 10.0;
}

}  // namespace telekerf::integration
