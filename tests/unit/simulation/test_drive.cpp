// SPDX-License-Identifier: Apache-2.0
// The stations with devices of which they know nothing but `Robot`, `Laser` and `OperatorInput`.
#include <gtest/gtest.h>

#include <memory>
#include <optional>
#include <vector>

#include "common/robot/drivers/simulated_robot.h"
#include "experiments/simulation/simulation.h"

namespace telekerf::simulation {
namespace {

constexpr std::int64_t kMs = 1'000'000;

/// As a vendor's: it moves by itself. The world may push its tool, and its line may break.
class Foreign : public robot::Robot {
 public:
  struct World {
    std::optional<robot::SimulatedRobot> plant;
    Vec3 written_a = Vec3::Zero();
    bool broken_line = false;
  };
  Foreign(World& world, const robot::RobotModel& model, std::uint64_t seed) : world_(world) {
    world_.plant.emplace(robot::mismatched(model, 0.1, seed), seed, model.in_base(Vec3::Zero()));
  }
  robot::JointReading read() noexcept override {
    return world_.broken_line ? robot::JointReading{} : world_.plant->read();
  }
  void write(const Vec3& currents_a) noexcept override {
    world_.written_a = currents_a;
    world_.plant->write(currents_a);
    world_.plant->advance(1e-3);
  }
  robot::Capabilities capabilities() const override { return {"foreign", false, 0, 0, 1e3}; }

 private:
  World& world_;
};

robot::Drive foreign(Foreign::World& world, const std::string& name, std::uint64_t seed) {
  return {std::make_unique<Foreign>(world, robot::load_robot(name), seed), nullptr};
}

/// Remembers what it was told.
class Lamp : public laser::Laser {
 public:
  explicit Lamp(std::vector<double>& told_w) : told_w_(told_w) {}
  bool emit(const laser::Emission& emission) noexcept override {
    told_w_.push_back(emission.power_w);
    return true;
  }

 private:
  std::vector<double>& told_w_;
};

/// Held and let go by the world.
struct Foot : master::OperatorInput {
  master::OperatorSample sample(std::int64_t) noexcept override { return {.trigger = down}; }
  bool down = false;
};

/// A master with a simulated hand and a slave, without a network between them.
class Cell {
 public:
  Cell() {
    contour = find_contour({});
    master_settings.hand_speed_mm_s = 30.0;
    master_settings.engage = true;
    master = std::make_unique<master::Station>(master_settings);
    task = master->prepare(contour);
  }

  /// One step of both; the master hears `slave`.
  slave::SlaveOutputs step(slave::Station& slave) {
    const std::int64_t now_ns = tick++ * kMs;
    const auto out = master->step(now_ns, task.get(), states, {});
    commands.clear();
    if (out.command) commands.push_back({*out.command, now_ns});
    if (!corridor) corridor = slave.prepare(contour);
    auto followed = slave.step(now_ns, corridor.get(), commands, {});
    states.clear();
    if (followed.state) states.push_back({*followed.state, now_ns});
    return followed;
  }

  /// Well on the way; without the beam if it never comes.
  slave::SlaveOutputs step_until_it_burns(slave::Station& slave) {
    slave::SlaveOutputs out;
    for (int n = 0; n < 8000 && !(n > 5000 && out.laser_w > 0.0); ++n) out = step(slave);
    return out;
  }

