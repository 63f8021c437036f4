// SPDX-License-Identifier: Apache-2.0
// What a place of the workpiece gets from a slave that follows, whatever arrives: the power follows the
// speed, and no place gets more than 2 J within 0.1 mm.
#include <numbers>

#include "common/runtime/startup_error.h"
#include "tests/unit/slave/commanded_slave.h"

namespace telekerf::slave {
namespace {

class DoseOfASlave : public SlaveNodeTest {
 protected:
  /// The master's circle and the contour, whose speed follows from it: 4 rad/s.
  void round(double radius_m) {
    radius_m_ = radius_m;
    corridor_ = station_.prepare(circle(1, radius_m));
    each_tick_ = [this] {
      if (out_.laser_w > 0.0) exposed_.push_back({out_.tool_m.head<2>(), out_.laser_w * 1e-3});
      enough_ += out_.interlock == Interlock::kDose ? 1 : 0;
    };
  }
  /// Most within 0.1 mm of any of two hundred places on the circle.
  double most_j() const {
    double most = 0.0;
    for (int k = 0; k < 200; ++k) {
      const double angle = k * 1e-2 * std::numbers::pi;
      const Vec2 centre_m = radius_m_ * Vec2(std::cos(angle), std::sin(angle));
      double sum = 0.0;
      for (const auto& [place_m, energy_j] : exposed_)
        sum += (place_m - centre_m).norm() <= 0.1e-3 ? energy_j : 0.0;
      most = std::max(most, sum);
    }
    return most;
  }

  std::vector<std::pair<Vec2, double>> exposed_;
  int enough_ = 0;
};

TEST_F(DoseOfASlave, ThePowerFollowsTheSpeed) {
  for (const auto& [radius_m, power_w] : {std::pair{1.25e-3, 5.0}, {2.5e-3, 10.0}, {3.75e-3, 14.9}}) {
    round(radius_m);
    follow(3.0);
    double sum = 0.0;
    each_tick_ = [&] { sum += out_.laser_w; };
    follow(0.48);
    EXPECT_NEAR(sum / 480.0, power_w, 0.03 * power_w) << radius_m;
  }
}

/// The circle of half a millimetre is walked in 1.6 s; a pass gives a place about a quarter of a joule.
TEST_F(DoseOfASlave, RepeatedPassesEndAtTwoJoulesAndTheReasonIsSaid) {
  round(0.5e-3);
  follow(9.0);
  EXPECT_EQ(enough_, 0) << "five passes are none too many";
  EXPECT_GT(most_j(), 1.0);
  follow(30.0);
  EXPECT_LE(most_j(), 2.0);
  EXPECT_GT(most_j(), 1.45);
  EXPECT_GT(enough_, 20'000) << "for good";
  EXPECT_EQ(out_.interlock, Interlock::kDose);
  EXPECT_EQ(out_.forbidden, laser::guard_bit("dose"));
  // The account is of the workpiece, not of the contour.
  corridor_ = station_.prepare(circle(2, 0.5e-3));
  contour_id_ = 2;
  follow(0.1);
  engage_anew();
  follow(2.0);
  EXPECT_EQ(out_.interlock, Interlock::kDose);
  station_.new_workpiece();
  follow(0.5);
  EXPECT_GT(out_.laser_w, 0.0);
}

TEST_F(DoseOfASlave, AToolThatRestsBurnsNothingHoweverLongTheButtonIsHeld) {
  round(0.05e-3);  // 0.2 mm/s
  follow(20.0);
  EXPECT_EQ(out_.mode, SlaveMode::kFollowing);
  EXPECT_EQ(out_.forbidden, laser::guard_bit("moving"));
  EXPECT_EQ(out_.interlock, Interlock::kSpeed);
  double sum_j = 0.0;
  for (const auto& [place_m, energy_j] : exposed_) sum_j += energy_j;
  EXPECT_LT(sum_j, 0.05) << "the approach to it";
}

/// In a process the account goes by the clock, as far as a permit reaches.
TEST_F(DoseOfASlave, AStepThatComesLateIsBookedWithTheTimeThatTheBeamWasOn) {
  round(2.5e-3);
  follow(3.0);
  ASSERT_GT(out_.laser_w, 0.0);
  const auto booked = [&](std::int64_t later_ns) {
    const Vec2 place_m = out_.tool_m.head<2>();
    const double power_w = out_.laser_w;
    station_.new_workpiece();
    (void)station_.step(now_ns_ - kMs + later_ns, corridor_.get(), {}, {});
    return station_.node().dose().at(place_m).place_j / power_w;
  };
  EXPECT_NEAR(booked(kMs), 1e-3, 1e-9);
  follow(0.1);
  ASSERT_GT(out_.laser_w, 0.0);
  EXPECT_NEAR(booked(3 * kMs / 2), 1.5e-3, 1e-9);
  follow(0.1);
  ASSERT_GT(out_.laser_w, 0.0);
  EXPECT_NEAR(booked(50 * kMs), 2e-3, 1e-9) << "then the permit has ended";
}

TEST(SlaveStation, MoreThanAPlaceMayHaveInOnePassIsRefused) {
  const auto refusal = [](double laser_w, double speed_mm_s, double dose_j) -> std::string {
    StationSettings settings;
    settings.node.laser_w = laser_w;
    settings.laser_speed_mm_s = speed_mm_s;
    settings.node.interlock.max_dose_j = dose_j;
    try {
      EXPECT_EQ(settings.validated().node.beam_power.speed_m_per_s, 1e-3 * speed_mm_s);
    } catch (const StartupError& refused) {
      return refused.what();
    }
    return "accepted";
  };
  EXPECT_EQ(refusal(10, 10, 2), "accepted");
  EXPECT_EQ(refusal(74, 10, 2), "accepted");
  EXPECT_EQ(
      refusal(75, 10, 2),
      "laser_w = 75 at laser_speed_mm_s = 10 gives a place 2 J in one pass, more than dose_max_j = 2; lower "
      "the power, or raise dose_max_j if the material bears it");
  EXPECT_EQ(refusal(75, 20, 2), "accepted");
  EXPECT_EQ(refusal(75, 10, 2.1), "accepted");
}

}  // namespace
}  // namespace telekerf::slave
