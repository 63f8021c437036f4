// SPDX-License-Identifier: Apache-2.0
// verify: silent on everything that is right, over many seeds and laws; loud on everything that is wrong.
#include "netem/verify/verify.h"

#include <gtest/gtest.h>

#include <string>

#include "common/runtime/resources.h"
#include "netem/verify/bounds.h"

namespace telekerf::netem {
namespace {

std::string complaints(const std::vector<StageReport>& reports) {
  std::string text;
  for (const auto& report : reports) {
    for (const auto& check : report.checks) {
      if (check.good()) continue;
      text += check.name + " " + std::to_string(check.measured) + " not in [" + std::to_string(check.low) +
              ", " + std::to_string(check.high) + "]\n";
    }
  }
  return text;
}

DirectionProfile of(const std::string& keys) { return parse_profile("[both]\n" + keys, "test").forward; }

TEST(Verify, ShippedProfilesRaiseNoFalseAlarm) {
  for (const auto& name : shipped_names("profiles", ".toml")) {
    const Profile profile = load_profile(name);
    for (const auto& [packets, seeds] : {std::pair{200'000, 1}, {2'000, 5}, {100, 10}}) {
      for (int seed = 1; seed <= seeds; ++seed) {
        Traffic traffic;
        traffic.packets = packets;
        traffic.seed = seed;
        EXPECT_EQ(complaints(verify(profile, traffic)), "")
            << name << " packets " << packets << " seed " << seed;
      }
    }
  }
}

class RightLaw : public testing::TestWithParam<const char*> {};
TEST_P(RightLaw, RaisesNoFalseAlarm) {
  const DirectionProfile profile = of(GetParam());
  for (const auto& [packets, seeds] : {std::pair{150'000, 1}, {3'000, 8}}) {
    for (int seed = 1; seed <= seeds; ++seed) {
      Traffic traffic;
      traffic.packets = packets;
      traffic.seed = seed;
      EXPECT_EQ(complaints(verify_direction(profile, profile, Direction::kForward, traffic)), "")
          << "seed " << seed;
    }
  }
}
INSTANTIATE_TEST_SUITE_P(
    Verify, RightLaw,
    testing::Values(
        "delay_ms = 20\njitter_ms = 5\ndistribution = \"uniform\"\ncorrelation_ms = 9.49122",
        "delay_ms = 2\njitter_ms = 5\ndistribution = \"laplace\"\ncorrelation_ms = 1.442695\norder = "
        "\"free\"",
        "delay_ms = 0\njitter_ms = 5\ndistribution = \"normal\"\norder = \"free\"",
        "delay_ms = 20\njitter_ms = 5\ndistribution = \"gamma\"\nshape = 0.3\ncorrelation_ms = 99.4992",
        "delay_ms = 20\njitter_ms = 5\ndistribution = \"lognormal\"\nshape = 2\norder = "
        "\"free\"\ncorrelation_ms = 9.49122",
        "delay_ms = 7\njitter_ms = 0.05\ndistribution = \"lognormal\"\nshape = 3\ncorrelation_ms = 99.4992",
        "delay_ms = 20\njitter_ms = 5\ndistribution = \"pareto\"\nshape = 2.1\norder = \"free\"",
        "delay_ms = 20\njitter_ms = 5\ndistribution = \"pareto\"\nshape = 3\ncorrelation_ms = 2.803673",
        "delay_ms = 20\ndistribution = \"table\"\ntable_p = [0, 0.5, 1]\ntable_ms = [0, 0, 10]",
        "delay_ms = 20\ndistribution = \"table\"\ntable_p = [0, 0.7, 0.7001, 1]\ntable_ms = [1, 2, 40, "
        "41]\norder = "
        "\"free\"",
        "delay_ms = 20\norder = \"reorder\"\nreorder = 0.2\nreorder_gap = 4",
        "delay_ms = 20\norder = \"reorder\"\nreorder = 1.0\nloss_model = \"gilbert-elliott\"\nloss = 0.3\n"
        "loss_burst_packets = 50",
        "loss_model = \"gilbert-elliott\"\nloss = 0.02\nloss_burst_packets = 50",
        "loss_model = \"gilbert-elliott\"\nloss = 0.001\nloss_burst_packets = 1",
        "loss_model = \"gilbert-elliott\"\nge_p = 0.01\nge_r = 0.05\nge_h = 0.4\nge_k = 0.99",
        "loss_model = \"gilbert-elliott\"\nge_p = 0.9\nge_r = 0.8",
        "loss_model = \"four-state\"\np13 = 0.01\np31 = 0.2\np32 = 0.3\np23 = 0.5\np14 = 0.005", "loss = 0.9",
        "loss = 1.0", "delay_ms = 20\nloss = 0.05\ntcp_like = true\nrto_ms = 100",
        "delay_ms = 20\nrate_kbit_per_s = 1000\nqueue_bytes = 20000",
        "delay_ms = 20\nrate_kbit_per_s = 1500\nqueue_bytes = 64",
        "delay_ms = 20\nrate_kbit_per_s = 100\nqueue_bytes = 5000\nloss = 0.1\ntcp_like = true",
        "delay_ms = 20\nrate_kbit_per_s = 5000\nqueue_bytes = 3000\nduplicate = 0.5\ncorrupt = 0.5",
        "delay_ms = 20\njitter_ms = 2\ndistribution = \"normal\"\nslot_ms = 5\nslot_jitter_ms = "
        "2\nslot_packets = 8"));

struct Wrong {
  const char* nominal;
  const char* emulated;
  const char* named;  ///< the check that must complain
};
class WrongLaw : public testing::TestWithParam<Wrong> {};
TEST_P(WrongLaw, IsFound) {
  Traffic traffic;
  traffic.packets = 300'000;
  const auto reports =
      verify_direction(of(GetParam().nominal), of(GetParam().emulated), Direction::kForward, traffic);
  EXPECT_NE(complaints(reports).find(GetParam().named), std::string::npos) << complaints(reports);
}
#define NORMAL "jitter_ms = 10\ndistribution = \"normal\"\n"
INSTANTIATE_TEST_SUITE_P(
    Verify, WrongLaw,
    testing::Values(
        Wrong{"delay_ms = 50", "delay_ms = 50.001", "delay"},
        Wrong{"delay_ms = 50\n" NORMAL, "delay_ms = 50.2\n" NORMAL, "delay mean"},
        Wrong{"delay_ms = 50\n" NORMAL, "delay_ms = 50\njitter_ms = 10.3\ndistribution = \"normal\"",
              "delay sd"},
        Wrong{"delay_ms = 50\n" NORMAL, "delay_ms = 50\njitter_ms = 10\ndistribution = \"laplace\"",
              "delay p99"},
        Wrong{"delay_ms = 50\n" NORMAL "correlation_ms = 0.830584",
              "delay_ms = 50\n" NORMAL "correlation_ms = 0.721348", "lag-1 correlation"},
        Wrong{"delay_ms = 50\n" NORMAL, "delay_ms = 50\n" NORMAL "order = \"free\"", "out of order"},
        Wrong{"delay_ms = 50\n" NORMAL "order = \"free\"",
              "delay_ms = 50\n" NORMAL "order = \"free\"\ncorrelation_ms = 1.442695",
              "overtakes predecessor"},
        Wrong{"loss = 0.01", "loss = 0.012", "loss"},
        Wrong{"loss_model = \"gilbert-elliott\"\nloss = 0.1\nloss_burst_packets = 8", "loss = 0.1",
              "mean burst"},
        Wrong{"loss_model = \"gilbert-elliott\"\nloss = 0.1\nloss_burst_packets = 8",
              "loss_model = \"gilbert-elliott\"\nloss = 0.1\nloss_burst_packets = 6.5", "mean burst"},
        Wrong{"delay_ms = 1", "delay_ms = 1\nloss = 0.00005", "lost by the model"},
        Wrong{"duplicate = 0.02", "duplicate = 0.025", "duplicated"},
        Wrong{"delay_ms = 1", "corrupt = 0.0001", "corrupted"},
        Wrong{"delay_ms = 20\norder = \"reorder\"\nreorder = 0.1",
              "delay_ms = 20\norder = \"reorder\"\nreorder = 0.12", "chosen to overtake"},
        Wrong{"rate_kbit_per_s = 1000\nqueue_bytes = 9000", "rate_kbit_per_s = 1050\nqueue_bytes = 9000",
              "rate"},
        Wrong{"rate_kbit_per_s = 1000\nqueue_bytes = 9000", "rate_kbit_per_s = 1000\nqueue_bytes = 8500",
              "longest stay in the queue"},
        Wrong{"slot_ms = 5", "slot_ms = 4", "outside the slots"},
        Wrong{"[[event]]\nevery_s = 2\nduration_ms = 100\nloss = 0.5",
              "[[event]]\nevery_s = 2\nduration_ms = 100\nloss = 0.6", "event 0 loss"},
        Wrong{"[[event]]\nevery_s = 2\nduration_ms = 100\nloss = 0.5",
              "[[event]]\nevery_s = 2\nduration_ms = 120\nloss = 0.5", "touched outside"}));

TEST(Bounds, ChainMemoryIsTheSecondEigenvalue) {
  LossParameters law;
  law.model = LossModel::kGilbertElliott;
  law.ge_p = 0.02;
  law.ge_r = 0.1;
  EXPECT_NEAR(chain_memory(loss_chain(law)), 0.88, 1e-12);
  // A 4-state chain that never leaves states 1 and 3 is a 2-state chain.
  law.model = LossModel::kFourState;
  law.p13 = 0.02;
  law.p31 = 0.1;
  EXPECT_NEAR(chain_memory(loss_chain(law)), 0.88, 1e-6);
}

TEST(Bounds, BurstVarianceOfIndependentBurstsIsTheirRenewalVariance) {
  LossParameters law;
  law.model = LossModel::kGilbertElliott;
  law.ge_r = 0.125;
  law.ge_p = 0.0138888888888888;
  // Bursts begin at rate loss / burst; their geometric lengths have variance burst (burst - 1).
  EXPECT_NEAR(burst_variance(loss_chain(law)), 0.1 / 8 * 8 * 7, 1e-6);
}

}  // namespace
}  // namespace telekerf::netem