  ContourMessage contour;
  master::StationSettings master_settings;
  std::unique_ptr<master::Station> master;
  std::unique_ptr<master::GuidedContour> task;
  std::unique_ptr<slave::Corridor> corridor;
  std::vector<Received<CommandBlock>> commands;
  std::vector<Received<StateBlock>> states;
  std::int64_t tick = 0;
};

slave::StationSettings slave_settings(const std::string& drive) {
  slave::StationSettings settings;
  settings.machine.drive = drive;
  return settings;
}

TEST(Drive, BehindTheSeamTheSlaveDoesBitByBitWhatItDoesWithItsOwnPlant) {
  Cell cell;
  slave::Station own(slave_settings("simulated"));
  Foreign::World world;
  slave::Station other(slave_settings("foreign"),
                       foreign(world, "slave-keops", slave_settings("").seed + 1000));
  const robot::RobotModel model = robot::load_robot("slave-keops");
  std::vector<Vec3> measured_m;
  int lit = 0;
  for (int n = 0; n < 6000; ++n) {
    const Vec3 true_tool_m = model.in_workpiece(world.plant->true_tool_in_base_m());
    const auto here = cell.step(own);
    const auto there = other.step((cell.tick - 1) * kMs, cell.corridor.get(), cell.commands, {});
    ASSERT_EQ(here.currents_a, there.currents_a) << n;
    ASSERT_EQ(here.tool_m, there.tool_m) << n;
    ASSERT_EQ(here.laser_w, there.laser_w) << n;
    ASSERT_EQ(here.interlock, there.interlock) << n;
    ASSERT_LT((there.tool_m - true_tool_m).norm(), 20e-6) << n;
    measured_m.push_back(there.tool_m);
    lit += there.laser_w > 0.0 ? 1 : 0;
  }
  EXPECT_GT(lit, 1000);

  RunRecord simulated, measured;
  own.report(simulated);
  other.report(measured);
  EXPECT_EQ(words_of(simulated.slave_drive), (Metadata{{"name", "simulated"}, {"tool", "true"}}));
  EXPECT_EQ(words_of(measured.slave_drive), (Metadata{{"name", "foreign"}, {"tool", "measured"}}));
  ASSERT_EQ(measured.slave.size(), measured_m.size());
  ASSERT_EQ(simulated.slave.size(), measured_m.size());
  int apart = 0;
  for (std::size_t i = 0; i < measured_m.size(); ++i) {
    ASSERT_EQ(Vec3(measured.slave[i].tool_m.data()), measured_m[i]) << "the record holds the measured tool";
    apart += Vec3(simulated.slave[i].tool_m.data()) == measured_m[i] ? 0 : 1;
  }
  EXPECT_GT(apart, 1000) << "the true tool is another";
}

/// In the middle of the work, the beam on.
class AtWork : public testing::Test {
 protected:
  void SetUp() override { ASSERT_GT(out.laser_w, 0.0); }

