// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <utility>
#include <vector>

#include "slave/laser/interlock.h"

namespace telekerf::laser {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinite = std::numeric_limits<double>::infinity();

InterlockInputs good() {
  InterlockInputs inputs;
  inputs.contour_known = inputs.engaged = inputs.fresh = inputs.inside_workspace = true;
  return inputs;
}

double below(double value) { return std::nextafter(value, -kInfinite); }

/// Everything is wrong at first, and put right one after the other: the first reason left is said.
TEST(Interlock, EveryDoubtForbidsTheBeamByItselfAndTheFirstOneIsSaid) {
  using Repair = std::pair<Interlock, std::function<void(InterlockInputs&)>>;
  const std::vector<Repair> repairs{
      {Interlock::kStopped, [](InterlockInputs& now) { now.stopped = false; }},
      {Interlock::kNoContour, [](InterlockInputs& now) { now.contour_known = true; }},
      {Interlock::kNotEngaged, [](InterlockInputs& now) { now.engaged = true; }},
      {Interlock::kStale, [](InterlockInputs& now) { now.fresh = true; }},
      {Interlock::kOutsideWorkspace, [](InterlockInputs& now) { now.inside_workspace = true; }},
      {Interlock::kOutsideCorridor, [](InterlockInputs& now) { now.contour_distance_m = 0.0; }},
      {Interlock::kTracking, [](InterlockInputs& now) { now.offset_m = 0.0; }},
      {Interlock::kTracking, [](InterlockInputs& now) { now.tracking_error_m = 0.0; }}};
  const InterlockInputs wrong{
      .stopped = true, .contour_distance_m = 1.0, .tracking_error_m = 1.0, .offset_m = 1.0};
  InterlockInputs inputs = wrong;
  for (const auto& [reason, repair] : repairs) {
    EXPECT_EQ(evaluate_interlock(inputs, {}), reason);
    repair(inputs);
  }
  EXPECT_EQ(evaluate_interlock(inputs, {}), Interlock::kReady);
  for (std::size_t left_out = 0; left_out < repairs.size(); ++left_out) {
    inputs = wrong;
    for (std::size_t i = 0; i < repairs.size(); ++i) {
      if (i != left_out) repairs[i].second(inputs);
    }
    EXPECT_EQ(evaluate_interlock(inputs, {}), repairs[left_out].first) << "alone, " << left_out;
  }
  EXPECT_EQ(evaluate_interlock({}, {}), Interlock::kNoContour) << "what is not said is not allowed";
}

/// Numbers that binary fractions hold exactly.
TEST(Interlock, BoundsAreReachedByEqualityAlready) {
  const InterlockSettings settings{.corridor_m = 1.0,
                                   .reaction_s = 0.25,
                                   .measurement_m = 0.125,
                                   .max_tracking_error_m = 0.5,
                                   .max_offset_m = 0.25};
  auto inputs = good();
  inputs.speed_m_per_s = 0.5;
  inputs.contour_distance_m = 0.75;  // + 0.5 x 0.25 + 0.125 = 1
  EXPECT_EQ(evaluate_interlock(inputs, settings), Interlock::kOutsideCorridor);
  inputs.contour_distance_m = below(0.75) - 1e-15;
  EXPECT_EQ(evaluate_interlock(inputs, settings), Interlock::kReady);
  inputs.tracking_error_m = 0.5;
  EXPECT_EQ(evaluate_interlock(inputs, settings), Interlock::kTracking);
  inputs.tracking_error_m = below(0.5);
  EXPECT_EQ(evaluate_interlock(inputs, settings), Interlock::kReady);
  inputs.offset_m = 0.25;
  EXPECT_EQ(evaluate_interlock(inputs, settings), Interlock::kTracking);
  inputs.offset_m = below(0.25);
  EXPECT_EQ(evaluate_interlock(inputs, settings), Interlock::kReady) << "the two are not added up";
}

/// Half a millimetre, less 20 um that sensors do not see, less 3 ms of way; 50 um to where it is wanted, 2 um
/// left of an approach.
TEST(Interlock, AsItIsSetTheCorridorIsHalfAMillimetreAndAFastToolIsStoppedEarlier) {
  for (const double speed_m_per_s : {0.0, 0.02, 0.1}) {
    auto inputs = good();
    inputs.speed_m_per_s = speed_m_per_s;
    const double bound_m = 0.5e-3 - 20e-6 - 3e-3 * speed_m_per_s;
    inputs.contour_distance_m = bound_m - 1e-9;
    EXPECT_EQ(evaluate_interlock(inputs, {}), Interlock::kReady) << speed_m_per_s;
    inputs.contour_distance_m = bound_m + 1e-9;
    EXPECT_EQ(evaluate_interlock(inputs, {}), Interlock::kOutsideCorridor) << speed_m_per_s;
  }
  auto inputs = good();
  inputs.tracking_error_m = 50e-6 - 1e-9;
  EXPECT_EQ(evaluate_interlock(inputs, {}), Interlock::kReady);
  inputs.tracking_error_m = 50e-6 + 1e-9;
  EXPECT_EQ(evaluate_interlock(inputs, {}), Interlock::kTracking);
  inputs = good();
  inputs.offset_m = 2e-6 - 1e-9;
  EXPECT_EQ(evaluate_interlock(inputs, {}), Interlock::kReady);
  inputs.offset_m = 2e-6 + 1e-9;
  EXPECT_EQ(evaluate_interlock(inputs, {}), Interlock::kTracking);
}

TEST(Interlock, WhatIsNotSaidIsZero) {
  const InterlockInputs nothing;
  EXPECT_FALSE(nothing.stopped || nothing.contour_known || nothing.engaged || nothing.fresh ||
               nothing.inside_workspace);
  for (const double value :
       {nothing.contour_distance_m, nothing.speed_m_per_s, nothing.tracking_error_m, nothing.offset_m})
    EXPECT_EQ(value, 0.0);
}

TEST(Interlock, NotANumberAndInfinityForbid) {
  for (const double wrong : {kNan, kInfinite}) {
    auto inputs = good();
    inputs.contour_distance_m = wrong;
    EXPECT_EQ(evaluate_interlock(inputs, {}), Interlock::kOutsideCorridor);
    inputs = good();
    inputs.speed_m_per_s = wrong;
    EXPECT_EQ(evaluate_interlock(inputs, {}), Interlock::kOutsideCorridor);
    inputs = good();
    inputs.tracking_error_m = wrong;
    EXPECT_EQ(evaluate_interlock(inputs, {}), Interlock::kTracking);
    inputs = good();
    inputs.offset_m = wrong;
    EXPECT_EQ(evaluate_interlock(inputs, {}), Interlock::kTracking);
  }
}

}  // namespace
}  // namespace telekerf::laser
