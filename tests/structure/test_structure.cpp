// SPDX-License-Identifier: Apache-2.0
// The repository keeps the rules of the house (rules.h); rooms.txt says who may include whom.
#include <gtest/gtest.h>

#include "tests/structure/breaches.h"
#include "tests/structure/rules.h"

namespace telekerf::structure {
namespace {

const Repository& repository() {
  static const Repository kRepository = read_repository(TELEKERF_SOURCE_DIR);
  return kRepository;
}

const Rooms& rooms() {
  static const Rooms kRooms(repository().files.at("tests/structure/rooms.txt"));
  return kRooms;
}

TEST(House, ThereIsMuchToLookAt) {
  ASSERT_TRUE(repository().holds("common/runtime/clock.h"));
  EXPECT_GT(repository().files.size(), 300u);
  EXPECT_GT(includes_of(repository(), "master/station.cpp").size(), 2u);
  for (const auto& [room, row] : rooms().rows())
    EXPECT_TRUE(repository().holds(room) || repository().holds_folder(room)) << room;
}

TEST(House, IncludesGoOnlyWhereTheTableLetsThem) { expect_none(upward_arrows(repository(), rooms())); }
TEST(House, NothingIncludesItself) { expect_none(include_cycles(repository(), rooms())); }
TEST(House, WhatIsSharedIsNoProgram) { expect_none(programs_in_common(repository())); }
TEST(House, FastDdsStaysBehindTheBus) { expect_none(strayed_dds(repository())); }
TEST(House, NoFileIsTooLong) { expect_none(long_files(repository())); }
TEST(House, SourcesHaveTheirHeadersBesideThem) { expect_none(unpaired_files(repository())); }
TEST(House, SourcesOfOneLibraryCanBeCompiledTogether) { expect_none(colliding_names(repository())); }
TEST(House, EverySourceNamesItsLicence) { expect_none(missing_licence(repository())); }
TEST(House, FilesAndPagesThatAreNamedExist) { expect_none(dead_mentions(repository())); }
TEST(House, ProgramsThatAreNamedExist) { expect_none(dead_programs(repository())); }

}  // namespace
}  // namespace telekerf::structure
