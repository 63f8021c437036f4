// SPDX-License-Identifier: Apache-2.0
// What a laser behind a UDP address measures of its light, and what is held against it.
#include <gtest/gtest.h>

#include <limits>
#include <optional>
#include <vector>

#include "tests/unit/laser/laser_device.h"

namespace telekerf::laser {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr std::int64_t kMs = 1'000'000;
std::int64_t test_clock() noexcept { return 0; }

/// A laser of which the tests say what it measures.
class Measured : public ::testing::Test {
 protected:
  /// It is told, and answers.
  bool step(double power_w, double emission_w, std::uint32_t version = UdpPower::kVersion,
            std::size_t more = 0) {
    laser.emit({power_w, false, kMs, ++enable});
    UdpEmission answer;
    std::optional<LaserSocket::Arrival> newest;
    while (auto arrival = socket.take()) newest = arrival;
    answer.sequence = newest->told.sequence;
    answer.emission_w = emission_w;
    answer.version = version;
    socket.answer(answer, newest->from, more);
    return laser.stray();
  }
  LaserSocket socket;
  UdpLaser laser{socket.address(), 1000.0, test_clock};
  std::uint64_t enable = 0;
};

TEST_F(Measured, LightThatNobodyAskedForIsStray) {
  EXPECT_FALSE(laser.stray()) << "nothing is measured";
  EXPECT_FALSE(step(8.0, 7.5));
  EXPECT_FALSE(step(0.0, 0.0));
  EXPECT_FALSE(step(0.0, 1e-3)) << "darker than dark is none";
  EXPECT_TRUE(step(0.0, 1.1e-3));
  EXPECT_FALSE(laser.stray()) << "said once";
  EXPECT_TRUE(step(0.0, kNan));
  EXPECT_EQ(laser.refused(), 0u);
  EXPECT_FALSE(step(0.0, 5.0, 1)) << "no answer of this version";
  EXPECT_FALSE(step(0.0, 5.0, UdpPower::kVersion, 1)) << "an answer, and something behind it";
  EXPECT_EQ(laser.refused(), 2u);
  UdpEmission other;
  other.magic = UdpPower::kMagic;
  other.sequence = 1;
  other.emission_w = 5.0;
  laser.emit({0.0, false, kMs, 0});
  const auto from = socket.take().value_or(LaserSocket::Arrival{}).from;
  socket.answer(other, from);
  EXPECT_FALSE(laser.stray()) << "no answer by its magic";
  EXPECT_EQ(laser.refused(), 3u);
  EXPECT_FALSE(step(8.0, 0.0)) << "too little is no danger";
}

TEST_F(Measured, MoreThanHalfAsMuchAgainAsWasAskedForIsStray) {
  EXPECT_FALSE(step(8.0, 12.0));
  EXPECT_TRUE(step(8.0, 12.002));
  EXPECT_FALSE(step(8.0, 8.0));
  EXPECT_TRUE(step(8.0, kNan));
}

TEST_F(Measured, AnAnswerCountsOnceAndOnlyToWhatWasSent) {
  laser.emit({0.0, false, kMs, 0});
  std::optional<LaserSocket::Arrival> newest;
  while (auto arrival = socket.take()) newest = arrival;
  UdpEmission answer;
  answer.emission_w = 5.0;
  for (const std::uint64_t sequence : {newest->told.sequence + 1, std::uint64_t{0}}) {
    answer.sequence = sequence;
    socket.answer(answer, newest->from);
    EXPECT_FALSE(laser.stray()) << sequence;
  }
  answer.sequence = newest->told.sequence;
  socket.answer(answer, newest->from);
  EXPECT_TRUE(laser.stray());
  socket.answer(answer, newest->from);
  EXPECT_FALSE(laser.stray());
}

TEST_F(Measured, EightAnswersAreLookedAtInAStepAndTheRestInTheNext) {
  std::vector<LaserSocket::Arrival> told;
  for (int n = 0; n < 9; ++n) {
    laser.emit({0.0, false, kMs, 0});
    while (auto arrival = socket.take()) told.push_back(*arrival);
  }
  const auto answer_last = [&](std::size_t count, double last_w) {
    for (std::size_t n = told.size() - 9; n < told.size() - 9 + count; ++n) {
      UdpEmission answer;
      answer.sequence = told[n].told.sequence;
      answer.emission_w = n + 1 == told.size() - 9 + count ? last_w : 0.0;
      socket.answer(answer, told[n].from);
    }
  };
  answer_last(9, 5.0);
  EXPECT_FALSE(laser.stray()) << "the ninth says that there is light";
  EXPECT_TRUE(laser.stray());
  EXPECT_FALSE(laser.stray());
  for (int n = 0; n < 9; ++n) {
    laser.emit({0.0, false, kMs, 0});
    while (auto arrival = socket.take()) told.push_back(*arrival);
  }
  answer_last(8, 5.0);
  EXPECT_TRUE(laser.stray()) << "the eighth does";
}

/// What was asked for is kept for 64 datagrams; an answer to an older one is held against nothing.
TEST_F(Measured, AnAnswerThatIsSixtyFourDatagramsLateIsNone) {
  for (const int later : {63, 64}) {
    laser.emit({8.0, false, kMs, ++enable});
    std::optional<LaserSocket::Arrival> first;
    while (auto arrival = socket.take()) first = arrival;
    for (int n = 0; n < later; ++n) laser.emit({0.0, false, kMs, 0});
    while (socket.take()) {
    }
    UdpEmission answer;
    answer.sequence = first->told.sequence;
    answer.emission_w = 12.1;
    socket.answer(answer, first->from);
    EXPECT_EQ(laser.stray(), later == 63) << later;
  }
  EXPECT_EQ(laser.refused(), 0u) << "late is not wrong";
}

}  // namespace
}  // namespace telekerf::laser
