// SPDX-License-Identifier: Apache-2.0
// Profiles: every shipped one loads; every kind of nonsense is refused in a sentence that names the key.
#include "netem/core/profile.h"

#include <gtest/gtest.h>

#include <string>

#include "common/runtime/resources.h"
#include "common/runtime/startup_error.h"

namespace telekerf::netem {
namespace {

TEST(Profile, EveryShippedOneLoadsAndNamesItsSource) {
  const auto names = shipped_names("profiles", ".toml");
  ASSERT_GE(names.size(), 3U);
  for (const auto& name : names) {
    SCOPED_TRACE(name);
    const Profile profile = load_profile(name);
    EXPECT_EQ(profile.name, name);
    EXPECT_FALSE(profile.source.empty());
    EXPECT_FALSE(profile.description.empty());
  }
}

TEST(Profile, DirectionsAndStagesOverrideWhatIsCommon) {
  const Profile profile = parse_profile(R"(
[both]
delay_ms = 10
loss = 0.01
[backward]
delay_ms = 30
[[stage]]
from_s = 5
[stage.both]
delay_ms = 70
[stage.forward]
loss = 0.5
)",
                                        "test");
  EXPECT_DOUBLE_EQ(profile.forward.stages[0].conditions.delay.delay_s, 0.010);
  EXPECT_DOUBLE_EQ(profile.backward.stages[0].conditions.delay.delay_s, 0.030);
  EXPECT_DOUBLE_EQ(profile.backward.stages[0].conditions.loss.loss, 0.01);
  ASSERT_EQ(profile.forward.stages.size(), 2U);
  EXPECT_DOUBLE_EQ(profile.forward.stages[1].conditions.delay.delay_s, 0.070);
  EXPECT_DOUBLE_EQ(profile.forward.stages[1].conditions.loss.loss, 0.5);
  EXPECT_DOUBLE_EQ(profile.backward.stages[1].conditions.loss.loss, 0.01);
}

TEST(Profile, AStageKeepsWhatItDoesNotName) {
  const auto stages = parse_profile(R"(
[both]
delay_ms = 10
distribution = "normal"
jitter_ms = 2
correlation_ms = 5
loss_model = "gilbert-elliott"
loss = 0.1
loss_burst_packets = 4
rate_kbit_per_s = 100
queue_bytes = 1000
[[stage]]
from_s = 5
[stage.both]
distribution = "constant"
delay_ms = 70
[[stage]]
from_s = 9
[stage.forward]
loss_model = "gilbert-elliott"
ge_p = 0.2
ge_r = 0.6
rate_kbit_per_s = 0
)",
                                    "test")
                          .forward.stages;
  ASSERT_EQ(stages.size(), 3U);
  EXPECT_DOUBLE_EQ(stages[1].conditions.delay.delay_s, 0.070);
  EXPECT_EQ(stages[1].conditions.delay.jitter_s, 0.0);
  EXPECT_DOUBLE_EQ(stages[1].conditions.loss.ge_r, 0.25);
  EXPECT_DOUBLE_EQ(stages[2].conditions.delay.delay_s, 0.070);
  EXPECT_DOUBLE_EQ(stages[2].conditions.loss.ge_p, 0.2);
  EXPECT_DOUBLE_EQ(stages[2].conditions.loss.ge_r, 0.6);
  EXPECT_DOUBLE_EQ(stages[1].conditions.rate_bit_per_s, 100e3);
  EXPECT_EQ(stages[2].conditions.rate_bit_per_s, 0.0);
  EXPECT_EQ(stages[2].conditions.queue_bytes, 0);
}

TEST(Profile, MeanLossAndBurstBecomeGilbertElliott) {
  const auto law =
      parse_profile("[both]\nloss_model = \"gilbert-elliott\"\nloss = 0.1\nloss_burst_packets = 8", "test")
          .forward.stages[0]
          .conditions.loss;
  EXPECT_DOUBLE_EQ(law.ge_r, 0.125);
  EXPECT_DOUBLE_EQ(law.ge_p / (law.ge_p + law.ge_r), 0.1);
}

struct Nonsense {
  const char* text;
  const char* named;  ///< must stand in the message
};
class NonsenseProfile : public testing::TestWithParam<Nonsense> {};

