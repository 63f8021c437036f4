// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "experiments/autofocus/focus_rivals.h"
#include "slave/vision/imaging/targets.h"

namespace telekerf::imaging {
namespace {

using experiments::FocusStart;
using experiments::StartKind;

/// A picture of a texture blurred as half a pixel a depth of field would, without optics or axes.
class Plain {
 public:
  explicit Plain(double peak_m, const cv::Mat& texture = draw_target(Target::kRelief, 128, 1.0, 3))
      : peak_m_(peak_m), texture_(texture) {}

  cv::Mat at(double position_m) {
    const double z = (position_m - peak_m_) / 1e-3;
    cv::Mat out;
    cv::GaussianBlur(texture_, out, {}, std::hypot(0.6, 0.9 * z));
    cv::Mat noise(out.size(), CV_32F);
    random_.fill(noise, cv::RNG::NORMAL, 0.0, 2.0);
    out += noise;
    out.convertTo(out, CV_8U);
    return out;
  }
  double peak_m_;

 private:
  cv::Mat texture_;
  cv::RNG random_{5};
};

const FocusRange kRange{.start_m = 0.015,
                        .lowest_m = 0.0,
                        .highest_m = 0.03,
                        .depth_of_field_m = 1e-3,
                        .peak_width_dof = 1.85 * 0.6 / 0.9};

std::vector<double> run(FocusSearch& search, Plain& scene) {
  std::vector<double> places;
  while (const auto next_m = search.next_m()) {
    places.push_back(*next_m);
    search.seen(scene.at(*next_m), *next_m);
  }
  return places;
}

/// Those that are marked.
std::array<bool, kTiles> tiles_of(const std::array<const char*, kTileRows>& rows) {
  std::array<bool, kTiles> tiles{};
  for (std::size_t tile = 0; tile < kTiles; ++tile)
    tiles[tile] = rows[tile / kTileColumns][tile % kTileColumns] == '#';
  return tiles;
}

TEST(FocusSearch, ASpanIsOfTilesThatTouch) {
  EXPECT_EQ(longest_span({}), 0);
  EXPECT_EQ(longest_span(tiles_of({"#.......", "........", "........", "........", "........", "........",
                                   "........", "........"})),
            1);
  // Corners count; over rows as over columns.
  EXPECT_EQ(longest_span(tiles_of({"#.......", ".#......", "..#.....", "...#....", "....#...", ".....#..",
                                   "......#.", ".......#"})),
            8);
  EXPECT_EQ(longest_span(tiles_of({"...##...", "..#.....", "..#.....", "...#....", "........", "........",
                                   "........", "........"})),
            4);
  // A row or a column in between parts them, on either side.
  EXPECT_EQ(longest_span(tiles_of({".#......", "........", ".##.....", "........", "...#....", "........",
                                   "......#.", "......#."})),
            2);
  EXPECT_EQ(longest_span(tiles_of({"........", "........", "........", "#.#.#.##", "........", "........",
                                   "........", "........"})),
            2);
  EXPECT_EQ(longest_span(tiles_of({"#......#", "........", "........", "........", "........", "........",
                                   "........", "#......#"})),
            1);
}

TEST(FocusSearch, WhatStandsOutDoesSoByAShareAndBySixDeviationsOfADifference) {
  const double noise = 6.0 * std::sqrt(2.0) * 0.01;
  EXPECT_TRUE(rises(1.05 + noise + 1e-9, 1.0, 0.05, 0.01));
  EXPECT_FALSE(rises(1.05 + noise - 1e-9, 1.0, 0.05, 0.01));
  EXPECT_TRUE(rises(2.2 + 1e-9, 2.0, 0.1, 0.0));
  EXPECT_FALSE(rises(2.2 - 1e-9, 2.0, 0.1, 0.0));
  EXPECT_FALSE(rises(1.0, 1.0, 0.0, 0.0)) << "a flat sweep";
}

TEST(FocusSearch, FindsTheFocusOfAPlainScene) {
  for (const double peak_m : {0.0061, 0.0113, 0.015, 0.0187, 0.0246}) {
    Plain scene(peak_m);
    FocusSearch search = FocusSearch::everywhere({}, kRange, {});
    run(search, scene);
    ASSERT_TRUE(search.result().found()) << peak_m << kFocusVerdicts.word(search.result().verdict);
    EXPECT_NEAR(search.result().position_m, peak_m, 0.1e-3);
    EXPECT_EQ(search.result().pictures, 24);
    EXPECT_NEAR(search.result().noise_variance, 4.0, 0.4);
    EXPECT_NEAR(search.result().width_dof, kRange.peak_width_dof, 0.3 * kRange.peak_width_dof);
    EXPECT_GT(search.result().tenengrad, 0.0);
    EXPECT_GT(search.result().variance, 0.0);
  }
}

TEST(FocusSearch, GoesUpwardsInEverySweep) {
  Plain scene(0.0183);
  FocusSearch search = FocusSearch::everywhere({}, kRange, {});
  const std::vector<double> places = run(search, scene);
  ASSERT_EQ(places.size(), 24U);
  EXPECT_EQ(places[0], kRange.start_m);
  EXPECT_EQ(places[1], kRange.start_m);
  for (int i = 0; i < 13; ++i) EXPECT_NEAR(places[2 + i], 0.003 + 2e-3 * i, 1e-9);  // coarse
  for (int i = 1; i < 7; ++i) EXPECT_NEAR(places[15 + i] - places[14 + i], 0.5e-3, 1e-9);
  EXPECT_NEAR(places[18], 0.0183, 0.4e-3);  // the middle of the fine sweep
  EXPECT_EQ(places[22], places[23]);        // the second look
}

TEST(FocusSearch, NearTheRidgeTakesSevenPictures) {
  Plain scene(0.0156);
  Background background;
  background.noise_variance = 4.0;
  FocusSearch search = FocusSearch::nearby({}, kRange, background);
  const std::vector<double> places = run(search, scene);
  ASSERT_TRUE(search.result().found());
  EXPECT_NEAR(search.result().position_m, 0.0156, 0.06e-3);
  ASSERT_EQ(places.size(), 7U);
  for (int i = 0; i < 5; ++i) EXPECT_NEAR(places[i], 0.015 + 0.7e-3 * (i - 2), 1e-9);
  EXPECT_EQ(search.result().noise_variance, 4.0);
}

TEST(FocusSearch, GoesOnBeyondTheEndOfASweepWhereThePeakIs) {
  for (const double peak_m : {0.0131, 0.0172}) {
    Plain scene(peak_m);
    Background background;
    background.noise_variance = 4.0;
    FocusSearch search = FocusSearch::nearby({}, kRange, background);
    run(search, scene);
    ASSERT_TRUE(search.result().found()) << peak_m;
    EXPECT_NEAR(search.result().position_m, peak_m, 0.1e-3);
    EXPECT_GT(search.result().pictures, 7);
    EXPECT_LE(search.result().pictures, 10);
  }
}

TEST(FocusSearch, StaysWithinTheAxis) {
  FocusRange range = kRange;
  range.start_m = 0.004;
  range.highest_m = 0.011;
  Plain scene(0.0062);
  FocusSearch search = FocusSearch::everywhere({}, range, {});
  for (const double place : run(search, scene)) {
    EXPECT_GE(place, range.lowest_m);
    EXPECT_LE(place, range.highest_m);
  }
  EXPECT_TRUE(search.result().found());
  EXPECT_NEAR(search.result().position_m, 0.0062, 0.1e-3);
}

TEST(FocusSearch, AtTheEndOfTheAxisIsOutOfRange) {
  FocusRange range = kRange;
  range.highest_m = 0.0205;
  Plain scene(0.0235);
  FocusSearch search = FocusSearch::everywhere({}, range, {});
  run(search, scene);
  EXPECT_EQ(search.result().verdict, FocusVerdict::kOutOfRange);
  EXPECT_FALSE(search.next_m());
}

TEST(FocusSearch, WithoutRoomForASinglePictureIsOutOfRange) {
  FocusRange range = kRange;
  range.start_m = 0.1;
  EXPECT_EQ(FocusSearch::nearby({}, range, {}).result().verdict, FocusVerdict::kOutOfRange);
}

TEST(FocusSearch, WhatIsSeenAfterwardsChangesNothing) {
  Plain scene(0.015);
  FocusSearch search = FocusSearch::everywhere({}, kRange, {});
  run(search, scene);
  const FocusResult before = search.result();
  search.seen(scene.at(0.02), 0.02);
  EXPECT_EQ(search.result().pictures, before.pictures);
  EXPECT_EQ(search.result().position_m, before.position_m);
}

/// The last pictures show something else than those before.
FocusVerdict verdict_if(const std::function<void(Plain&, int picture)>& change) {
  Plain scene(0.0163);
  FocusSearch search = FocusSearch::everywhere({}, kRange, {});
  int picture = 0;
  while (const auto next_m = search.next_m()) {
    change(scene, picture++);
    search.seen(scene.at(*next_m), *next_m);
  }
  return search.result().verdict;
}

TEST(FocusSearch, ASecondLookThatIsLessSharpIsNoFocus) {
  EXPECT_EQ(verdict_if([](Plain&, int) {}), FocusVerdict::kFound);
  EXPECT_EQ(verdict_if([](Plain& scene, int picture) {
              if (picture == 22) scene.peak_m_ += 1e-3;
            }),
            FocusVerdict::kNotRepeated);
}

TEST(FocusSearch, WhatMovesBetweenTwoPicturesAtRestIsNoFocus) {
  for (const int when : {1, 23}) {
    EXPECT_EQ(verdict_if([&](Plain& scene, int picture) {
                if (picture == when) scene.peak_m_ += 2e-3;
              }),
              FocusVerdict::kMoving)
        << when;
  }
}

TEST(FocusSearch, APeakThatTheOpticsDoNotMakeIsNone) {
  for (const double factor : {0.2, 4.0}) {
    FocusRange range = kRange;
    range.peak_width_dof *= factor;
    Plain scene(0.0163);
    FocusSearch search = FocusSearch::everywhere({}, range, {});
    run(search, scene);
    EXPECT_EQ(search.result().verdict, FocusVerdict::kNoPeak) << factor;
    EXPECT_EQ(search.result().pictures, 22);
  }
}

FocusVerdict verdict_on(const cv::Mat& texture) {
  Plain scene(0.0163, texture);
  FocusSearch search = FocusSearch::everywhere({}, kRange, {});
  run(search, scene);
  return search.result().verdict;
}

TEST(FocusSearch, ADrawnLineIsAFocusAndSpecksAreNone) {
  cv::Mat line(128, 128, CV_32F, cv::Scalar(215));
  cv::circle(line, {64, 64}, 50, cv::Scalar(40), 2, cv::LINE_AA);
  EXPECT_EQ(verdict_on(line), FocusVerdict::kFound);
  cv::Mat arc(128, 128, CV_32F, cv::Scalar(215));  // as many tiles as specks take, but they hang together
  cv::ellipse(arc, {64, 70}, {52, 30}, 0.0, 180.0, 360.0, cv::Scalar(40), 4, cv::LINE_AA);
  EXPECT_EQ(verdict_on(arc), FocusVerdict::kFound);
  cv::Mat specks(128, 128, CV_32F, cv::Scalar(215));
  for (const cv::Point& at : {cv::Point(32, 32), {96, 32}, {32, 96}, {96, 96}})  // four tiles each
    cv::circle(specks, at, 3, cv::Scalar(40), cv::FILLED, cv::LINE_AA);
  EXPECT_EQ(verdict_on(specks), FocusVerdict::kSpecks);
}

TEST(FocusSearch, ASecondLookIsTheMeanOfItsTwoPictures) {
  Plain scene(0.0163);
  FocusSearch search = FocusSearch::everywhere({}, kRange, {});
  std::vector<cv::Mat> pictures;
  while (const auto next_m = search.next_m()) {
    pictures.push_back(scene.at(*next_m));
    search.seen(pictures.back(), *next_m);
  }
  Background background;
  background.noise_variance = search.result().noise_variance;
  const Sharpness a = sharpness_of(pictures[22], background);
  const Sharpness b = sharpness_of(pictures[23], background);
  ASSERT_NE(a.tenengrad, b.tenengrad);
  EXPECT_DOUBLE_EQ(search.result().tenengrad, 0.5 * (a.tenengrad + b.tenengrad));
  EXPECT_DOUBLE_EQ(search.result().variance, 0.5 * (a.variance + b.variance));
}

TEST(FocusSearch, PeakWidthIsTheOptics) {
  const Optics optics;
  EXPECT_NEAR(peak_width_dof(optics, 0.2), 1.85 * 0.6 / optics.blur_px_per_dof(0.2), 1e-12);
}

// In the simulated unit, with axes, dust and noise: starts drawn at random.

TEST(FocusSearch, FindsEveryTargetFromEveryStart) {
  for (const Target target : {Target::kRelief, Target::kTissue, Target::kLetter}) {
    for (std::uint64_t seed = 5001; seed <= 5010; ++seed) {
      auto drawn = experiments::draw_start({target, StartKind::kUsual, seed});
      const auto outcome = experiments::by_search(*drawn.unit, drawn.range);
      EXPECT_TRUE(outcome.success()) << kTargets.word(target) << " " << seed << " "
                                     << kFocusVerdicts.word(outcome.verdict);
      EXPECT_LT(std::abs(outcome.error_dof), 0.2);
      EXPECT_LE(outcome.pictures, 26);
      EXPECT_EQ(outcome.pictures, drawn.unit->pictures());
    }
  }
}

TEST(FocusSearch, FindsNothingWhereNothingIs) {
  for (std::uint64_t seed = 5001; seed <= 5012; ++seed) {
    for (const FocusStart& start : {FocusStart{Target::kBlank, StartKind::kUsual, seed},
                                    FocusStart{Target::kTissue, StartKind::kOutOfRange, seed},
                                    FocusStart{Target::kRelief, StartKind::kOutOfRange, seed},
                                    FocusStart{Target::kLetter, StartKind::kMoving, seed},
                                    FocusStart{Target::kRelief, StartKind::kMoving, seed}}) {
      auto drawn = experiments::draw_start(start);
      const auto outcome = experiments::by_search(*drawn.unit, drawn.range);
      EXPECT_FALSE(outcome.claimed) << kTargets.word(start.target) << " " << seed;
      EXPECT_NE(outcome.verdict, FocusVerdict::kFound);
    }
  }
}

TEST(FocusSearch, DustAloneIsNamedAsSpecksOrNothing) {
  bool specks = false;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    auto drawn = experiments::draw_start({Target::kBlank, StartKind::kUsual, seed});
    const FocusVerdict verdict = experiments::by_search(*drawn.unit, drawn.range).verdict;
    specks = specks || verdict == FocusVerdict::kSpecks;
    EXPECT_TRUE(verdict == FocusVerdict::kSpecks || verdict == FocusVerdict::kBlank ||
                verdict == FocusVerdict::kOutOfRange)
        << seed << " " << kFocusVerdicts.word(verdict);
  }
  EXPECT_TRUE(specks);
}

}  // namespace
}  // namespace telekerf::imaging
