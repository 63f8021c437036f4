// SPDX-License-Identifier: Apache-2.0
// What the frames of a lap cost, in virtual time. That a captured frame costs just this is held by
// tests/system/test_wire_frames.cpp.
#include <gtest/gtest.h>

#include "tests/unit/simulation/two_stations.h"

namespace telekerf::simulation {
namespace {

/// Mean bytes of a frame.
struct Frames {
  const char* image;
  double command, state;
};

class WireBytes : public testing::TestWithParam<Frames> {};

TEST_P(WireBytes, AFrameOfEitherStreamAndBothTogether) {
  SimulationSettings settings;
  settings.network = netem::load_profile("thesis-constant");
  settings.image = GetParam().image;
  settings.master.record_s = settings.slave.record_s = 0.01;
  TwoStations both(settings);
  struct {
    double frames = 0.0, bytes = 0.0;
    double mean() const { return bytes / frames; }
    void add(std::uint32_t frame) { frames += frame > 0 ? 1.0 : 0.0, bytes += frame; }
  } command_frames, state_frames;
  constexpr std::int64_t kSteps = 20'000;
  std::int64_t lit = 0;
  for (std::int64_t n = 0; n < kSteps; ++n) {
    const TwoStations::Step step = both.step(n);
    command_frames.add(step.command_bytes);
    state_frames.add(step.state_bytes);
    lit += step.lit ? 1 : 0;
  }
  const double both_per_s = (command_frames.bytes + state_frames.bytes) / (1e-3 * kSteps);
  std::printf("%s: commands %.1f bytes a frame, states %.1f, both %.0f bytes/s\n", GetParam().image,
              command_frames.mean(), state_frames.mean(), both_per_s);
  EXPECT_GT(lit, kSteps / 2) << "a lap that cuts";
  EXPECT_NEAR(command_frames.mean(), GetParam().command, 1.0);
  EXPECT_NEAR(state_frames.mean(), GetParam().state, 1.0);
  constexpr double kBusBytesPerS = 2400.0;  // as captured there, of two pairs of processes
  EXPECT_LE(both_per_s + kBusBytesPerS, 25'000.0);
}

INSTANTIATE_TEST_SUITE_P(Pictures, WireBytes,
                         testing::Values(Frames{"heart", 147.3, 194.1}, Frames{"gear", 148.7, 204.8},
                                         Frames{"circle", 147.5, 194.6}));

}  // namespace
}  // namespace telekerf::simulation
