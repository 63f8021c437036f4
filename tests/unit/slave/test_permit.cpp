// SPDX-License-Identifier: Apache-2.0
// What decides that the beam may be on, in a slave that follows: each doubt by itself, at its very step.
#include "common/robot/drivers/simulated_robot.h"
#include "tests/unit/slave/commanded_slave.h"

namespace telekerf::slave {
namespace {

class Permit : public SlaveNodeTest {
 protected:
  void burn() {
    follow(3.0);
    ASSERT_GT(out_.laser_w, 0.0);
  }
  /// Of the sample that is applied, by the master's circle: what the interlock takes for the tracking error.
  double off_m() const { return (out_.tool_m - place(out_.applied_tick * 1e-3)).norm(); }
};

TEST_F(Permit, AnotherContourPutsTheBeamOutUntilTheMasterWorksOnItToo) {
  burn();
  laser_ticks_ = 0;
  corridor_ = station_.prepare(circle(2, 0.005));
  each_tick_ = [&] { ASSERT_EQ(out_.interlock, Interlock::kNoContour); };
  run(next_block());  // made for the contour before
  EXPECT_EQ(laser_ticks_, 0);
  each_tick_ = {};
  contour_id_ = 2;
  follow(1.0);
  EXPECT_EQ(laser_ticks_, 0) << "nor by itself then";
  engage_anew();
  follow(1.0);
  EXPECT_GT(out_.laser_w, 0.0);
}

/// A stream whose count begins anew is taken after a second of silence, be it a tape; it is followed, but
/// what was lit is not lit again.
TEST_F(Permit, NoSampleIsLitTwice) {
  burn();
  const double newest_lit = out_.applied_tick;
  for (int b = 0; b < 70; ++b) run(std::nullopt);
  number_ = 0;
  tick_ = 0;
  run(next_block());  // who engages before the silence is over is not followed
  engage_anew();
  laser_ticks_ = 0;
  follow(2.5);
  EXPECT_EQ(out_.mode, SlaveMode::kFollowing);
  EXPECT_EQ(out_.forbidden, laser::guard_bit("unlit"));
  EXPECT_LT(out_.applied_tick, newest_lit);
  EXPECT_EQ(laser_ticks_, 0);
  follow(1.0);
  EXPECT_GT(out_.applied_tick, newest_lit);
  EXPECT_GT(out_.laser_w, 0.0);
}

TEST_F(Permit, AFaultOfRobotOrLaserForbids) {
  burn();
  SlaveNode node(robot::load_robot("slave-keops"), {}, 1);
  SlaveInputs inputs;
  inputs.fault = true;
  EXPECT_NE(node.step(0, inputs).forbidden & laser::guard_bit("fault"), 0u);
  inputs.fault = false;
  EXPECT_EQ(node.step(kMs, inputs).forbidden & laser::guard_bit("fault"), 0u);
}

/// Three periods are what a laser waits for; after four it is off for 20 ms.
TEST_F(Permit, AStepThatComesLateKeepsTheBeamOffForAWhile) {
  burn();
  now_ns_ += 2 * kMs;
  run(next_block());
  EXPECT_EQ(station_.node().counters().late_steps, 0u);
  follow(0.2);
  ASSERT_GT(out_.laser_w, 0.0);
  now_ns_ += 3 * kMs;
  const std::int64_t late_ns = now_ns_;
  int dark = 0;
  each_tick_ = [&] {
    const bool late = (out_.forbidden & laser::guard_bit("on-time")) != 0;
    ASSERT_EQ(late, now_ns_ - late_ns < 20 * kMs);
    ASSERT_FALSE(late && out_.laser_w > 0.0);
    dark += late ? 1 : 0;
  };
  follow(0.1);
  EXPECT_EQ(dark, 20);
  EXPECT_EQ(station_.node().counters().late_steps, 1u);
  each_tick_ = {};
  follow(0.5);
  EXPECT_GT(out_.laser_w, 0.0);
}

/// Half a millimetre is what may be.
TEST_F(Permit, AToolThatIsLiftedTooFarBurnsNothing) {
  burn();
  height_m_ = 0.4e-3;
  follow(1.0);
  EXPECT_GT(out_.laser_w, 0.0);
  height_m_ = 0.6e-3;
  follow(1.0);
  EXPECT_NEAR(out_.tool_m.z(), 0.6e-3, 20e-6);
  EXPECT_EQ(out_.forbidden, laser::guard_bit("height"));
  laser_ticks_ = 0;
  follow(0.5);
  EXPECT_EQ(laser_ticks_, 0);
}

/// States that take 0.4 s to the master: the commands that come back are older than the gate.
TEST_F(Permit, CommandsThatWereLongUnderWayAreFollowedWithoutLight) {
  burn();
  states_late_ = 25;
  follow(0.6);
  each_tick_ = [&] {
    ASSERT_EQ(out_.mode, SlaveMode::kFollowing);
    ASSERT_NE(out_.forbidden & laser::guard_bit("age"), 0u);
    ASSERT_GT(out_.command_age_s, 0.35);
  };
  laser_ticks_ = 0;
  follow(0.5);
  EXPECT_EQ(laser_ticks_, 0);
  each_tick_ = {};
  states_late_ = 0;
  follow(0.5);
  EXPECT_EQ(laser_ticks_, 0) << "nor by itself when they are young again";
  released_blocks_ = 8;
  follow(0.5);
  EXPECT_GT(out_.laser_w, 0.0);
}

TEST_F(Permit, WithoutAContourNothingBurns) {
  burn();
  laser_ticks_ = 0;
  const auto before = std::move(corridor_);
  each_tick_ = [&] { ASSERT_EQ(out_.interlock, Interlock::kNoContour); };
  follow(0.2);
  EXPECT_EQ(laser_ticks_, 0);
  EXPECT_EQ(out_.reason, HoldReason::kNeedsEngage);
}

TEST_F(Permit, ContourNumberZeroIsNotKnownBeforeTheMasterIsHeard) {
  corridor_ = station_.prepare(circle(0, 0.005));
  run(std::nullopt);
  EXPECT_EQ(out_.interlock, Interlock::kNoContour);
  contour_id_ = 0;
  engaged_ = false;
  follow(0.1);
  EXPECT_EQ(out_.interlock, Interlock::kNotEngaged);
}

TEST_F(Permit, TheBeamIsOnWhereTheAppliedSamplesButtonIsPressed) {
  burn();
  pressed_ = [](Tick tick) { return tick / 7 % 2 == 0; };
  follow(0.2);  // what was made before is used up
  int lit = 0;
  int checked = 0;
  each_tick_ = [&] {
    ASSERT_EQ(out_.interlock, Interlock::kReady);
    ASSERT_EQ(out_.laser_w > 0.0, pressed_(static_cast<Tick>(std::llround(out_.applied_tick))));
    lit += out_.laser_w > 0.0 ? 1 : 0;
    ++checked;
  };
  follow(0.5);
  EXPECT_NEAR(lit, checked / 2, 7);
}

TEST_F(Permit, ItBurnsFromTheStepAtWhichTwoMicrometresAreLeftOfTheApproach) {
  int judged = 0;
  int close = 0;
  each_tick_ = [&] {
    if (out_.applied_tick < 0.0) return;
    const double margin_m = (out_.reference.position_m - place(out_.applied_tick * 1e-3)).norm() - 2e-6;
    if (std::abs(margin_m) < 0.2e-6) return;  // the codec's part of it
    ASSERT_EQ(out_.settled, margin_m < 0.0) << margin_m;
    ASSERT_EQ(out_.interlock == Interlock::kReady,
              margin_m < 0.0 && out_.interlock != Interlock::kOutsideCorridor)
        << margin_m;
    close += std::abs(margin_m) < 1e-6 ? 1 : 0;
    ++judged;
  };
  follow(3.0);
  EXPECT_GT(judged, 2900);
  EXPECT_GE(close, 10);
  EXPECT_LT(largest_step_, 5e-3);
}

TEST_F(Permit, AToolFiftyMicrometresFromWhereItIsWantedPutsTheBeamOutUntilItIsBack) {
  burn();
  int kept_off = 0;
  int burnt = 0;
  double farthest_m = 0.0;
  each_tick_ = [&] {
    farthest_m = std::max(farthest_m, off_m());
    const double margin_m = off_m() - 50e-6;
    if (std::abs(margin_m) < 0.2e-6) return;
    ASSERT_EQ(out_.interlock, margin_m < 0.0 ? Interlock::kReady : Interlock::kTracking) << margin_m;
    ++(margin_m < 0.0 ? burnt : kept_off);
  };
  station_.machine().plant()->set_tool_force({0.0, 0.0, 9.0});  // along the beam: the contour stays near
  run(next_block());
  station_.machine().plant()->set_tool_force(Vec3::Zero());
  follow(0.5);
  EXPECT_NEAR(farthest_m, 69.1e-6, 0.5e-6) << "as stiff as law and observer make it";
  EXPECT_GT(kept_off, 5);
  EXPECT_GT(burnt, 300);
  EXPECT_GT(out_.laser_w, 0.0);
}

/// The contour's circle is another one than the master's. Beyond 500 um, less 20 um and the 90 um that the
/// robot's 20 m/s^2 can make of 3 ms, or the way of 3 ms if that is more, no beam.
TEST_F(Permit, TheCorridorIsMeasuredFromToolToContourWithTheWayOfTheReaction) {
  burn();
  double radius_m = 0.0;
  int within = 0;
  int predicted = 0;
  int beyond = 0;
  each_tick_ = [&] {
    const double off_m = std::abs(out_.tool_m.head<2>().norm() - radius_m) + 20e-6;
    const double noise_m = 9e-6;  // 3 ms of the measured speed's noise
    if (std::abs(off_m + 3e-3 * 0.02 - 0.5e-3) < noise_m || std::abs(off_m + 90e-6 - 0.5e-3) < noise_m)
      return;
    const Interlock expected = off_m + 90e-6 < 0.5e-3         ? Interlock::kReady
                               : off_m + 3e-3 * 0.02 < 0.5e-3 ? Interlock::kPredicted
                                                              : Interlock::kOutsideCorridor;
    ASSERT_EQ(out_.interlock, expected) << off_m;
    ++(expected == Interlock::kReady ? within : expected == Interlock::kPredicted ? predicted : beyond);
  };
  for (const double side : {-1.0, 1.0}) {
    for (double off_m = 0.36e-3; off_m < 0.45e-3; off_m += 2e-6) {
      radius_m = 5e-3 + side * off_m;
      corridor_ = station_.prepare(circle(1, radius_m));
      run(next_block());
    }
  }
  EXPECT_GT(within, 200);
  EXPECT_GT(predicted, 100);
  EXPECT_GT(beyond, 200);
}

TEST_F(Permit, FromTheFirstMissingSampleOnTheBeamIsOff) {
  burn();
  const std::optional<CommandBlock> silence;
  int stale = 0;
  double last_tick = out_.applied_tick;
  bool over = false;
  each_tick_ = [&] {
    over = over || out_.applied_tick < 0.0;
    ASSERT_EQ(out_.laser_w > 0.0, !over);
    if (!over) {
      ASSERT_NEAR(out_.applied_tick, last_tick + 1.0, 1e-9);
      last_tick = out_.applied_tick;
    }
    if (over && out_.mode == SlaveMode::kFollowing) {
      ASSERT_EQ(out_.interlock, Interlock::kStale);
      ++stale;
    }
  };
  for (int n = 0; n < 20; ++n) run(silence);
  EXPECT_EQ(last_tick, static_cast<double>(tick_) - 1.0) << "what has come is used up";
  EXPECT_EQ(out_.mode, SlaveMode::kHolding);
  EXPECT_GT(stale, 50);
}

/// A node whose joints are whatever the test says.
class PermitOfANode : public SlaveNodeTest {
 protected:
  explicit PermitOfANode(bool touched = false) : node_(model_, settings_of(touched), 1) {}
  static SlaveSettings settings_of(bool touched) {
    SlaveSettings settings = StationSettings{}.validated().node;
    settings.touched = touched;
    return settings;
  }
  /// 16 steps; the block arrives at their beginning.
  void run_node(const std::optional<CommandBlock>& block,
                const std::function<void(robot::JointReading&)>& spoil = {}) {
    for (int n = 0; n < 16; ++n) {
      std::vector<Received<CommandBlock>> arrived;
      if (n == 0 && block) arrived.push_back({*block, now_ns_});
      SlaveInputs inputs;
      inputs.joints = plant_.read();
      if (spoil) spoil(inputs.joints);
      inputs.commands = arrived;
      inputs.corridor = corridor_.get();
      out_ = node_.step(now_ns_, inputs);
      if (out_.state) echo_ = *out_.state;
      now_ns_ += kMs;
      judge();
      plant_.write(out_.currents_a);
      plant_.advance(1e-3);
    }
  }

