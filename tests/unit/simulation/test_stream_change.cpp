// SPDX-License-Identifier: Apache-2.0
// Law, estimator and codec changed in a running pair of stations, between two engagements; in virtual time.
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "common/runtime/startup_error.h"
#include "experiments/simulation/simulation.h"
#include "experiments/simulation/virtual_link.h"
#include "master/law.h"
#include "tests/unit/allocations.h"

namespace telekerf::simulation {
namespace {

using Kind = EventMessage::Kind;
constexpr std::int64_t kMs = 1'000'000;

/// Both stations across 20 ms each way, the hand simulated, engaged by events.
class Pair {
 public:
  Pair()
      : contour_(find_contour(settings())),
        master_(settings().master),
        slave_(settings().slave),
        corridor_(slave_.prepare(contour_)),
        forward_(settings().network.forward, 1, netem::Direction::kForward),
        backward_(settings().network.backward, 1, netem::Direction::kBackward) {
    tasks_.push_back(master_.prepare(contour_));
  }
  void say(Kind kind, const std::string& words = {}) { said_.push_back({7, kind, 0.0, words}); }
  /// The last verdict's sentence; empty: taken up, or none.
  const std::string& refusal() const { return refusal_; }

  void run(double seconds) {
    worst_m_ = 0.0;
    followed_ = steps_ = 0;
    for (const std::int64_t end = n_ + static_cast<std::int64_t>(1000 * seconds); n_ < end; ++n_) step();
  }
  /// Of the last run: from the slave to beta x the master at the tick that it applied, and the share of steps
  /// in which it followed.
  double worst_um() const { return 1e6 * worst_m_; }
  double followed() const {
    return static_cast<double>(followed_) / static_cast<double>(std::max(1L, steps_));
  }
  const master::Station& master() const { return master_; }
  const slave::Station& slave() const { return slave_; }
  std::size_t step_allocations() const { return allocations_; }

 private:
  static SimulationSettings settings() {
    SimulationSettings all;
    all.network = netem::simple_profile(0.04, 0.0, 0.0);
    all.master.engage = false;
    all.master.record_s = all.slave.record_s = 0.01;
    all.master.button = "hand";
    return all;
  }
  void step() {
    const std::int64_t now_ns = n_ * kMs;
    states_.clear();
    commands_.clear();
    backward_.deliver(now_ns, states_);
    forward_.deliver(now_ns, commands_);
    const std::size_t before = testing::allocations();
    const auto out = master_.step(now_ns, tasks_.back().get(), states_, said_);
    allocations_ += testing::allocations() - before;
    said_.clear();
    for (std::size_t v = 0; v < out.verdict_count; ++v)
      refusal_ = out.verdicts[v].refusal == nullptr ? "" : out.verdicts[v].refusal;
    scaled_m_.push_back(settings().master.beta * out.tool_m);
    if (out.command) forward_.push(now_ns, *out.command);
    if (out.prepare_anew) {
      try {
        tasks_.push_back(master_.prepare(contour_));
      } catch (const StartupError&) {
        // what is in force stays
      }
    }
    const auto made = slave_.step(now_ns, corridor_.get(), commands_);
    if (made.state) backward_.push(now_ns, *made.state);
    ++steps_;
    if (made.applied_tick < 0.0) return;
    ++followed_;
    if (!made.settled) return;
    const auto tick = static_cast<std::size_t>(made.applied_tick);
    if (tick < scaled_m_.size())
      worst_m_ = std::max(worst_m_, (made.tool_m - scaled_m_[tick]).head<2>().norm());
  }

