// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <set>
#include <thread>

#include "master/constraint_telemetry.h"

namespace telekerf::master {
namespace {

TEST(ConstraintTelemetry, NamesAreUniqueAndTheCircleIsTheOneInForce) {
  EXPECT_EQ(std::set<std::string>(kConstraintValues.begin(), kConstraintValues.end()).size(),
            kConstraintValues.size());
  MasterOutputs out;
  out.corridor_m = 0.5e-3;
  out.constraint_n = 2.5;
  out.active.phi_m = 7e-6;
  out.active.piece.point_m = {0.01, 0.0};
  out.active.piece.shape = geometry::osculating({0.01, 0.0}, {0.0, 1.0}, 100.0);
  ConstraintSnapshot snapshot;
  EXPECT_FALSE(snapshot.load()) << "nothing stored yet";
  snapshot.store(42, constraint_values(out));
  const auto message = snapshot.load();
  ASSERT_TRUE(message);
  EXPECT_EQ(message->role, "master");
  EXPECT_EQ(message->tick, 42u);
  const auto value = [&](const std::string& name) {
    for (const auto& [key, v] : message->values) {
      if (key == name) return v;
    }
    ADD_FAILURE() << name;
    return 0.0;
  };
  EXPECT_EQ(value("corridor_m"), 0.5e-3);
  EXPECT_EQ(value("constraint_n"), 2.5);
  EXPECT_EQ(value("phi_m"), 7e-6);
  EXPECT_EQ(value("circle_is_line"), 0.0);
  EXPECT_NEAR(value("circle_x_m"), 0.0, 1e-12);
  EXPECT_NEAR(value("circle_radius_m"), 0.01, 1e-12);
  EXPECT_NEAR(value("tangent_y"), 1.0, 1e-12);
}

// All values of one store are the same number: a reader that sees two of them has read across a writing.
TEST(ConstraintTelemetry, AReaderNeverSeesHalfAWriting) {
  ConstraintSnapshot snapshot;
  constexpr int kReadings = 20'000;
  std::jthread writer([&](const std::stop_token& stop) {
    ConstraintValues values;
    for (Tick tick = 1; !stop.stop_requested(); ++tick) {
      values.fill(static_cast<double>(tick));
      snapshot.store(tick, values);
    }
  });
  int read = 0;
  Tick newest = 0;
  for (long tries = 0; read < kReadings && tries < 100'000'000; ++tries) {
    const auto message = snapshot.load();
    if (!message) continue;
    ++read;
    for (const auto& value : message->values) {
      ASSERT_EQ(value.second, static_cast<double>(message->tick));
    }
    ASSERT_GE(message->tick, newest) << "and never an older one";
    newest = message->tick;
  }
  EXPECT_EQ(read, kReadings);
}

}  // namespace
}  // namespace telekerf::master
