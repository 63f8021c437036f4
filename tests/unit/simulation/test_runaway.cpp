// SPDX-License-Identifier: Apache-2.0
// Robots that do not do what their motors are told: both stations notice it, let go and say why, and they let
// no good robot go.
#include <gtest/gtest.h>

#include <deque>
#include <memory>
#include <string>
#include <vector>

#include "common/robot/drivers/simulated_robot.h"
#include "experiments/simulation/simulation.h"

namespace telekerf::simulation {
namespace {

constexpr std::int64_t kMs = 1'000'000;

/// As a vendor's, with a fault.
class Faulty : public robot::Robot {
 public:
  struct World {
    std::optional<robot::SimulatedRobot> plant;
    double force = 1.0;     ///< times what is asked for
    std::size_t later = 0;  ///< steps until a current acts
    Vec3 written_a = Vec3::Zero();
    Vec3 slip_m = Vec3::Zero();   ///< of the sensors
    bool sticks = false;          ///< that of the first joint
    double read_m = 0.0;          ///< what it told last
  };
  Faulty(World& world, const std::string& name) : world_(world) {
    const robot::RobotModel model = robot::load_robot(name);
    world_.plant.emplace(robot::mismatched(model, 0.1, 7), 7, model.in_base(Vec3::Zero()));
  }
  robot::JointReading read() noexcept override {
    robot::JointReading reading = world_.plant->read();
    reading.joints_m += world_.slip_m;
    if (world_.sticks) reading.joints_m[0] = world_.read_m;
    world_.read_m = reading.joints_m[0];
    return reading;
  }
  void write(const Vec3& currents_a) noexcept override {
    world_.written_a = currents_a;
    waiting_.push_back(world_.force * currents_a);
    if (waiting_.size() > world_.later) {
      world_.plant->write(waiting_.front());
      waiting_.pop_front();
    }
    world_.plant->advance(1e-3);
  }
  robot::Capabilities capabilities() const override { return {"faulty", false, 0, 0, 1e3}; }

 private:
  World& world_;
  std::deque<Vec3> waiting_;
};

/// A cell of which one robot is foreign.
class Runaway : public testing::Test {
 protected:
  void attach(bool at_slave) {
    master::StationSettings of_master;
    of_master.engage = true;
    slave::StationSettings of_slave;
    (at_slave ? of_slave.machine.drive : of_master.machine.drive) = "faulty";
    robot::Drive faulty{std::make_unique<Faulty>(world_, at_slave ? of_slave.robot : of_master.robot),
                        nullptr};
    master_ = std::make_unique<master::Station>(of_master, at_slave ? robot::Drive{} : std::move(faulty));
    slave_ = std::make_unique<slave::Station>(of_slave, at_slave ? std::move(faulty) : robot::Drive{});
    machine_ = at_slave ? &slave_->machine() : &master_->machine();
    guided_ = master_->prepare(contour_);
    corridor_ = slave_->prepare(contour_);
    model_ = robot::load_robot(at_slave ? of_slave.robot : of_master.robot);
  }
  /// Until the robot is given up, or for so long; how long it took.
  double run(double seconds) {
    std::vector<Received<CommandBlock>> commands;
    std::vector<Received<StateBlock>> states;
    for (int n = 0; n < static_cast<int>(seconds * 1e3); ++n, now_ns_ += kMs) {
      const auto made = master_->step(now_ns_, guided_.get(), states, {});
      commands.clear();
      states.clear();
      if (made.command) commands.push_back({*made.command, now_ns_});
      out_ = slave_->step(now_ns_, corridor_.get(), commands, {});
      if (out_.state) states.push_back({*out_.state, now_ns_});
      lit_ += out_.laser_w > 0.0 ? 1 : 0;
      if (machine_->failed()) return n * 1e-3;
    }
    return seconds;
  }
  double away_m() const { return model_.in_workpiece(world_.plant->true_tool_in_base_m()).norm(); }

