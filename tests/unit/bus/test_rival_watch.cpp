// SPDX-License-Identifier: Apache-2.0
// Which of two masters gives way.
#include <gtest/gtest.h>

#include "common/bus/rival_watch.h"

namespace telekerf {
namespace {

using namespace std::chrono_literals;
using Obeyed = RivalWatch::Obeyed;
using Verdict = RivalWatch::Verdict;

TEST(RivalWatch, WhomTheSlaveObeysStaysAndWithoutASlaveTheFirst) {
  for (const bool second : {false, true}) {
    EXPECT_EQ(RivalWatch::judge(Obeyed::kUs, second, 1500ms), Verdict::kStays);
    EXPECT_EQ(RivalWatch::judge(Obeyed::kAnother, second, 1500ms), Verdict::kGivesWay);
    EXPECT_EQ(RivalWatch::judge(Obeyed::kNobody, second, 1500ms),
              second ? Verdict::kGivesWay : Verdict::kStays);
    for (const Obeyed obeyed : {Obeyed::kNobody, Obeyed::kUs, Obeyed::kAnother, Obeyed::kUnheard})
      EXPECT_EQ(RivalWatch::judge(obeyed, second, 1499ms), Verdict::kWaits);
  }
}

TEST(RivalWatch, OnOldWordOfTheSlaveNobodyStaysOrGivesWayUntilItSpeaksAgainOrIsGone) {
  for (const bool second : {false, true}) {
    EXPECT_EQ(RivalWatch::judge(Obeyed::kUnheard, second, 1500ms), Verdict::kWaits);
    EXPECT_EQ(RivalWatch::judge(Obeyed::kUnheard, second, 4999ms), Verdict::kWaits);
    EXPECT_EQ(RivalWatch::judge(Obeyed::kUnheard, second, 5s), second ? Verdict::kGivesWay : Verdict::kStays);
  }
}

}  // namespace
}  // namespace telekerf