TEST_P(NonsenseProfile, IsRefusedByName) {
  try {
    parse_profile(GetParam().text, "test");
    FAIL() << "accepted: " << GetParam().text;
  } catch (const StartupError& refusal) {
    EXPECT_NE(std::string(refusal.what()).find(GetParam().named), std::string::npos) << refusal.what();
  }
}

INSTANTIATE_TEST_SUITE_P(
    Profile, NonsenseProfile,
    testing::Values(
        Nonsense{"", "[forward]"}, Nonsense{"[forward]\ndelay_ms = 1", "[backward]"},
        Nonsense{"[both]\ndelay_ms = -1", "delay_ms"}, Nonsense{"[both]\ndelay = 1", "delay"},
        Nonsense{"[both]\ndelay_ms = \"x\"", "delay_ms"}, Nonsense{"[both]\ndelay_ms = nan", "delay_ms"},
        Nonsense{"[both]\nloss = 1.5", "loss"}, Nonsense{"[both]\nloss = -0.1", "loss"},
        Nonsense{"[both]\njitter_ms = 5", "distribution"},
        Nonsense{"[both]\ndistribution = \"normal\"", "jitter_ms"},
        Nonsense{"[both]\ndistribution = \"cauchy\"", "distribution"},
        Nonsense{"[both]\ndistribution = \"gamma\"\njitter_ms = 1", "shape"},
        Nonsense{"[both]\ndistribution = \"pareto\"\njitter_ms = 1\nshape = 2", "shape"},
        Nonsense{"[both]\ndistribution = \"normal\"\njitter_ms = 1\nshape = 2", "shape"},
        Nonsense{"[both]\ncorrelation_ms = 1.442695", "correlation"},
        Nonsense{"[both]\ndistribution = \"normal\"\njitter_ms = 1\ncorrelation = 0.5",
                 "is correlation_ms now"},
        Nonsense{
            "[both]\nloss_model = \"gilbert-elliott\"\nloss = 0.1\nloss_burst_ms = 5\nloss_burst_packets = 2",
            "either loss_burst_ms or loss_burst_packets"},
        Nonsense{"[both]\nloss_model = \"gilbert-elliott\"\nloss_burst_ms = 5", "loss"},
        Nonsense{"[both]\nloss_model = \"gilbert-elliott\"\nloss = 1\nloss_burst_ms = 5", "never ends"},
        Nonsense{"[both]\nloss_model = \"gilbert-elliott\"\nloss = 0.1\nloss_burst_ms = 5\nge_p = 0.1",
                 "ge_p"},
        Nonsense{"[both]\nloss = 0.1\nloss_burst_ms = 5", "belongs to loss_model"},
        Nonsense{"[both]\nrate_trace = \"nowhere.up\"\nqueue_bytes = 9000", "nowhere.up"},
        Nonsense{"[both]\nrate_trace = \"nowhere.up\"", "queue_bytes"},
        Nonsense{"[both]\nrate_trace = \"\"\nqueue_bytes = 9000", "both.rate_trace"},
        Nonsense{"[both]\nrate_trace = \"nowhere.up\"\nqueue_bytes = 9000\nrate_kbit_per_s = 9",
                 "already says the rate"},
        Nonsense{"[both]\ntrace_end = \"repeat\"", "trace_end"},
        Nonsense{"[both]\n[[event]]\nduration_ms = 20\nhold = true\nadd_delay_ms = [0, 5]", "add_delay_ms"},
        Nonsense{"[both]\n[[event]]\nduration_ms = 20\nadd_delay_ms = [0, 5]\ncoupled = \"\"", "coupled"},
        Nonsense{"[both]\n[[event]]\nduration_ms = 20\nloss = 1\ncoupled = \"sky\"", "coupled"},
        Nonsense{"[both]\ndistribution = \"table\"\ntable_p = [0, 1]\ntable_ms = [2, 1]", "descend"},
        Nonsense{"[both]\ndistribution = \"table\"\ntable_p = [0, 0.5]\ntable_ms = [1, 2]", "table_p"},
        Nonsense{"[both]\ntable_p = [0, 1]", "table_p"}, Nonsense{"[both]\norder = \"sorted\"", "order"},
        Nonsense{"[both]\norder = \"reorder\"", "reorder"}, Nonsense{"[both]\nreorder = 0.1", "reorder"},
        Nonsense{"[both]\norder = \"free\"\ntcp_like = true", "order"},
        Nonsense{"[both]\nduplicate = 0.1\ntcp_like = true", "duplicate"},
        Nonsense{"[both]\nrto_ms = 100", "rto_ms"},
        Nonsense{"[both]\nloss_model = \"gilbert-elliott\"\nloss = 0.1", "loss"},
        Nonsense{"[both]\nloss_model = \"gilbert-elliott\"\nloss = 0.1\nloss_burst_packets = 2\nge_p = 0.1",
                 "ge_p"},
        Nonsense{"[both]\nloss_model = \"gilbert-elliott\"\nloss = 0.8\nloss_burst_packets = 1", "loss"},
        Nonsense{"[both]\nloss = 0.1\nge_p = 0.1", "ge_p"},
        Nonsense{"[both]\nloss_model = \"four-state\"\np13 = 0.6\np14 = 0.6", "p13"},
        Nonsense{"[both]\nloss_model = \"four-state\"\nloss = 0.1", "loss"},
        Nonsense{"[both]\nloss_model = \"trace\"", "loss_trace"},
        Nonsense{"[both]\nloss_model = \"trace\"\nloss_trace = \"nowhere.csv\"", "nowhere.csv"},
        Nonsense{"[both]\ntrace = \"nowhere.csv\"", "nowhere.csv"},
        Nonsense{"[both]\ntrace = \"nowhere.csv\"\ndelay_ms = 1", "delay_ms"},
        Nonsense{"[both]\ntrace = \"\"", "both.trace"},
        Nonsense{"[both]\nrate_kbit_per_s = 0.5\nqueue_bytes = 1000", "rate_kbit_per_s"},
        Nonsense{"[both]\nrate_kbit_per_s = 100", "queue_bytes"},
        Nonsense{"[both]\nqueue_bytes = 1000", "rate_kbit_per_s"},
        Nonsense{"[both]\nslot_packets = 3", "slot_ms"},
        Nonsense{"[both]\nslot_ms = 3\nslot_jitter_ms = 4", "slot_jitter_ms"},
        Nonsense{"[both]\nslot_ms = 3\norder = \"free\"", "slot_ms"},
        Nonsense{"[both]\n[[stage]]\nfrom_s = 0", "from_s"},
        Nonsense{"[both]\n[[stage]]\ndelay_ms = 1", "from_s"},
        Nonsense{"[both]\n[[stage]]\nfrom_s = 1\n[stage.bothe]\ndelay_ms = 1", "bothe"},
        Nonsense{"[both]\n[[event]]\nevery_s = 1\nduration_ms = 2000\nloss = 1", "duration_ms"},
        Nonsense{"[both]\n[[event]]\nevery_s = 1\nduration_ms = 20", "loss"},
        Nonsense{"[both]\n[[event]]\nduration_ms = 20\nadd_delay_ms = [5, 1]", "add_delay_ms"},
        Nonsense{"[both]\ndelay_ms = ", "line 2"}));

TEST(Profile, AnUnknownNameIsRefusedWithTheShippedOnes) {
  try {
    load_profile("no-such-network");
    FAIL();
  } catch (const StartupError& refusal) {
    EXPECT_NE(std::string(refusal.what()).find("thesis-constant"), std::string::npos) << refusal.what();
  }
}

TEST(Profile, SimpleProfileSplitsTheRoundTrip) {
  const Profile profile = simple_profile(0.2, 0.02, 0.01);
  EXPECT_DOUBLE_EQ(profile.forward.stages[0].conditions.delay.delay_s, 0.1);
  EXPECT_DOUBLE_EQ(profile.backward.stages[0].conditions.delay.jitter_s, 0.02);
  EXPECT_THROW(simple_profile(-0.2, 0, 0), StartupError);
  EXPECT_THROW(simple_profile(0.2, 0, 1.5), StartupError);
}

}  // namespace
}  // namespace telekerf::netem