  ContourMessage contour_;
  master::Station master_;
  slave::Station slave_;
  std::vector<std::unique_ptr<master::GuidedContour>> tasks_;
  std::unique_ptr<slave::Corridor> corridor_;
  VirtualLink<CommandBlock> forward_;
  VirtualLink<StateBlock> backward_;
  std::vector<Received<CommandBlock>> commands_;
  std::vector<Received<StateBlock>> states_;
  std::vector<EventMessage> said_;
  std::string refusal_;
  std::vector<Vec3> scaled_m_;
  std::int64_t n_ = 0;
  double worst_m_ = 0.0;
  long followed_ = 0, steps_ = 0;
  std::size_t allocations_ = 0;
};

TEST(StreamChange, EachLawIsFollowedAfterTheOther) {
  Pair pair;
  pair.run(3.0);
  for (const char* law : {"anchored", "local", "anchored", "remote-acceleration", "local", "anchored"}) {
    pair.say(Kind::kSetStream, std::string("law ") + law);
    pair.run(0.5);
    EXPECT_EQ(pair.refusal(), "") << law;
    EXPECT_EQ(master::kLaws.rows()[pair.master().stream().law].word, law);
    const auto before = pair.slave().node().counters();
    pair.say(Kind::kEngage);
    pair.run(2.0);
    pair.run(2.0);
    std::printf("law %s: followed %.3f, worst %.1f um\n", law, pair.followed(), pair.worst_um());
    EXPECT_GT(pair.followed(), 0.99) << law;
    EXPECT_LT(pair.worst_um(), std::string(law) == "remote-acceleration" ? 500.0 : 10.0) << law;
    const auto after = pair.slave().node().counters();
    EXPECT_EQ(after.refused, before.refused) << law;
    EXPECT_EQ(after.stale, before.stale) << law << ": blocks are numbered on";
    EXPECT_EQ(after.lost, before.lost) << law;
    pair.say(Kind::kDisengage);
    pair.run(0.5);
    EXPECT_EQ(pair.followed() > 0.5, false) << law;
  }
}

TEST(StreamChange, CodecAndBlockChangeAndTheLoopAllocatesNothing) {
  Pair pair;
  pair.run(3.0);
  for (const char* words :
       {"codec dpcm", "block 32", "codec raw", "codec sdct", "redundancy 3", "estimator none"}) {
    pair.say(Kind::kSetStream, words);
    pair.run(0.2);
    EXPECT_EQ(pair.refusal(), "") << words;
  }
  EXPECT_EQ(pair.master().stream().block, 32);
  pair.say(Kind::kSetStream, "estimator predictor");
  pair.run(2.0);  // the tool comes to the contour once more
  pair.say(Kind::kEngage);
  pair.run(2.0);
  pair.run(1.0);
  EXPECT_GT(pair.followed(), 0.99);
  EXPECT_LT(pair.worst_um(), 10.0);
  EXPECT_EQ(pair.step_allocations(), 0u);
}

TEST(StreamChange, WhileEngagedItIsRefusedAndNobodyEngagesMeanwhile) {
  Pair pair;
  pair.run(3.0);
  pair.say(Kind::kEngage);
  pair.run(2.0);
  ASSERT_GT(pair.followed(), 0.5);
  pair.say(Kind::kSetStream, "law local");
  pair.run(0.1);
  EXPECT_EQ(pair.refusal(),
            "refused: law, estimator and codec change between two engagements; disengage first");
  EXPECT_EQ(pair.master().stream().law, 0);
  EXPECT_GT(pair.followed(), 0.99) << "and it goes on";
  pair.say(Kind::kDisengage);
  pair.run(0.5);
  pair.say(Kind::kSetStream, "law local");
  pair.say(Kind::kEngage);
  pair.run(2.0);
  EXPECT_EQ(pair.refusal(), "refused: law, estimator or codec are just being changed; engage when they are");
  EXPECT_EQ(pair.followed(), 0.0);
  pair.say(Kind::kEngage);
  pair.say(Kind::kSetStream, "law anchored");
  pair.run(2.0);
  EXPECT_EQ(pair.refusal(), "refused: law, estimator and codec change between two engagements; disengage first");
  pair.run(1.0);
  EXPECT_EQ(pair.master().stream().law, 2);
  EXPECT_GT(pair.followed(), 0.99);
}

TEST(StreamChange, WhatTheCodecDoesNotBearIsRefusedAndEverythingStays) {
  Pair pair;
  pair.run(3.0);
  for (const char* words : {"codec batched", "block 64", "redundancy 7"}) {
    pair.say(Kind::kSetStream, words);
    pair.run(0.2);
  }
  EXPECT_NE(pair.refusal().find("does not go with this block and redundancy"), std::string::npos)
      << pair.refusal();
  EXPECT_EQ(pair.master().stream().redundancy, 1);
  pair.say(Kind::kEngage);
  pair.run(2.0);
  EXPECT_GT(pair.followed(), 0.5);
}

}  // namespace
}  // namespace telekerf::simulation
