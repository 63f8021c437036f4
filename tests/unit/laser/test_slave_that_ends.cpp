// SPDX-License-Identifier: Apache-2.0
// A slave that is killed, hangs or is heard no more while the beam is on, from the interlock's judgement to
// the laser at the other end of the wire, in simulated time: how long there is light after that.
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <random>
#include <utility>

#include "slave/laser/udp_laser.h"
#include "tests/unit/laser/laser_device.h"
#include "tests/unit/laser/permits.h"

namespace telekerf::laser {
namespace {

constexpr std::int64_t kMs = 1'000'000;
constexpr std::int64_t kBound_ns = 5 * kMs;

/// Of both ends; the simulated time.
std::int64_t clock_ns = 0;
std::int64_t simulated_clock() noexcept { return clock_ns; }

class SlaveThatEnds : public testing::Test {
 protected:
  static constexpr double kPower_w = 5.0;

  SlaveThatEnds() {
    clock_ns = 1000 * kMs;
    output =
        std::make_unique<LaserOutput>(stated(socket.laser()), 10.0, 1000.0,
                                      std::make_unique<UdpLaser>(socket.address(), 1000.0, simulated_clock));
    arrive();
  }
  std::int64_t up_to(std::int64_t most_ns) {
    return static_cast<std::int64_t>(random() % static_cast<std::uint64_t>(most_ns));
  }
  double power_w() const { return device.power_w(clock_ns); }
  /// What was sent reaches the laser, or is lost.
  void arrive(bool lost = false) {
    while (const auto arrival = socket.take())
      if (!lost) (void)device.hear(arrival->told, arrival->size, arrival->from, clock_ns);
  }
  Permit judge() {
    judged_ns = clock_ns;
    permits.now_ns = clock_ns - Permits::kPeriod_ns;
    return permits.next(kPower_w);
  }
  void order(Permit permit) { (void)output->emit(std::move(permit), judged_ns, kPower_w, false); }
  /// Judged, held up, ordered, on its way.
  void step(std::int64_t held_up_ns, std::int64_t under_way_ns) {
    Permit permit = judge();
    clock_ns += held_up_ns;
    order(std::move(permit));
    clock_ns += under_way_ns;
    arrive();
  }
  /// It cuts, with steps as uneven as a busy computer makes them.
  void cut() {
    for (int n = 0; n < 20; ++n) {
      step(up_to(kMs / 2), up_to(kMs / 5));
      clock_ns += up_to(kMs / 2);
    }
    clock_ns += up_to(kMs / 2);
  }
  /// The longest light that there was from `end_ns` on, once nothing more arrives.
  void ended(std::int64_t end_ns) {
    lit += device.power_w(end_ns) > 0.0 ? 1 : 0;
    longest_ns = std::max(longest_ns, device.dark_ns() - end_ns);
  }

  std::mt19937_64 random{17};
  LaserSocket socket;
  std::unique_ptr<LaserOutput> output;
  UdpLaserDevice device{20.0};
  Permits permits;
  std::int64_t judged_ns = 0;
  std::int64_t longest_ns = 0;
  int lit = 0;
};

TEST_F(SlaveThatEnds, BetweenTwoOrdersIsDarkWithinFiveMilliseconds) {
  for (int n = 0; n < 200; ++n) {
    cut();
    ended(clock_ns);
    clock_ns += 600 * kMs;
    EXPECT_EQ(power_w(), 0.0);
  }
  EXPECT_EQ(lit, 200) << "it cut each time";
  EXPECT_LE(longest_ns, kBound_ns);
  EXPECT_GT(longest_ns, kMs);
}

TEST_F(SlaveThatEnds, BetweenJudgementAndOrderIsDarkWithinFiveMillisecondsAndStaysSoWhenItWakes) {
  for (int n = 0; n < 200; ++n) {
    cut();
    Permit permit = judge();
    clock_ns += up_to(kMs / 2);
    ended(clock_ns);
    clock_ns += 4 * kMs + up_to(600 * kMs);
    order(std::move(permit));  // it wakes up, and goes on where it was
    arrive();
    EXPECT_EQ(power_w(), 0.0) << "what was judged before it hung";
  }
  EXPECT_EQ(lit, 200) << "it cut each time";
  EXPECT_LE(longest_ns, kBound_ns);
}

TEST_F(SlaveThatEnds, WhoseOrderIsUnderWayIsDarkWithinFiveMilliseconds) {
  for (int n = 0; n < 200; ++n) {
    cut();
    order(judge());
    const std::int64_t end_ns = clock_ns;
    clock_ns += up_to(kMs);
    arrive();
    ended(end_ns);
    clock_ns += 600 * kMs;
  }
  EXPECT_LE(longest_ns, kBound_ns);
  EXPECT_GT(longest_ns, 2 * kMs);
}

TEST_F(SlaveThatEnds, OrIsNotHeardAnyMoreIsDarkWithinFiveMilliseconds) {
  for (int n = 0; n < 200; ++n) {
    cut();
    ended(clock_ns);
    for (int silent = 0; silent < 30; ++silent) {
      order(judge());
      arrive(true);
      clock_ns += kMs;
      EXPECT_TRUE(silent < 5 || power_w() == 0.0) << silent;
    }
    order(judge());
    arrive();
    EXPECT_EQ(power_w(), kPower_w) << "heard again";
  }
  EXPECT_EQ(lit, 200) << "it cut each time";
  EXPECT_LE(longest_ns, kBound_ns);
}

/// Whatever holds the steps up: no light outlasts its judgement by more, but for the way to the laser.
TEST_F(SlaveThatEnds, NoLightIsOlderThanFiveMilliseconds) {
  std::int64_t oldest_ns = 0;
  for (int n = 0; n < 5000; ++n) {
    step(n % 3 == 0 ? up_to(6 * kMs) : up_to(kMs / 2), 0);
    if (power_w() > 0.0) {
      ++lit;
      oldest_ns = std::max(oldest_ns, device.dark_ns() - judged_ns);
    }
    clock_ns += up_to(kMs);
  }
  EXPECT_GT(lit, 3000);
  EXPECT_LE(oldest_ns, kBound_ns);
  EXPECT_GT(oldest_ns, 4 * kMs);
}

}  // namespace
}  // namespace telekerf::laser
