// SPDX-License-Identifier: Apache-2.0
// What is cut so far survives a restart of the console, of the same piece of work alone.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "master/console/cell_view.h"
#include "tests/unit/streaming/blocks.h"

namespace telekerf::master {
namespace {

constexpr std::int64_t kMs = 1'000'000;

ContourMessage line(std::uint32_t id) {
  ContourMessage message;
  message.id = id;
  message.closed = false;
  message.points_m = {{0.0, -2e-3}, {0.02, -2e-3}};  // along it the slave of blocks.h moves
  return message;
}

void step(CellView& view, streaming::Sender<StateBlock>& slave, bool laser_on) {
  StateBlock block = slave.next();
  block.laser_on = laser_on;
  view.hear({block, 1000 * kMs});
}

/// Half a second of light along the contour 4 by the slave 7.
CutSoFar cut() {
  CellView view;
  streaming::Sender<StateBlock> slave(7);
  view.hear(line(4));
  EXPECT_FALSE(view.news_of_cut());
  for (int n = 0; n < 30; ++n) step(view, slave, true);
  const auto news = view.news_of_cut();
  EXPECT_FALSE(view.news_of_cut()) << "nothing has changed";
  step(view, slave, true);
  EXPECT_TRUE(view.news_of_cut());
  return news.value_or(CutSoFar{});
}

TEST(CutMemory, TheSameWorkIsShownAgainWhateverComesFirst) {
  const CutSoFar before = cut();
  ASSERT_GT(before.places_m.size(), 100u);
  for (const bool contour_first : {true, false}) {
    CellView view;
    streaming::Sender<StateBlock> slave(7, 1000);
    view.remember(before);
    if (contour_first) view.hear(line(4));
    step(view, slave, false);
    EXPECT_FALSE(contour_first ? std::nullopt : view.news_of_cut()) << "not written over before it is known";
    if (!contour_first) view.hear(line(4));
    step(view, slave, false);
    EXPECT_EQ(view.mark().size(), before.places_m.size());
    EXPECT_EQ(view.depths().lit_s(), before.lit_s);
    EXPECT_TRUE(view.news_of_cut());
  }
}

TEST(CutMemory, OfAnotherContourOrSlaveNothingIsShown) {
  CutSoFar other = cut();
  other.contour_id = 5;
  CutSoFar anew = cut();
  anew.slave_epoch = 8;
  for (const CutSoFar& before : {other, anew}) {
    CellView view;
    streaming::Sender<StateBlock> slave(7, 1000);
    view.remember(before);
    view.hear(line(4));
    step(view, slave, false);
    EXPECT_EQ(view.mark().size(), 0u);
    step(view, slave, true);
    EXPECT_TRUE(view.news_of_cut()) << "and the new work is kept";
  }
}

TEST(CutMemory, IsReadAsItWasWrittenAndDamagedNotAtAll) {
  const CutSoFar before = cut();
  const std::string text = text_of(before);
  const auto after = parse_cut(text);
  ASSERT_TRUE(after);
  EXPECT_EQ(after->contour_id, 4u);
  EXPECT_EQ(after->slave_epoch, 7u);
  EXPECT_EQ(after->lit_s, before.lit_s);
  ASSERT_EQ(after->places_m.size(), before.places_m.size());
  for (std::size_t n = 0; n < before.places_m.size(); ++n)
    ASSERT_LT((after->places_m[n] - before.places_m[n]).norm(), 1e-8) << n;
  for (const std::string& wrong : {std::string(), text.substr(1), text.substr(0, text.size() - 1), text + "x"})
    EXPECT_FALSE(parse_cut(wrong)) << wrong.size();
  std::string lies = text;
  lies[19] = '\x7f';  // more places than there can be
  EXPECT_FALSE(parse_cut(lies));
  std::string numberless = text;
  numberless.replace(48, 4, "\xff\xff\xff\xff");
  EXPECT_FALSE(parse_cut(numberless));
  std::string unknown = text;
  unknown.replace(24, 4, "gold");
  EXPECT_FALSE(parse_cut(unknown));
  std::string deep = text;
  deep[47] = '\x40';
  EXPECT_FALSE(parse_cut(deep)) << "2 m and more";
}

TEST(CutMemory, WhatWasSaidOfTheMaterialAndTheDepthComesBackWithTheWork) {
  CellView view;
  streaming::Sender<StateBlock> slave(7);
  view.hear(line(4));
  step(view, slave, false);
  EXPECT_FALSE(view.news_of_cut()) << "nothing is cut, and nobody has said anything";
  view.set_material(workpiece::kFibreglass);
  view.set_depth(0.3e-3);
  const auto kept = view.news_of_cut();
  ASSERT_TRUE(kept) << "also before anything is cut";
  const auto before = parse_cut(text_of(*kept));
  ASSERT_TRUE(before);
  const auto after = [&](std::uint32_t contour, const workpiece::Material* said) {
    CellView anew;
    streaming::Sender<StateBlock> same(7, 1000);
    anew.remember(*before);
    anew.hear(line(contour));
    if (said != nullptr) anew.set_material(*said);
    StateBlock block = same.next();
    block.contour_id = contour;
    anew.hear({block, 1000 * kMs});
    return anew.wish();
  };
  EXPECT_EQ(after(4, nullptr).material, &workpiece::kFibreglass);
  EXPECT_EQ(after(4, nullptr).depth_m, 0.3e-3);
  EXPECT_EQ(after(4, &workpiece::kWood).material, &workpiece::kWood) << "what is said anew holds";
  EXPECT_FALSE(after(5, nullptr).said()) << "of another piece of work nobody knows";
}

TEST(CutMemory, IsKeptInAFileAndWhatCannotBeKeptIsSaidOnce) {
  const auto folder = std::filesystem::temp_directory_path() / ("cut-" + std::to_string(::getpid()));
  const std::string file = (folder / "state" / "a.cut").string();
  std::vector<std::string> said;
  const auto complain = [&](const std::string& sentence) { said.push_back(sentence); };
  const CutSoFar before = cut();
  {
    CutMemory memory(file, complain);
    EXPECT_FALSE(memory.found());
    memory.keep(before);
  }
  EXPECT_EQ(CutMemory(file, complain).found().value_or(CutSoFar{}).places_m.size(), before.places_m.size());
  EXPECT_TRUE(said.empty());
  CutMemory("", complain).keep(before);
  for (int n = 0; n < 2; ++n) CutMemory(file + "/below-a-file", complain).keep(before);
  ASSERT_EQ(said.size(), 2u);
  EXPECT_NE(said[0].find("will be gone after a restart"), std::string::npos) << said[0];
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace telekerf::master
