// SPDX-License-Identifier: Apache-2.0
// Two stations and the network between them need no more memory the longer they run. TELEKERF_FLAT_S:
// simulated seconds; ./telekerf check takes an hour.
#include <gtest/gtest.h>
#include <malloc.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "tests/unit/simulation/two_stations.h"

namespace telekerf::simulation {
namespace {

constexpr double kMiB = 1024.0 * 1024.0;

double heap_bytes() {
  const auto info = mallinfo2();
  return static_cast<double>(info.uordblks + info.hblkhd);
}

double wanted_s() {
  const char* const said = std::getenv("TELEKERF_FLAT_S");  // NOLINT
  return said == nullptr ? 12.0 : std::stod(said);
}

TEST(Memory, IsFlatHoweverLongBothSitesWork) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "a sanitizer has an allocator of its own";
#endif
  SimulationSettings settings;
  settings.network.forward.stages.front().conditions.delay.delay_s = 0.02;
  settings.network.forward.stages.front().conditions.loss = {.model = netem::LossModel::kBernoulli,
                                                             .loss = 0.02};
  settings.network.backward = settings.network.forward;
  settings.master.record_s = settings.slave.record_s = 1.0;
  TwoStations both(settings);
  const double whole_s = wanted_s();
  const auto steps = static_cast<std::int64_t>(whole_s * 1e3);
  // What is in use goes up and down by half a MiB within seconds (blocks under way, prepared curves): the
  // means of the second quarter and of the last are held against each other.
  double before = 0.0, after = 0.0, least = 1e18, most = 0.0;
  const std::int64_t every = std::max<std::int64_t>(1, steps / 4000), quarter = steps / 4;
  int lit = 0;
  for (std::int64_t n = 0; n < steps; ++n) {
    lit += both.step(n).lit ? 1 : 0;
    if (n < quarter || n % every != 0) continue;
    const double now = heap_bytes(), share = static_cast<double>(every) / static_cast<double>(quarter);
    if (n < 2 * quarter) before += share * now;
    if (n >= 3 * quarter) after += share * now;
    least = std::min(least, now);
    most = std::max(most, now);
  }
  std::printf("%.0f s simulated: %.3f MiB in use, later %+.3f MiB, all the time within %.3f MiB\n", whole_s,
              before / kMiB, (after - before) / kMiB, (most - least) / kMiB);
  EXPECT_GT(lit, 1000);
  EXPECT_LT(std::abs(after - before), kMiB);
  EXPECT_LT(most - least, 4.0 * kMiB);
}

}  // namespace
}  // namespace telekerf::simulation