  ContourMessage contour_ = find_contour({});
  Faulty::World world_;
  robot::RobotModel model_;
  std::unique_ptr<master::Station> master_;
  std::unique_ptr<slave::Station> slave_;
  const robot::RobotSupervisor* machine_ = nullptr;
  std::unique_ptr<master::GuidedContour> guided_;
  std::unique_ptr<slave::Corridor> corridor_;
  slave::SlaveOutputs out_;
  std::int64_t now_ns_ = 0;
  int lit_ = 0;
};

TEST_F(Runaway, AGoodRobotIsLetGoAtNeitherSite) {
  for (const bool at_slave : {true, false}) {
    attach(at_slave);
    EXPECT_EQ(run(8.0), 8.0) << machine_->failure();
  }
  EXPECT_GT(lit_, 1000);
}

TEST_F(Runaway, AForceOfTheWrongSignIsNoticedWithinMillimetres) {
  for (const bool at_slave : {true, false}) {
    world_.force = -1.0;
    attach(at_slave);
    EXPECT_LT(run(5.0), 0.5) << at_slave;
    EXPECT_LT(away_m(), 4e-3) << at_slave;
    EXPECT_EQ(world_.written_a, Vec3(Vec3::Zero()));
    EXPECT_NE(machine_->failure().find("moves against its force; is the sign of its current right"),
              std::string::npos)
        << machine_->failure();
  }
}

TEST_F(Runaway, ASignThatTurnsInTheMiddleOfTheCutPutsTheBeamOut) {
  attach(true);
  ASSERT_EQ(run(6.0), 6.0);
  ASSERT_GT(out_.laser_w, 0.0);
  world_.force = -1.0;
  EXPECT_LT(run(5.0), 0.1);
  EXPECT_EQ(out_.laser_w, 0.0);
  lit_ = 0;
  for (int n = 0; n < 100; ++n) {
    out_ = slave_->step(now_ns_ += kMs, corridor_.get(), {}, {});
    EXPECT_EQ(world_.written_a, Vec3(Vec3::Zero()));
    EXPECT_EQ(out_.laser_w, 0.0);
  }
}

TEST_F(Runaway, ASensorThatSlipsPutsTheBeamOutInThatStepAndStopsTheRobotInTheNext) {
  for (const double slip_m : {20e-6, -0.3e-3}) {
    attach(true);
    ASSERT_EQ(run(6.0), 6.0);
    ASSERT_GT(out_.laser_w, 0.0);
    world_.slip_m[1] = slip_m;
    lit_ = 0;
    EXPECT_EQ(run(1.0), 1e-3);
    EXPECT_EQ(lit_, 0);
    EXPECT_EQ(world_.written_a, Vec3(Vec3::Zero()));
    EXPECT_NE(machine_->failure().find("the reading of joint 2 is"), std::string::npos) << machine_->failure();
    world_.slip_m.setZero();
  }
}

TEST_F(Runaway, ASensorThatSticksPutsTheBeamOutWithinMilliseconds) {
  attach(true);
  ASSERT_EQ(run(6.0), 6.0);
  ASSERT_GT(out_.laser_w, 0.0);
  const Vec3 from_m = world_.plant->true_tool_in_base_m();
  world_.sticks = true;
  lit_ = 0;
  EXPECT_LT(run(1.0), 0.02);
  EXPECT_LT(lit_, 20);
  EXPECT_LT((world_.plant->true_tool_in_base_m() - from_m).norm(), 0.4e-3) << "with the way along the contour";
  EXPECT_EQ(world_.written_a, Vec3(Vec3::Zero()));
  EXPECT_NE(machine_->failure().find("does its sensor st"), std::string::npos) << machine_->failure();
  world_.sticks = false;
}

TEST_F(Runaway, ADriveThatIsLaterThanStatedIsNoticed) {
  for (const bool at_slave : {true, false}) {
    for (const std::size_t later : {std::size_t{1}, std::size_t{2}}) {
      world_.later = later;
      attach(at_slave);
      EXPECT_LT(run(10.0), 3.0) << at_slave << " " << later;
      EXPECT_LT(away_m(), model_.workspace.radius_m) << at_slave << " " << later;
      EXPECT_EQ(world_.written_a, Vec3(Vec3::Zero()));
      EXPECT_NE(machine_->failure().find("is the drive later than the robot file's drive_delay_s says"),
                std::string::npos)
          << machine_->failure();
    }
  }
}

}  // namespace
}  // namespace telekerf::simulation
