// SPDX-License-Identifier: Apache-2.0
// Which input is judged by which limit, and what a permit is good for. That nothing turns the beam on that
// should not is proved by tests/unit/slave/test_guards.cpp.
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <type_traits>
#include <utility>
#include <vector>

#include "tests/unit/laser/permits.h"

namespace telekerf::laser {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();

double above(double value) { return std::nextafter(value, kInfinite); }
Interlock reason(const InterlockInputs& inputs, const InterlockSettings& settings = of_a_machine()) {
  return evaluate_interlock(inputs, settings).reason();
}

/// Everything is wrong at first, and put right one after the other: the first reason left is said.
TEST(Interlock, EveryDoubtForbidsTheBeamByItselfAndTheFirstOneIsSaid) {
  using Repair = std::pair<Interlock, std::function<void(InterlockInputs&)>>;
  const std::vector<Repair> repairs{
      {Interlock::kStopped, [](InterlockInputs& now) { now.stopped = false; }},
      {Interlock::kFault, [](InterlockInputs& now) { now.fault = false; }},
      {Interlock::kNoContour, [](InterlockInputs& now) { now.contour_known = true; }},
      {Interlock::kNotEngaged, [](InterlockInputs& now) { now.engaged = true; }},
      {Interlock::kNotArmed, [](InterlockInputs& now) { now.armed = true; }},
      {Interlock::kNotArmed, [](InterlockInputs& now) { now.button_armed = true; }},
      {Interlock::kStale, [](InterlockInputs& now) { now.fresh = true; }},
      {Interlock::kStale, [](InterlockInputs& now) { now.unlit = true; }},
      {Interlock::kAge, [](InterlockInputs& now) { now.command_age_s = 0.0; }},
      {Interlock::kOutsideWorkspace, [](InterlockInputs& now) { now.radius_m = 0.0; }},
      {Interlock::kHeight, [](InterlockInputs& now) { now.height_m = 0.0; }},
      {Interlock::kOutsideCorridor,
       [](InterlockInputs& now) {
         now.contour_distance_m = 0.0;
         now.speed_m_per_s = 0.1;
       }},
      {Interlock::kArc, [](InterlockInputs& now) { now.arc_gap_m = 0.0; }},
      {Interlock::kPredicted, [](InterlockInputs& now) { now.predicted_distance_m = 0.0; }},
      {Interlock::kTracking, [](InterlockInputs& now) { now.offset_m = 0.0; }},
      {Interlock::kTracking, [](InterlockInputs& now) { now.tracking_error_m = 0.0; }},
      {Interlock::kSpeed, [](InterlockInputs& now) { now.cut_speed_m_per_s = 0.1; }},
      {Interlock::kPower, [](InterlockInputs& now) { now.power_w = 0.0; }},
      {Interlock::kDose, [](InterlockInputs& now) { now.dose_j = 0.0; }},
      {Interlock::kDose, [](InterlockInputs& now) { now.area_dose_j_per_mm2 = 0.0; }},
      {Interlock::kLate, [](InterlockInputs& now) { now.on_time = true; }},
      {Interlock::kFault, [](InterlockInputs& now) { now.emission_agrees = true; }},
      {Interlock::kMonitor, [](InterlockInputs& now) { now.monitor_agrees = true; }}};
  InterlockInputs inputs;
  for (const auto& [expected, repair] : repairs) {
    EXPECT_EQ(reason(inputs), expected);
    repair(inputs);
  }
  EXPECT_EQ(reason(inputs), Interlock::kReady);
  EXPECT_EQ(reason({}), Interlock::kStopped) << "what is not said is not allowed";
  InterlockSettings asking = of_a_machine();
  asking.max_look_age_s = 2.0;
  EXPECT_EQ(evaluate_interlock({}, asking).forbidden, Judgement{}.forbidden) << "not one of them";
  EXPECT_EQ(evaluate_interlock(all_good(), {}).forbidden,
            guard_bit("workspace") | guard_bit("speed") | guard_bit("moving") | guard_bit("power"))
      << "nor as long as the machine is not known, whichever part of it";
}

TEST(Interlock, WhoAsksForALookAsksHoweverYoungItHasToBe) {
  InterlockSettings asking = of_a_machine();
  InterlockInputs inputs = all_good();
  for (const double age_s : {1e-3, 0.05, 9.0}) {
    asking.max_look_age_s = age_s;
    inputs.look_age_s = age_s;
    EXPECT_EQ(reason(inputs, asking), Interlock::kReady) << age_s;
    inputs.look_age_s = above(age_s);
    EXPECT_EQ(reason(inputs, asking), Interlock::kNoContour) << age_s;
    inputs.look_age_s = kAbsent;
    EXPECT_EQ(reason(inputs, asking), Interlock::kNoContour) << age_s;
  }
  asking.max_look_age_s = 0.0;
  EXPECT_EQ(reason(inputs, asking), Interlock::kReady) << "nobody asks";
}

/// Each number with its guard and the largest value that is good. Numbers that binary fractions hold exactly.
TEST(Interlock, EachNumberHasItsLimitAndReachesIt) {
  InterlockSettings settings{.corridor_m = 1.0,
                             .reaction_s = 0.25,
                             .measurement_m = 0.125,
                             .max_tracking_error_m = 0.5,
                             .max_offset_m = 0.25,
                             .max_height_m = 0.75,
                             .max_arc_gap_m = 2.0,
                             .beam_age_s = 3.0,
                             .min_cut_speed_m_per_s = 0.0625,
                             .max_dose_j = 5.0,
                             .max_area_dose_j_per_mm2 = 6.0,
                             .workspace_radius_m = 4.0,
                             .max_speed_m_per_s = 8.0,
                             .max_power_w = 7.0};
  struct Row {
    Interlock reason;
    double InterlockInputs::*number;
    double high;
  };
  const Row rows[] = {{Interlock::kAge, &InterlockInputs::command_age_s, 3.0},
                      {Interlock::kOutsideWorkspace, &InterlockInputs::radius_m, 4.0},
                      {Interlock::kHeight, &InterlockInputs::height_m, 0.75},
                      // + 0.5 x 0.25 + 0.125 = 1
                      {Interlock::kOutsideCorridor, &InterlockInputs::contour_distance_m, 0.75},
                      {Interlock::kArc, &InterlockInputs::arc_gap_m, 2.0},
                      {Interlock::kPredicted, &InterlockInputs::predicted_distance_m, 0.875},
                      {Interlock::kTracking, &InterlockInputs::offset_m, 0.25},
                      {Interlock::kTracking, &InterlockInputs::tracking_error_m, 0.5},
                      {Interlock::kPower, &InterlockInputs::power_w, 7.0},
                      {Interlock::kDose, &InterlockInputs::dose_j, 5.0},
                      {Interlock::kDose, &InterlockInputs::area_dose_j_per_mm2, 6.0}};
  for (const Row& row : rows) {
    InterlockInputs inputs = all_good();
    inputs.speed_m_per_s = inputs.cut_speed_m_per_s = 0.5;
    EXPECT_EQ(reason(inputs, settings), Interlock::kReady);
    inputs.*row.number = row.high;
    EXPECT_EQ(reason(inputs, settings), Interlock::kReady) << static_cast<int>(row.reason);
    for (const double wrong : {above(row.high) + 1e-15, -1e-9, kAbsent, kInfinite, -kInfinite}) {
      inputs.*row.number = wrong;
      EXPECT_EQ(reason(inputs, settings), row.reason) << wrong;
    }
  }
  InterlockInputs inputs = all_good();
  settings.reaction_s = 0.0;
  for (const double good : {0.0625, 8.0}) {
    inputs.cut_speed_m_per_s = inputs.speed_m_per_s = good;
    EXPECT_EQ(reason(inputs, settings), Interlock::kReady) << good;
  }
  for (const double wrong : {std::nextafter(0.0625, 0.0), 0.0, above(8.0), -1.0, kAbsent, kInfinite}) {
    inputs.cut_speed_m_per_s = wrong;
    EXPECT_EQ(reason(inputs, settings), Interlock::kSpeed) << wrong;
  }
  inputs.cut_speed_m_per_s = 1.0;
  inputs.speed_m_per_s = above(8.0);
  EXPECT_EQ(reason(inputs, settings), Interlock::kSpeed);
  for (const double wrong : {-1.0, kAbsent, kInfinite, -kInfinite}) {
    inputs.speed_m_per_s = wrong;
    EXPECT_FALSE(evaluate_interlock(inputs, settings).permits()) << wrong;
  }
}

/// Half a millimetre, less 20 um that sensors do not see, less 3 ms of way; 50 um to where it is wanted, 2 um
/// left of an approach.
TEST(Interlock, AsItIsSetTheCorridorIsHalfAMillimetreAndAFastToolIsStoppedEarlier) {
  for (const double speed_m_per_s : {0.0, 0.02, 0.1}) {
    InterlockInputs inputs = all_good();
    inputs.speed_m_per_s = speed_m_per_s;
    const double bound_m = 0.5e-3 - 20e-6 - 3e-3 * speed_m_per_s;
    inputs.contour_distance_m = bound_m - 1e-9;
    EXPECT_EQ(reason(inputs), Interlock::kReady) << speed_m_per_s;
    inputs.contour_distance_m = bound_m + 1e-9;
    EXPECT_EQ(reason(inputs), Interlock::kOutsideCorridor) << speed_m_per_s;
  }
  const InterlockSettings settings;
  EXPECT_EQ(settings.max_tracking_error_m, 50e-6);
  EXPECT_EQ(settings.max_offset_m, 2e-6);
  EXPECT_EQ(settings.max_height_m, 0.5e-3);
  EXPECT_EQ(settings.max_arc_gap_m, 1e-3);
  EXPECT_EQ(settings.beam_age_s, 0.35);
  EXPECT_EQ(settings.min_cut_speed_m_per_s, 0.0);
  EXPECT_EQ(settings.max_dose_j, 2.0);
  EXPECT_EQ(settings.max_area_dose_j_per_mm2, 20.0);
}

TEST(Permit, OnlyAnInterlockMakesOneAndNobodyCopiesIt) {
  static_assert(!std::is_copy_constructible_v<Permit> && !std::is_copy_assignable_v<Permit>);
  static_assert(!std::is_constructible_v<Permit, std::uint64_t, std::int64_t, std::int64_t, double>);
  const Permit none;
  EXPECT_EQ(none.tick(), 0u);
  EXPECT_EQ(none.end_ns(), 0);
  EXPECT_EQ(none.max_w(), 0.0);
  for (const std::int64_t now_ns : {std::int64_t{-1}, std::int64_t{0}, std::int64_t{1}})
    EXPECT_FALSE(none.covers(now_ns));
}

TEST(Permit, IsOfTheTickAndCoversTwoPeriods) {
  BeamInterlock interlock(of_a_machine(), 1000);
  InterlockInputs inputs = all_good();
  inputs.power_w = 8.0;
  for (std::uint64_t tick = 1; tick <= 3; ++tick) {
    const std::int64_t now_ns = 5000 * static_cast<std::int64_t>(tick);
    const auto decision = interlock.decide(now_ns, inputs);
    EXPECT_TRUE(decision.judgement.permits());
    EXPECT_EQ(decision.permit.tick(), tick);
    EXPECT_EQ(decision.permit.end_ns(), now_ns + 2000);
    EXPECT_EQ(decision.permit.max_w(), 8.0);
    EXPECT_FALSE(decision.permit.covers(now_ns - 1));
    EXPECT_TRUE(decision.permit.covers(now_ns));
    EXPECT_TRUE(decision.permit.covers(now_ns + 1999));
    EXPECT_FALSE(decision.permit.covers(now_ns + 2000));
  }
  inputs.engaged = false;
  const auto decision = interlock.decide(20000, inputs);
  EXPECT_EQ(decision.judgement.forbidden, guard_bit("engaged"));
  EXPECT_EQ(decision.permit.tick(), 0u);
  EXPECT_FALSE(decision.permit.covers(20000));
  inputs.engaged = true;
  EXPECT_EQ(interlock.decide(25000, inputs).permit.tick(), 5u) << "steps are counted, not permits";
}

TEST(Permit, WhoGaveItAwayHasNone) {
  Permits permits;
  Permit first = permits.next();
  Permit second = std::move(first);
  EXPECT_TRUE(second.covers(permits.now_ns));
  EXPECT_FALSE(first.covers(permits.now_ns));  // NOLINT: that is what is asked
  EXPECT_EQ(first.tick(), 0u);
  EXPECT_EQ(first.max_w(), 0.0);
  EXPECT_EQ(first.end_ns(), 0);
  first = std::move(second);
  EXPECT_TRUE(first.covers(permits.now_ns));
  EXPECT_FALSE(second.covers(permits.now_ns));  // NOLINT
}

}  // namespace
}  // namespace telekerf::laser
