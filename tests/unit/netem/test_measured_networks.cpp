// SPDX-License-Identifier: Apache-2.0
// Shipped profiles against the figures of the studies that they cite, each within 10 %, or within the range
// that the study gives.
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/unit/netem/round_trips.h"

namespace telekerf::netem {
namespace {

void within_a_tenth(double measured, double cited, const char* what) {
  EXPECT_NEAR(measured, cited, 0.1 * cited) << what;
}

// At the rate of a ping, of the command stream and of a stream without blocks.
constexpr double kRates_hz[] = {1.0, 62.5, 1000.0};

/// Long enough that the tail is known, short enough for a test.
std::vector<Ping> pings_of(const char* profile, double rate_hz) {
  const double duration_s = rate_hz < 10.0 ? 150'000.0 : rate_hz < 100.0 ? 20'000.0 : 300.0;
  return ping(load_profile(profile), rate_hz, duration_s, 1);
}

TEST(MeasuredNetworks, WifiHasTheTailOfALargeStudy) {
  for (const double rate_hz : kRates_hz) {
    SCOPED_TRACE(rate_hz);
    if (rate_hz > 100.0) continue;  // a test's length holds too few bad times for a tail at 1 kHz
    const auto round_trips = round_trips_ms(pings_of("wifi", rate_hz));
    within_a_tenth(quantile(round_trips, 0.5), 3.0, "median");
    within_a_tenth(quantile(round_trips, 0.9), 20.0, "p90");
    within_a_tenth(quantile(round_trips, 0.99), 250.0, "p99");
  }
}

TEST(MeasuredNetworks, LeoStepsFromSatelliteToSatellite) {
  for (const double rate_hz : kRates_hz) {
    SCOPED_TRACE(rate_hz);
    const auto pings = pings_of("leo", rate_hz);
    const auto round_trips = round_trips_ms(pings);
    if (rate_hz < 100.0) {  // a shorter one meets too few satellites for the quartiles
      within_a_tenth(quantile(round_trips, 0.25), 40.0, "first quartile");
      within_a_tenth(quantile(round_trips, 0.5), 50.0, "median");
      within_a_tenth(quantile(round_trips, 0.75), 60.0, "third quartile");
      within_a_tenth(quantile(round_trips, 0.0), 20.0, "least");
    }
    if (rate_hz == 1.0) within_a_tenth(mean_step_ms(round_trips), 6.7, "from one second to the next");
    const double medians_ms = deviation(window_medians_ms(pings, 15.0, 7.5));
    EXPECT_GE(medians_ms, 10.0) << "from satellite to satellite";
    EXPECT_LE(medians_ms, 16.0);
    EXPECT_GE(lost_share(pings), 0.009);
    EXPECT_LE(lost_share(pings), 0.02);
  }
}

TEST(MeasuredNetworks, LeoCouplesItsHalvesAndItsUplinkTakesMore) {
  // Were they independent, the steps of the two ways would add up as squares.
  const auto pings = pings_of("leo", 1.0);
  std::vector<double> there, back;
  double product = 0.0;
  for (const Ping& p : pings) {
    if (p.round_trip_ms < 0) continue;
    there.push_back(p.forward_ms);
    back.push_back(p.round_trip_ms - p.forward_ms);
  }
  const double there_ms =
      std::accumulate(there.begin(), there.end(), 0.0) / static_cast<double>(there.size());
  const double back_ms = std::accumulate(back.begin(), back.end(), 0.0) / static_cast<double>(back.size());
  for (std::size_t i = 0; i < there.size(); ++i) product += (there[i] - there_ms) * (back[i] - back_ms);
  product /= static_cast<double>(there.size());
  EXPECT_GT(product / (deviation(there) * deviation(back)), 0.6);
  EXPECT_GT(back_ms, there_ms);
  EXPECT_GT(deviation(back), deviation(there));
}

TEST(MeasuredNetworks, FiveGHandsOverAndLosesOnTheWayUpOnly) {
  for (const double rate_hz : kRates_hz) {
    SCOPED_TRACE(rate_hz);
    if (rate_hz < 10.0) continue;  // a handover lasts a tenth of that
    const auto pings = pings_of("5g", rate_hz);
    std::vector<double> down, up;
    std::size_t lost_down = 0;
    double longest_ms = 0.0;
    for (const Ping& p : pings) {
      lost_down += p.forward_ms < 0;
      longest_ms = std::max(longest_ms, p.forward_ms);
      if (p.round_trip_ms < 0) continue;
      down.push_back(p.forward_ms);
      up.push_back(p.round_trip_ms - p.forward_ms);
    }
    EXPECT_EQ(lost_down, 0u);
    EXPECT_GT(lost_share(pings), 0.001);
    EXPECT_GE(quantile(down, 0.01), 7.0) << "less than the best case with a fixed network behind it";
    EXPECT_LE(quantile(up, 0.95), 18.0 + 4.0) << "more than the worst case with a fixed network behind it";
    EXPECT_GT(quantile(up, 0.5), quantile(down, 0.5));
    // The first packet of a handover waits for all of it.
    within_a_tenth(longest_ms - quantile(down, 0.5), 108.0, "handover");
  }
}

}  // namespace
}  // namespace telekerf::netem