  robot::RobotModel model_ = robot::load_robot("slave-keops");
  robot::SimulatedRobot plant_{model_, 1, model_.in_base(Vec3::Zero())};
  SlaveNode node_;
};

TEST_F(PermitOfANode, WithoutAReadingTheBeamIsOff) {
  for (int b = 0; b < 200; ++b) run_node(next_block());
  ASSERT_GT(out_.laser_w, 0.0);
  int n = 0;
  each_tick_ = [&] { ASSERT_EQ(out_.interlock, n == 3 ? Interlock::kStale : Interlock::kReady) << n; };
  run_node(next_block(), [&](robot::JointReading& reading) {
    ++n;
    if (n == 3) reading.valid = false;
  });
  EXPECT_EQ(n, 16);
}

/// Of a slave whose tool may be touched: the currents need not explain its readings.
class PermitOfATouchedNode : public PermitOfANode {
 protected:
  PermitOfATouchedNode() : PermitOfANode(true) {}
};

TEST_F(PermitOfATouchedNode, WithJointsThatAreNoPoseTheBeamIsOffAndTheJointsAreBraked) {
  for (int b = 0; b < 200; ++b) run_node(next_block());
  ASSERT_GT(out_.laser_w, 0.0);
  Vec3 before_m = out_.reference.position_m;
  each_tick_ = [&] {
    ASSERT_EQ(out_.interlock, Interlock::kStale);
    ASSERT_EQ(out_.tool_m, before_m) << "nobody knows better than the reference";
    before_m = out_.reference.position_m;
    ASSERT_EQ(out_.force_n, Vec3(Vec3::Zero()));
    for (int i = 0; i < 3; ++i) {
      ASSERT_NEAR(std::abs(out_.currents_a[i]),
                  model_.motor.peak_force_n / model_.motor.force_constant_n_per_a, 1e-9)
          << "with all that the motors have";
    }
  };
  run_node(next_block(), [](robot::JointReading& reading) { reading.joints_m = Vec3::Constant(10.0); });
}

TEST_F(PermitOfANode, ItRestsWhereItsFirstReadingFindsIt) {
  const Vec3 there_m(2e-3, -1e-3, 0.5e-3);
  plant_ = robot::SimulatedRobot(model_, 1, model_.in_base(there_m));
  for (int n = 0; n < 8; ++n) (void)node_.step(now_ns_, {});  // without a reading, and nothing moves
  run_node(std::nullopt);
  EXPECT_LT((out_.reference.position_m - there_m).norm(), 5e-6);
  EXPECT_LT((out_.tool_m - there_m).norm(), 0.15e-3) << "its weight is not known yet";
  EXPECT_FALSE(out_.settled) << "nothing is followed";
}

TEST_F(PermitOfANode, HoweverLittleTheBeamHasTheStateSaysThatItIsOn) {
  SlaveSettings settings = StationSettings{}.validated().node;
  settings.laser_w = 0.05;
  SlaveNode faint(model_, settings, 1);
  SlaveOutputs out;
  int lit = 0;
  for (int b = 0; b < 200; ++b) {
    const Received<CommandBlock> block{next_block(), now_ns_};
    for (int n = 0; n < 16; ++n, now_ns_ += kMs) {
      SlaveInputs inputs;
      inputs.joints = plant_.read();
      if (n == 0) inputs.commands = {&block, 1};
      inputs.corridor = corridor_.get();
      out = faint.step(now_ns_, inputs);
      ASSERT_LE(out.laser_w, 0.0751);
      if (out.state) {
        echo_ = *out.state;
        ASSERT_EQ(out.state->laser_on, out.laser_w > 0.0);
      }
      lit += out.laser_w > 0.0 ? 1 : 0;
      plant_.write(out.currents_a);
      plant_.advance(1e-3);
    }
  }
  EXPECT_GT(lit, 1000);
}

TEST_F(PermitOfANode, AToolBeyondTheWorkspacesEdgeBurnsNothing) {
  const double edge_m = model_.workspace.radius_m;
  corridor_ = std::make_unique<Corridor>(
      Corridor{1, geometry::NearestIndex(geometry::Polyline{circle(1, edge_m).points_m, true}), {}});
  radius_m_ = edge_m - 10e-6;
  for (int b = 0; b < 400; ++b) run_node(next_block());
  int within = 0;
  int beyond = 0;
  each_tick_ = [&] {
    const bool inside = out_.tool_m.head<2>().norm() <= edge_m;
    ASSERT_EQ(out_.interlock, inside ? Interlock::kReady : Interlock::kOutsideWorkspace);
    ++(inside ? within : beyond);
  };
  for (int b = 0; b < 100; ++b) {
    radius_m_ = edge_m + 20e-6 * std::sin(0.2 * b);
    run_node(next_block());
  }
  EXPECT_GT(within, 20);
  EXPECT_GT(beyond, 20);
}

}  // namespace
}  // namespace telekerf::slave
