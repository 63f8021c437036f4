// SPDX-License-Identifier: Apache-2.0
// The master station by itself: it starts disengaged, brings the tool to the curve, holds it there, and
// engages only while a slave that works on the same contour is alive.
#include <gtest/gtest.h>

#include <cmath>

#include "common/runtime/startup_error.h"
#include "master/station.h"

namespace telekerf::master {
namespace {

constexpr std::int64_t kMs = 1'000'000;

ContourMessage circle(double radius_m) {
  ContourMessage contour;
  contour.id = 4;
  for (int i = 0; i < 720; ++i) {
    contour.points_m.emplace_back(radius_m * std::cos(i * M_PI / 360), radius_m * std::sin(i * M_PI / 360));
  }
  return contour;
}

class MasterStation : public testing::Test {
 protected:
  explicit MasterStation(const StationSettings& settings = {}) : station_(settings) {}
  void run(double seconds, bool engage, bool slave_alive, std::vector<EventMessage> events = {}) {
    for (int n = 0; n < static_cast<int>(seconds * 1000); ++n) {
      std::vector<Received<StateBlock>> states;
      if (slave_alive && n % 16 == 0) {
        StateBlock state;
        state.sequence = ++number_;
        state.epoch = slave_epoch_;
        state.contour_id = slave_contour_;
        state.interlock = Interlock::kReady;
        state.guards = guards_;
        state.sample_period_ns = 1'000'000;
        if (blocks_ > 0 && clock_ahead_ns_ != 0) {
          state.echo_sequence = last_.sequence;
          state.echo_sent_ns = last_.sent_ns + clock_ahead_ns_;
        }
        state.first_tick = Tick{16} * number_;
        const std::vector<Vec3> resting(16, Vec3::Zero());
        state.payload.size =
            static_cast<std::uint16_t>(encoder_.encode(resting, 0, {}, state.payload.room()).value_or(0));
        states.push_back({state, now_ns_});
      }
      if (n == 0 && wish_) {
        events.emplace_back().kind = engage ? EventMessage::Kind::kEngage : EventMessage::Kind::kDisengage;
      }
      const StationOutputs out = station_.step(now_ns_, task_.get(), states, events, stop_);
      if (out.let_go != nullptr) let_go_ = out.let_go;
      out_ = out;
      events.clear();
      if (out_.command) {
        last_ = *out_.command;
        ++blocks_;
      }
      now_ns_ += kMs;
    }
  }

