// SPDX-License-Identifier: Apache-2.0
// Who asks for those present is told how far each computer's clock is ahead, by the datagram that came
// fastest.
#include "common/bus/roll_call.h"

#include <gtest/gtest.h>

#include <chrono>
#include <thread>

#include "tests/unit/bus/cell.h"

namespace telekerf {
namespace {

double wall_clock_s() {
  return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
}

TEST(RollCall, TellsHowFarTheClockOfEachIsAhead) {
  auto of_the_slave = settings("slave", Site::kSlave);
  of_the_slave.epoch = 5;
  Bus slave(of_the_slave);
  Bus vision(settings("vision", Site::kSlave));
  Bus operators(settings("ctl"));
  const RollCall roll_call(operators);
  Writer<TelemetryMessage> clock(slave);
  ASSERT_TRUE(clock.wait_for_reader(kPatience));
  const auto tell = [&](double wall_clock) {
    return clock.write(
        {.role = "clock", .tick = slave.settings().epoch, .values = {{"wall_clock_s", wall_clock}}});
  };
  constexpr double kAhead_s = 90.0, kDelayed_s = 5.0;
  ASSERT_TRUE(soon([&] {
    // Half of them have been on their way for long.
    EXPECT_TRUE(tell(wall_clock_s() + kAhead_s - kDelayed_s));
    EXPECT_TRUE(tell(wall_clock_s() + kAhead_s));
    const auto present = roll_call.present();
    return present.size() == 2 && present[0].clock_ahead_s > kAhead_s - 1;
  }));
  const auto present = roll_call.present();
  EXPECT_EQ(present[0].who.role, "slave");
  EXPECT_NEAR(*present[0].clock_ahead_s, kAhead_s, 1.0);
  EXPECT_FALSE(present[0].address.empty());
  EXPECT_EQ(present[1].who.role, "vision");
  EXPECT_EQ(present[1].clock_ahead_s, std::nullopt) << "it has said nothing";
}

TEST(RollCall, AClockIsToldOnlyWhileSomebodyAsks) {
  Bus slave(settings("slave", Site::kSlave));
  ClockTeller teller(slave);
  teller.tell();  // nobody asks
  Bus console(settings("console"));
  Reader<TelemetryMessage> telemetry(console);
  ASSERT_TRUE(soon([&] { return telemetry.writers() > 0; }));
  for (int n = 0; n < 20; ++n) teller.tell();
  std::this_thread::sleep_for(std::chrono::milliseconds(200));
  EXPECT_FALSE(telemetry.take()) << "who listens to telemetry has not asked for clocks";
  Bus operators(settings("ctl"));
  const RollCall roll_call(operators);
  ASSERT_TRUE(soon([&] {
    teller.tell();
    const auto present = roll_call.present();
    return present.size() == 2 && present[1].clock_ahead_s;  // the slave
  }));
  EXPECT_NEAR(*roll_call.present()[1].clock_ahead_s, 0.0, 1.0) << "the same computer's clock";
}

}  // namespace
}  // namespace telekerf
