// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <set>
#include <thread>

#include "master/telemetry.h"

namespace telekerf::master {
namespace {

TEST(MasterTelemetry, NamesAreUniqueAndValuesAreThoseInForce) {
  EXPECT_EQ(std::set<std::string>(kMasterValueNames.begin(), kMasterValueNames.end()).size(),
            kMasterValueNames.size());
  MasterOutputs out;
  out.corridor_m = 0.5e-3;
  out.off_line = true;
  out.constraint_n = 2.5;
  out.velocity_m_per_s = {0.0, 0.03, 0.0};
  out.hand_n = {1.25, 0.0, 0.0};
  out.active.phi_m = 7e-6;
  out.active.piece.point_m = {0.01, 0.0};
  out.active.piece.shape = geometry::osculating({0.01, 0.0}, {0.0, 1.0}, 100.0);
  out.observed.slave.velocity_m_per_s = {0.0, 0.02, 0.0};
  out.observed.innovation_m = {0.0, 0.0, 3e-6};
  out.observed.delay_s = 0.12;
  out.observed.aligned = true;
  out.slave_force = {.force_n = {0.0, -1.5, 0.0}, .tick = 12, .known = true};
  Snapshot snapshot;
  EXPECT_FALSE(snapshot.load()) << "nothing stored yet";
  snapshot.store(42,
                 master_values(out, 0.25, {-3.5, 1e-5, 2e-4}, 0.1, {.law = 2, .estimator = 3, .block = 32}));
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
  EXPECT_EQ(value("off_line"), 1.0);
  EXPECT_EQ(value("constraint_n"), 2.5);
  EXPECT_EQ(value("phi_m"), 7e-6);
  EXPECT_EQ(value("circle_is_line"), 0.0);
  EXPECT_NEAR(value("circle_x_m"), 0.0, 1e-12);
  EXPECT_NEAR(value("circle_radius_m"), 0.01, 1e-12);
  EXPECT_NEAR(value("tangent_y"), 1.0, 1e-12);
  EXPECT_EQ(value("beta"), 0.25);
  EXPECT_EQ(value("slave_y_m_per_s"), 0.02);
  EXPECT_EQ(value("innovation_z_m"), 3e-6);
  EXPECT_EQ(value("delay_s"), 0.12);
  EXPECT_EQ(value("joined"), 1.0);
  EXPECT_EQ(value("clock_offset_s"), -3.5);
  EXPECT_EQ(value("round_trip_s"), 0.1);
  EXPECT_EQ(value("tool_y_m_per_s"), 0.03);
  EXPECT_EQ(value("hand_x_n"), 1.25);
  EXPECT_EQ(value("force_known"), 1.0);
  EXPECT_EQ(value("force_y_n"), -1.5);
  EXPECT_EQ(value("law"), 2.0);
  EXPECT_EQ(value("estimator"), 3.0);
  EXPECT_EQ(value("block"), 32.0);
}

// All values of one store are the same number: a reader that sees two of them has read across a writing.
TEST(MasterTelemetry, AReaderNeverSeesHalfAWriting) {
  Snapshot snapshot;
  constexpr int kReadings = 20'000;
  std::jthread writer([&](const std::stop_token& stop) {
    MasterValues values;
    for (Tick tick = 1; !stop.stop_requested(); ++tick) {
      values.fill(static_cast<double>(tick));
      snapshot.store(tick, values);
    }
  });
  int read = 0;
  Tick newest = 0;
  for (long tries = 0; read < kReadings && tries < 100'000'000; ++tries) {
    const auto message = snapshot.load();
    if (!message) {
      std::this_thread::yield();  // a writer that was interrupted while writing must come to its end
      continue;
    }
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
