// SPDX-License-Identifier: Apache-2.0
// Photographs as they are found on a computer: what was judged by eye (judged.csv) is still found. Where the
// packages that hold them are not installed there is nothing to look at; test_things.cpp draws its own.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "common/vision/load.h"

namespace telekerf::vision {
namespace {

namespace fs = std::filesystem;

struct Judged {
  std::string file;
  std::vector<double> at;
  std::string verdict;
  std::size_t contours = 0;
  double area_px = 0.0;
  Vec2 min = Vec2::Zero();
  Vec2 max = Vec2::Zero();
};

std::vector<Judged> table() {
  std::ifstream in(TELEKERF_JUDGED);
  std::vector<Judged> out;
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with('#') || line.starts_with("file;")) continue;
    std::istringstream cells(line);
    std::vector<std::string> cell;
    for (std::string c; std::getline(cells, c, ';');) cell.push_back(c);
    if (cell.size() < 9) {
      ADD_FAILURE() << "a row of judged.csv has too few cells: " << line;
      continue;
    }
    Judged row{cell[0], {}, cell[2], std::stoul(cell[3]), std::stod(cell[4]), {}, {}};
    std::istringstream at(cell[1]);
    for (double v = 0.0; at >> v;) row.at.push_back(v);
    row.min = Vec2(std::stod(cell[5]), std::stod(cell[6]));
    row.max = Vec2(std::stod(cell[7]), std::stod(cell[8]));
    out.push_back(row);
  }
  return out;
}

fs::path path_of(const std::string& file) {
  if (file.starts_with("S/")) return fs::path("/usr/lib/python3/dist-packages/skimage/data") / file.substr(2);
  return fs::path("/usr/share/doc/opencv-doc/examples") / file;
}

/// In pixels: one metre a pixel, y upwards about the picture's middle.
tl::expected<LoadedContours, std::string> contours_of_file(const Judged& row) {
  LoadRequest request;
  request.scale.metres_per_pixel = 1.0;
  request.scale.anchor = AnchorMode::kImageCentre;
  if (!row.at.empty()) request.pointing.at = {Vec2(row.at[0], row.at[1])};
  return load_contours(path_of(row.file).string(), request);
}

TEST(Photographs, TheTableHoldsEnoughThatIsRight) {
  std::map<std::string, bool> right;  // of each photograph, without a word or with one pixel of the thing
  for (const Judged& row : table()) right[row.file] = right[row.file] || row.verdict == "right";
  const auto all = static_cast<int>(right.size());
  const auto good =
      static_cast<int>(std::count_if(right.begin(), right.end(), [](const auto& file) { return file.second; }));
  EXPECT_GE(all, 60);
  EXPECT_GE(6 * good, 5 * all) << good << " of " << all;  // 50 of 60
}

TEST(Photographs, WhatWasJudgedByEyeIsStillFound) {
  int seen = 0;
  for (const Judged& row : table()) {
    if (!fs::exists(path_of(row.file))) continue;
    ++seen;
    const auto found = contours_of_file(row);
    if (row.verdict == "refused") {
      ASSERT_FALSE(found) << row.file;
      EXPECT_NE(found.error().find("--box"), std::string::npos) << found.error();
      continue;
    }
    ASSERT_TRUE(found) << row.file << ": " << found.error();
    EXPECT_EQ(found->contours.size(), row.contours) << row.file;
    const geometry::Polyline& line = found->contours.front();
    const Vec2 middle(0.5 * (found->picture_width_px - 1), 0.5 * (found->picture_height_px - 1));
    const geometry::Box box = geometry::bounding_box(line.points_m);
    const Vec2 min = middle + Vec2(box.min.x(), -box.max.y());
    const Vec2 max = middle + Vec2(box.max.x(), -box.min.y());
    const double slack = 2.0 + 0.02 * (row.max - row.min).norm();
    EXPECT_LT((min - row.min).norm(), slack) << row.file;
    EXPECT_LT((max - row.max).norm(), slack) << row.file;
    double twice = 0.0;
    for (std::size_t i = 0; i < line.size(); ++i)
      twice += geometry::cross(line.points_m[i], line.points_m[(i + 1) % line.size()]);
    EXPECT_NEAR(std::abs(0.5 * twice), row.area_px, 0.04 * row.area_px + 20.0) << row.file;
  }
  if (seen == 0) {
    std::puts("skipped: Debian's package opencv-doc is not installed, so there are no photographs to try");
    GTEST_SKIP();
  }
  std::printf("%d photographs\n", seen);
}

TEST(Photographs, ScenesWithoutAThingAreRefusedWithTheRemedy) {
  int seen = 0;
  for (const char* file :
       {"data/aero1.jpg",        "data/aero3.jpg",        "data/aloeL.jpg",        "data/baboon.jpg",
        "data/basketball1.png",  "data/board.jpg",        "data/box.png",          "data/box_in_scene.png",
        "data/building.jpg",     "data/butterfly.jpg",    "data/chicky_512.png",
        "data/fruits.jpg",       "data/gradient.png",     "data/graf1.png",        "data/home.jpg",
        "data/leuvenA.jpg",      "data/left.jpg",         "data/left01.jpg",       "data/messi5.jpg",
        "data/ml.png",           "data/orange.jpg",       "data/pic6.png",         "data/right.jpg",
        "data/rubberwhale1.png", "data/squirrel_cls.jpg", "data/starry_night.jpg", "data/text_motion.jpg",
        "hfs/data/000.jpg",      "hfs/data/001.jpg",      "hfs/data/002.jpg",      "reg/home.png",
        "reg/LR_05.png",         "fuzzy/input.png"}) {
    if (!fs::exists(path_of(file))) continue;
    ++seen;
    const auto found = contours_of_file({file, {}, "refused", 0, 0.0, {}, {}});
    ASSERT_FALSE(found) << file;
    EXPECT_NE(found.error().find("--at X,Y"), std::string::npos) << found.error();
  }
  if (seen == 0) GTEST_SKIP();
}

}  // namespace
}  // namespace telekerf::vision