  Cell cell;
  Foreign::World world;
  slave::Station slave{slave_settings("foreign"), foreign(world, "slave-keops", 7)};
  slave::SlaveOutputs out = cell.step_until_it_burns(slave);
};

TEST_F(AtWork, ADrivesLossPutsTheBeamOutAtOnceAndTheCurrentsSoon) {
  EXPECT_EQ(slave.machine().readings_missed(), 0u);

  world.broken_line = true;
  for (int n = 1; n <= 20; ++n) {
    EXPECT_FALSE(slave.machine().failed()) << n;
    out = cell.step(slave);
    EXPECT_EQ(out.laser_w, 0.0) << n;
    EXPECT_EQ(out.interlock, n == 20 ? Interlock::kFault : Interlock::kStale) << n;
    EXPECT_EQ(world.written_a.isZero(0.0), n == 20) << n;
  }
  EXPECT_TRUE(slave.machine().failed());

  world.broken_line = false;
  for (int n = 0; n < 100; ++n) {
    EXPECT_EQ(cell.step(slave).laser_w, 0.0);
    EXPECT_EQ(world.written_a, Vec3(Vec3::Zero()));
  }
}

TEST(Laser, IsToldEachStepWhatTheRecordHoldsAndIsOffAtEveryEnd) {
  const StopOrder stop{.number = 1, .cleared = {}};
  for (const char* end : {"release", "destruction", "stop", "loss", "no reading"}) {
    Cell cell;
    Foreign::World world;
    std::vector<double> told_w;
    auto slave = std::make_unique<slave::Station>(slave_settings("foreign"), foreign(world, "slave-keops", 7),
                                                  std::make_unique<Lamp>(told_w));
    EXPECT_EQ(told_w, std::vector{0.0});
    world.broken_line = true;
    cell.step(*slave);
    EXPECT_EQ(told_w, std::vector(2, 0.0)) << "told also before the first reading";
    world.broken_line = false;
    slave::SlaveOutputs out;
    for (int n = 0; n < 8000 && !(n > 5000 && out.laser_w > 0.0); ++n) {
      out = cell.step(*slave);
      ASSERT_EQ(told_w.back(), out.laser_w);
    }
    ASSERT_GT(told_w.back(), 5.0) << end;
    RunRecord record;
    slave->report(record);
    ASSERT_EQ(record.slave.size(), told_w.size() - 2);
    for (std::size_t i = 0; i < record.slave.size(); ++i) ASSERT_EQ(record.slave[i].laser_w, told_w[i + 2]);
    EXPECT_EQ(record.slave_figures.at("laser_clipped"), 0.0);
    EXPECT_EQ(record.slave_figures.at("laser_untold"), 0.0);

    const std::string what = end;
    const std::size_t before = told_w.size();
    if (what == "release") slave->release();
    if (what == "destruction") slave.reset();
    if (what == "stop") (void)slave->step(cell.tick * kMs, cell.corridor.get(), {}, stop);
    if (what == "loss") world.plant->set_tool_force({1e6, 0, 0});
    if (what == "no reading") world.broken_line = true;
    for (int n = 0; n < 100 && what == "loss" && !slave->machine().failed(); ++n) cell.step(*slave);
    if (what == "no reading") cell.step(*slave);
    EXPECT_GT(told_w.size(), before) << end;
    EXPECT_EQ(told_w.back(), 0.0) << end;
  }
}

TEST(Drive, AStopBeforeTheFirstReadingIsHeeded) {
  const StopOrder stop{.number = 1, .cleared = {}};
  Foreign::World there;
  slave::Station slave(slave_settings("foreign"), foreign(there, "slave-keops", 7));
  Foreign::World here;
  master::StationSettings settings;
  settings.machine.drive = "foreign";
  master::Station master(settings, foreign(here, settings.robot, 7));
  there.broken_line = here.broken_line = true;
  EXPECT_EQ(slave.step(0, nullptr, {}, stop).stop, 1u);
  EXPECT_EQ(master.step(0, nullptr, {}, {}, stop).stop, 1u);
  there.broken_line = here.broken_line = false;
  EXPECT_EQ(slave.step(kMs, nullptr, {}, stop).mode, SlaveMode::kStopped);
  EXPECT_EQ(master.step(kMs, nullptr, {}, {}, stop).mode, master::MasterMode::kStopped);
}

TEST_F(AtWork, AMissingReadingIsBridgedWithTheBeamOff) {
  world.broken_line = true;
  for (int n = 0; n < 3; ++n) EXPECT_EQ(cell.step(slave).laser_w, 0.0);
  world.broken_line = false;
  int lit = 0;
  for (int n = 0; n < 50; ++n) {
    out = cell.step(slave);
    lit += out.laser_w > 0.0 ? 1 : 0;
    EXPECT_LT((out.tool_m - out.reference.position_m).norm(), 14e-6);
  }
  EXPECT_GT(lit, 40);
  EXPECT_EQ(slave.machine().readings_missed(), 3u);
}

TEST(Drive, AHandOnARobotThatIsNotSimulatedIsFeltAndNoneIsInvented) {
  SimulationSettings virtual_run;
  virtual_run.image = "circle";
  const ContourMessage contour = find_contour(virtual_run);
  master::StationSettings settings;
  settings.machine.drive = "foreign";
  Foreign::World world;
  master::Station master(settings, foreign(world, settings.robot, 7));
  const auto task = master.prepare(contour);
  master::MasterOutputs out;
  std::int64_t tick = 0;
  const auto run = [&](int steps) {
    for (int n = 0; n < steps; ++n) out = master.step(tick++ * kMs, task.get(), {}, {});
  };
  run(3000);
  ASSERT_EQ(out.mode, master::MasterMode::kGuiding);
  const Vec3 rest_m = out.tool_m;
  run(1000);
  EXPECT_LT((out.tool_m - rest_m).norm(), 1e-6) << "nobody pushes, nothing moves";

  const Vec2 across = out.active.piece.shape.gradient(out.tool_m.head<2>());
  const Vec3 push_n(-1.5 * across.y(), 1.5 * across.x(), 0.0);
  world.plant->set_tool_force(push_n);
  run(300);
  EXPECT_GT((out.tool_m - rest_m).norm(), 1e-3) << "a real hand moves the pen along the curve";

  RunRecord record;
  master.report(record);
  EXPECT_EQ(words_of(record.master_drive), (Metadata{{"name", "foreign"}, {"tool", "measured"}}));
  const MasterRow& row = record.master.back();
  const Vec3 recorded_n(row.hand_n[0], row.hand_n[1], row.hand_n[2]);
  EXPECT_LT((recorded_n - push_n).norm(), 0.5) << "the record holds what was felt";
  for (const MasterRow& any : record.master) ASSERT_FALSE(any.button) << "nobody held the button";
}

TEST(Button, OfADeviceIsTheOnlyOneOnAnyRobot) {
  const ContourMessage contour = find_contour({});
  for (const bool simulated : {true, false}) {
    master::StationSettings settings;
    Foreign::World world;
    robot::Drive drive;
    if (!simulated) drive = foreign(world, settings.robot, 7);
    auto button = std::make_unique<Foot>();
    Foot& foot = *button;
    master::Station master(settings, std::move(drive), std::move(button));
    const auto task = master.prepare(contour);
    for (int n = 0; n < 6000; ++n) {
      foot.down = n % 1500 < 500;
      (void)master.step(n * kMs, task.get(), {}, {});
    }
    RunRecord record;
    master.report(record);
    ASSERT_EQ(record.master.size(), 6000u);
    for (std::size_t n = 0; n < 6000; ++n) ASSERT_EQ(record.master[n].button, n % 1500 < 500) << n;
  }
}

}  // namespace
}  // namespace telekerf::simulation