  bool wish_ = true;  ///< the operator says anew at each run what is wanted
  StopOrder stop_;
  Station station_;
  std::uint32_t guards_ = 0;  ///< as the slave tells them
  std::unique_ptr<GuidedContour> task_;
  MasterOutputs out_;
  const char* let_go_ = nullptr;
  CommandBlock last_;
  int blocks_ = 0;
  codec::BlockEncoder encoder_{codec::StreamSettings{}};
  std::uint32_t number_ = 0;
  std::uint32_t slave_contour_ = 4;
  std::uint32_t slave_epoch_ = 1;
  std::int64_t clock_ahead_ns_ = 0;  ///< of what the slave echoes; 0: it echoes nothing
  std::int64_t now_ns_ = 0;
};

/// Asked to engage by itself, or with a button that nobody holds.
class Unattended : public MasterStation {
 protected:
  explicit Unattended(const StationSettings& settings =
                          [] {
                            StationSettings engaging;
                            engaging.engage = true;
                            return engaging;
                          }())
      : MasterStation(settings) {
    wish_ = false;
    task_ = station_.prepare(circle(0.01));
  }
};
class UnattendedButton : public Unattended {
 protected:
  UnattendedButton()
      : Unattended([] {
          StationSettings pressing;
          pressing.button = "pressed";
          return pressing;
        }()) {}
};

TEST_F(Unattended, WithASimulatedLaserItEngages) {
  run(3.0, true, true);
  EXPECT_EQ(station_.obstacle(), nullptr);
  EXPECT_EQ(out_.mode, MasterMode::kEngaged);
}

TEST_F(Unattended, WithARealLaserItDoesNotAndSaysSo) {
  guards_ = kRealLaser;
  for (int n = 0; n < 300; ++n) {
    run(0.01, true, true);
    ASSERT_NE(out_.mode, MasterMode::kEngaged);
    ASSERT_FALSE(last_.engaged);
  }
  ASSERT_NE(station_.obstacle(), nullptr);
  EXPECT_NE(std::string(station_.obstacle()).find("leave --engage out"), std::string::npos);
}

TEST_F(UnattendedButton, WithARealLaserIsRefused) {
  run(0.1, true, true);
  EXPECT_EQ(station_.obstacle(), nullptr);
  guards_ = kRealLaser;
  run(0.1, true, true);
  ASSERT_NE(station_.obstacle(), nullptr);
  EXPECT_NE(std::string(station_.obstacle()).find("name a pedal"), std::string::npos);
}

TEST_F(MasterStation, WithARealLaserAPersonMayEngage) {
  guards_ = kRealLaser;
  task_ = station_.prepare(circle(0.01));
  run(3.0, true, true);
  EXPECT_EQ(station_.obstacle(), nullptr);
  EXPECT_EQ(out_.mode, MasterMode::kEngaged);
}

TEST_F(MasterStation, WithoutContourItHoldsAndIsSilent) {
  run(1.0, true, true);
  EXPECT_EQ(out_.mode, MasterMode::kIdle);
  EXPECT_EQ(blocks_, 0);
  EXPECT_LT(out_.tool_m.norm(), 0.5e-6);
}

TEST_F(MasterStation, ApproachesGuidesAndEngagesOnlyWithALivingSlaveOnTheSameContour) {
  task_ = station_.prepare(circle(0.01));
  run(0.3, true, false);
  EXPECT_EQ(out_.mode, MasterMode::kApproach);
  EXPECT_FALSE(last_.engaged);
  run(3.0, true, false);
  EXPECT_EQ(out_.mode, MasterMode::kGuiding) << "nobody there";
  EXPECT_NEAR(out_.tool_m.head<2>().norm(), 0.02, 0.2e-3) << "on contour / beta";
  slave_contour_ = 9;
  run(0.5, true, true);
  EXPECT_EQ(out_.mode, MasterMode::kGuiding) << "another contour";
  slave_contour_ = 4;
  run(0.5, false, true);
  EXPECT_EQ(out_.mode, MasterMode::kGuiding) << "engaging is explicit";
  run(0.5, true, true);
  EXPECT_EQ(out_.mode, MasterMode::kEngaged);
  EXPECT_TRUE(last_.engaged);
  EXPECT_EQ(let_go_, nullptr);
  wish_ = false;
  run(1.0, true, false);
  EXPECT_EQ(out_.mode, MasterMode::kGuiding) << "the slave fell silent";
  ASSERT_NE(let_go_, nullptr);
  EXPECT_NE(std::string(let_go_).find("not heard any more; engage anew"), std::string::npos) << let_go_;
  EXPECT_FALSE(last_.engaged);
}

TEST_F(MasterStation, AProcessThatStoodStillSaysThatItDid) {
  task_ = station_.prepare(circle(0.01));
  run(4.0, true, true);
  ASSERT_EQ(out_.mode, MasterMode::kEngaged);
  now_ns_ += 1000 * kMs;
  wish_ = false;
  run(0.001, true, false);  // the states of meanwhile have not been read yet
  run(0.1, true, true);
  EXPECT_EQ(out_.mode, MasterMode::kGuiding);
  ASSERT_NE(let_go_, nullptr);
  EXPECT_NE(std::string(let_go_).find("the master's process stood still"), std::string::npos) << let_go_;
}

TEST_F(MasterStation, AnEngagementWaitsUntilItIsKnownWhoseSlaveIsHeard) {
  task_ = station_.prepare(circle(0.01));
  run(4.0, false, true);
  slave_epoch_ = 2;  // the slave has been started anew; the one before is still the one that is listened to
  run(0.3, false, true);
  run(0.15, true, true);
  EXPECT_EQ(out_.mode, MasterMode::kGuiding) << "led by whom";
  wish_ = false;
  run(0.3, true, true);
  EXPECT_EQ(out_.mode, MasterMode::kEngaged);
  EXPECT_EQ(let_go_, nullptr);
  run(2.0, true, true);
  EXPECT_EQ(out_.mode, MasterMode::kEngaged);
}

TEST_F(MasterStation, AnEngagementThatHoldsIsNotEndedByAnotherSlave) {
  task_ = station_.prepare(circle(0.01));
  run(4.0, true, true);
  ASSERT_EQ(out_.mode, MasterMode::kEngaged);
  wish_ = false;
  for (int n = 0; n < 30; ++n) {
    slave_epoch_ = n % 2 == 0 ? 9 : 1;
    run(0.016, true, true);
    ASSERT_EQ(out_.mode, MasterMode::kEngaged);
  }
}

TEST_F(MasterStation, ASlaveWhoseAnswersCannotBeIsLetGoAndItIsSaid) {
  task_ = station_.prepare(circle(0.01));
  run(4.0, true, true);
  ASSERT_EQ(out_.mode, MasterMode::kEngaged);
  clock_ahead_ns_ = 20 * kMs;
  wish_ = false;
  run(0.033, true, true);
  EXPECT_EQ(out_.mode, MasterMode::kGuiding);
  EXPECT_GT(station_.node().link().clocks_wrong(), 0u);
  EXPECT_EQ(station_.node().link().round_trips(), 0u);
  ASSERT_NE(let_go_, nullptr);
  EXPECT_NE(std::string(let_go_).find("one of the two clocks is wrong"), std::string::npos);
  clock_ahead_ns_ = -1 * kMs;
  run(1.0, true, true);
  EXPECT_EQ(out_.mode, MasterMode::kGuiding) << "not by itself";
  wish_ = true;
  run(0.1, true, true);
  EXPECT_EQ(out_.mode, MasterMode::kEngaged);
}

TEST_F(MasterStation, EmergencyStopHoldsUntilCleared) {
  task_ = station_.prepare(circle(0.01));
  run(4.0, true, true);
  ASSERT_EQ(out_.mode, MasterMode::kEngaged);
  const std::uint32_t engagement = last_.engage;
  stop_.number = 3;
  run(0.5, true, true);
  EXPECT_EQ(last_.stop, 3u);
  EXPECT_EQ(out_.mode, MasterMode::kStopped);
  EXPECT_FALSE(last_.engaged);
  EXPECT_LT(out_.velocity_m_per_s.norm(), 2e-3);
  stop_ = {.number = 0, .cleared = {3}};
  wish_ = false;
  run(4.0, true, true);
  EXPECT_EQ(out_.mode, MasterMode::kGuiding) << "nobody has engaged anew";
  wish_ = true;
  run(0.5, true, true);
  EXPECT_EQ(out_.mode, MasterMode::kEngaged);
  EXPECT_EQ(last_.engage, engagement + 1);
}

TEST_F(MasterStation, AContourThatComesDuringAStopReplacesTheOneBefore) {
  task_ = station_.prepare(circle(0.01));
  run(4.0, true, true);
  stop_.number = 3;
  run(0.1, true, true);
  ContourMessage another = circle(0.01);
  another.id = 5;
  task_ = station_.prepare(another);  // nothing of the one before is left
  run(0.1, true, true);
  EXPECT_EQ(out_.mode, MasterMode::kStopped);
  EXPECT_EQ(last_.contour_id, 5u);
}

TEST_F(MasterStation, BlocksFollowEachOtherWithoutGap) {
  task_ = station_.prepare(circle(0.01));
  run(0.016, true, true);
  const CommandBlock first = last_;
  run(0.160, true, true);
  EXPECT_EQ(last_.sequence, first.sequence + 10);
  EXPECT_EQ(last_.first_tick, first.first_tick + 160);
  EXPECT_EQ(last_.sample_period_ns, 1'000'000u);
  EXPECT_EQ(last_.beta, 0.5);
}

TEST_F(MasterStation, AContourThatLeavesTheWorkspaceIsRefusedWithARemedy) {
  try {
    (void)station_.prepare(circle(0.05));
    FAIL() << "accepted";
  } catch (const StartupError& refusal) {
    const std::string what = refusal.what();
    EXPECT_NE(what.find("100.0 mm"), std::string::npos) << what;
    EXPECT_NE(what.find("--beta"), std::string::npos) << what;
  }
}

}  // namespace
}  // namespace telekerf::master
