// SPDX-License-Identifier: Apache-2.0
// What a SpaceMouse's cap does to a simulated master: how fast it goes along the line, and that it stays on
// it.
#include <gtest/gtest.h>
#include <linux/input-event-codes.h>

#include <algorithm>
#include <memory>

#include "common/geometry/nearest.h"
#include "experiments/simulation/simulation.h"
#include "master/operator/evdev_state.h"
#include "master/station.h"

namespace telekerf::master {
namespace {

constexpr std::int64_t kMs = 1'000'000;

/// The cap in a hand, with a report every 10 ms.
class Cap final : public OperatorInput {
 public:
  OperatorSample sample(std::int64_t now_ns) noexcept override {
    if (now_ns % (10 * kMs) == 0) {
      state_.hear(EV_ABS, ABS_X, static_cast<int>(pushed.x()));
      state_.hear(EV_ABS, ABS_Y, static_cast<int>(-pushed.y()));
      state_.hear(EV_SYN, SYN_REPORT, 0);
    }
    return state_.sample(now_ns);
  }
  void answer(const OperatorAnswer& told) noexcept override {
    state_.answer(told);
    answered = told;
  }
  Vec2 pushed = Vec2::Zero();  ///< counts, x right and y away
  OperatorAnswer answered;

 private:
  EvdevState state_{
      {.kind = EvdevTraits::Kind::kSpaceMouse, .x = {}, .y = {}, .relative = false, .trigger = {}}};
};

TEST(SpaceMouseOnTheMaster, GoesAlongTheLineAtAHandsSpeedAndStaysOnIt) {
  const ContourMessage contour = simulation::find_contour({});
  auto device = std::make_unique<Cap>();
  Cap& cap = *device;
  StationSettings settings;
  settings.record_s = 0.0;
  Station station(settings, {}, {}, std::move(device));
  const auto task = station.prepare(contour);
  const geometry::NearestIndex line({contour.points_m, contour.closed});
  std::int64_t now_ns = 0;
  double off_m = 0.0;
  const auto run = [&](int steps) {
    for (const std::int64_t end_ns = now_ns + steps * kMs; now_ns < end_ns; now_ns += kMs) {
      (void)station.step(now_ns, task.get(), {}, {});
      off_m = std::max(off_m, line.find(cap.answered.tool_m).distance_m);
    }
  };
  run(4000);
  ASSERT_TRUE(cap.answered.guided);
  off_m = 0.0;

  // Pushed along the line as far as the cap goes.
  double way_m = 0.0;
  for (int n = 0; n < 100; ++n) {
    cap.pushed = 350.0 * line.find(cap.answered.tool_m).tangent;
    const Vec2 before_m = cap.answered.tool_m;
    run(10);
    way_m += (cap.answered.tool_m - before_m).norm();
  }
  std::printf("a cap pushed all the way: %.1f mm/s on the workpiece\n", 1e3 * way_m);
  EXPECT_GT(way_m, 10e-3);
  EXPECT_LT(way_m, 60e-3);

  // Across it.
  const Vec2 tangent = line.find(cap.answered.tool_m).tangent;
  cap.pushed = 350.0 * Vec2(-tangent.y(), tangent.x());
  run(1000);
  EXPECT_LT(off_m, 0.3e-3);
  EXPECT_GT(cap.answered.force_n.norm(), 0.5);
  cap.pushed.setZero();
  run(300);
  EXPECT_EQ(cap.answered.force_n.norm(), 0.0);
}

}  // namespace
}  // namespace telekerf::master
