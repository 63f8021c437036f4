// SPDX-License-Identifier: Apache-2.0
// Nothing turns the beam on that should not, by enumeration: the judgement is a conjunction, so all pairs of
// guards with all classes of values, and random states for its monotony, are a proof of it.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <random>
#include <set>
#include <string>

#include "slave/laser/interlock.h"

namespace telekerf::laser {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();

/// What drives a guard: a flag and its good value, or a number.
struct Input {
  std::string_view guard;
  bool InterlockInputs::*flag = nullptr;
  bool good = true;
  double InterlockInputs::*number = nullptr;
  Limits limits{};
};

/// Limits that binary fractions hold exactly. The way of the reaction is left out: it would tie a number to
/// another one's limit.
InterlockSettings settings() {
  return {.corridor_m = 1.0,
          .reaction_s = 0.0,
          .measurement_m = 0.25,
          .max_tracking_error_m = 0.5,
          .max_offset_m = 0.25,
          .max_height_m = 0.75,
          .max_arc_gap_m = 2.0,
          .beam_age_s = 3.0,
          .max_look_age_s = 9.0,
          .min_cut_speed_m_per_s = 0.125,
          .max_dose_j = 5.0,
          .max_area_dose_j_per_mm2 = 6.0,
          .workspace_radius_m = 4.0,
          .max_speed_m_per_s = 8.0,
          .max_power_w = 7.0};
}

Input flag(std::string_view guard, bool InterlockInputs::*member, bool good = true) {
  return {.guard = guard, .flag = member, .good = good};
}
Input number(std::string_view guard, double InterlockInputs::*member, double high, double low = 0.0) {
  return {.guard = guard, .number = member, .limits = {low, high}};
}

using In = InterlockInputs;
/// A guard without a row here is not proved: the first test says so.
const std::array kInputs{flag("stop", &In::stopped, false),
                         flag("fault", &In::fault, false),
                         flag("contour", &In::contour_known),
                         flag("engaged", &In::engaged),
                         flag("armed", &In::armed),
                         flag("button", &In::button_armed),
                         flag("sample", &In::fresh),
                         flag("unlit", &In::unlit),
                         number("age", &In::command_age_s, 3.0),
                         number("workspace", &In::radius_m, 4.0),
                         number("height", &In::height_m, 0.75),
                         number("corridor", &In::contour_distance_m, 0.75),
                         number("arc", &In::arc_gap_m, 2.0),
                         number("predicted", &In::predicted_distance_m, 0.75),
                         number("offset", &In::offset_m, 0.25),
                         number("tracking", &In::tracking_error_m, 0.5),
                         number("speed", &In::speed_m_per_s, 8.0),
                         number("moving", &In::cut_speed_m_per_s, 8.0, 0.125),
                         number("power", &In::power_w, 7.0),
                         number("dose", &In::dose_j, 5.0),
                         number("area-dose", &In::area_dose_j_per_mm2, 6.0),
                         flag("on-time", &In::on_time),
                         flag("emission", &In::emission_agrees),
                         flag("monitor", &In::monitor_agrees),
                         number("look", &In::look_age_s, 9.0)};

/// Classes of values: of a number eight, of a flag its two.
constexpr std::size_t kClasses = 8;
constexpr std::array<bool, kClasses> kGood{false, false, false, true, true, true, false, false};

/// Of class `c`; true: it is good.
bool set(InterlockInputs& inputs, const Input& input, std::size_t c) {
  if (input.flag != nullptr) {
    inputs.*input.flag = kGood[c] == input.good;
    return kGood[c];
  }
  const auto& [low, high] = input.limits;
  const double values[kClasses] = {kAbsent,
                                   -kInfinite,
                                   std::nextafter(low, -kInfinite),
                                   low,
                                   0.5 * (low + high),
                                   high,
                                   std::nextafter(high + 1e-15, kInfinite),
                                   kInfinite};
  inputs.*input.number = values[c];
  return kGood[c];
}

constexpr std::size_t kInside = 4;

InterlockInputs all_inside() {
  InterlockInputs inputs;
  for (const Input& input : kInputs) set(inputs, input, kInside);
  return inputs;
}

/// Who moves too fast to say how fast may be anywhere: these values of the speed forbid by the corridor, too.
std::uint32_t also_forbidden(const Input& input, std::size_t c) {
  const bool no_magnitude = c <= 2 || c == 7;
  return input.guard == "speed" && no_magnitude ? guard_bit("corridor") : 0;
}

TEST(Guards, EachHasItsInputHereItsOwnNameAndASentence) {
  ASSERT_EQ(std::size(kInputs), kGuardCount);
  std::set<std::string_view> names;
  for (std::size_t n = 0; n < kGuardCount; ++n) {
    EXPECT_EQ(kInputs[n].guard, kGuards[n].name) << n;
    EXPECT_TRUE(names.insert(kGuards[n].name).second) << kGuards[n].name;
    EXPECT_GT(kGuards[n].sentence.size(), 15u) << kGuards[n].name;
    EXPECT_NE(kGuards[n].reason, Interlock::kReady) << kGuards[n].name;
    EXPECT_LE(kGuards[n].reason, kLastInterlock) << kGuards[n].name;
  }
}

TEST(Guards, ThePageHasThemAllInTheirOrder) {
  std::ifstream page(TELEKERF_CONTRACT_PAGE);
  std::size_t n = 0;
  for (std::string line; std::getline(page, line) && n < kGuardCount;) {
    if (!line.starts_with("| " + std::to_string(n) + " | ")) continue;
    const Guard& guard = kGuards[n];
    if (!line.starts_with("| " + std::to_string(n) + " | " + std::string(guard.name) + " | ")) continue;
    EXPECT_TRUE(line.starts_with("| " + std::to_string(n) + " | " + std::string(guard.name) + " | " +
                                 std::to_string(static_cast<int>(guard.reason)) + " | "))
        << line;
    ++n;
  }
  EXPECT_EQ(n, kGuardCount);
}

TEST(Guards, EveryPairWithEveryClassOfValuesForbidsByThoseThatAreBadAndByNoOther) {
  const InterlockSettings limits = settings();
  ASSERT_TRUE(evaluate_interlock(all_inside(), limits).permits());
  int judged = 0;
  for (std::size_t i = 0; i < kGuardCount; ++i) {
    for (std::size_t j = 0; j < kGuardCount; ++j) {
      for (std::size_t a = 0; a < kClasses; ++a) {
        for (std::size_t b = 0; b < kClasses; ++b) {
          if (i == j && a != b) continue;
          InterlockInputs inputs = all_inside();
          std::uint32_t expected = 0;
          if (!set(inputs, kInputs[i], a)) expected |= std::uint32_t{1} << i;
          if (!set(inputs, kInputs[j], b)) expected |= std::uint32_t{1} << j;
          expected |= also_forbidden(kInputs[i], a) | also_forbidden(kInputs[j], b);
          const Judgement judgement = evaluate_interlock(inputs, limits);
          ASSERT_EQ(judgement.forbidden, expected)
              << kGuards[i].name << " of class " << a << ", " << kGuards[j].name << " of class " << b;
          const bool first = (expected & (std::uint32_t{1} << std::min(i, j))) != 0;
          if (expected == 0) {
            ASSERT_EQ(judgement.reason(), Interlock::kReady);
          } else if (also_forbidden(kInputs[i], a) + also_forbidden(kInputs[j], b) == 0) {
            ASSERT_EQ(judgement.reason(), kGuards[first ? std::min(i, j) : std::max(i, j)].reason);
          }
          ++judged;
        }
      }
    }
  }
  EXPECT_EQ(judged,
            static_cast<int>(kGuardCount * (kGuardCount - 1) * kClasses * kClasses + kGuardCount * kClasses));
}

TEST(Guards, EachAloneIsEnoughHoweverGoodAllOthersAreAndNoOtherMakesUpForIt) {
  const InterlockSettings limits = settings();
  for (std::size_t i = 0; i < kGuardCount; ++i) {
    for (std::size_t a = 0; a < kClasses; ++a) {
      InterlockInputs inputs = all_inside();
      const bool good = set(inputs, kInputs[i], a);
      EXPECT_EQ(evaluate_interlock(inputs, limits).permits(), good) << kGuards[i].name << " of class " << a;
    }
  }
}

/// From good to bad nothing is gained. As many states as TELEKERF_STATES says; the long check says ten
/// million.
TEST(Guards, NoChangeOfAnInputFromGoodToBadTurnsTheBeamOn) {
  const char* const asked = std::getenv("TELEKERF_STATES");
  const long states = asked != nullptr ? std::strtol(asked, nullptr, 10) : 1'000'000;
  const InterlockSettings limits = settings();
  std::mt19937_64 random(1);
  long lit = 0;
  for (long n = 0; n < states; ++n) {
    InterlockInputs inputs;
    std::uint64_t bits = random();
    for (std::size_t i = 0; i < kGuardCount; ++i) {
      // Good as a rule: else hardly a state would be lit.
      const bool spoil = random() % 32 == 0;
      const std::size_t any = spoil ? random() % kClasses : 3 + (bits >> (2 * i)) % 3;
      set(inputs, kInputs[i], any);
    }
    const Judgement before = evaluate_interlock(inputs, limits);
    lit += before.permits() ? 1 : 0;
    const std::size_t k = random() % kGuardCount;
    constexpr std::size_t kBad[] = {0, 1, 2, 6, 7};
    set(inputs, kInputs[k], kBad[random() % 5]);
    const Judgement after = evaluate_interlock(inputs, limits);
    ASSERT_FALSE(after.permits()) << n << ": " << kGuards[k].name;
    const std::uint32_t others = ~(std::uint32_t{1} << k) & ~guard_bit("corridor");
    ASSERT_EQ(after.forbidden & others, before.forbidden & others) << n << ": " << kGuards[k].name;
  }
  EXPECT_GT(lit, states / 4);
  EXPECT_LT(lit, states);
}

}  // namespace
}  // namespace telekerf::laser
