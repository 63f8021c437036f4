// SPDX-License-Identifier: Apache-2.0
// docs/results/constraint.md: every cell of its tables is measured again.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "experiments/constraint/constraint_curves.h"
#include "tests/unit/page_cells.h"

namespace telekerf::experiments {
namespace {

reporting::TableRows page_table(const std::string& name) {
  return reporting::read_table(TELEKERF_CONSTRAINT_PAGE, name);
}

TEST(ConstraintPage, CurvesAreAsNearAsItSays) {
  const auto page = page_table("curves");
  const auto contours = table_contours();
  const auto kind_of = [](const std::string& word) { return master::kCurves.find(word).value(); };
  ASSERT_EQ(page.size(), 1 + 2 * kTableWindows.size() + 1);
  for (std::size_t row = 1; row < page.size(); ++row) {
    ASSERT_EQ(page[row].size(), 2 + contours.size());
    const int k = page[row][1] == "-" ? 1 : std::stoi(page[row][1]);
    const auto station = curve_station(kind_of(page[row][0]), k);
    for (std::size_t c = 0; c < contours.size(); ++c) {
      EXPECT_EQ(page[0][c + 2], contours[c].source);
      const CurveError error = curve_error(contours[c], station);
      expect_cell(page[row][c + 2], curve_cell(1e6 * error.rms_m, 1e6 * error.max_m),
                  fmt::format("{} k = {} on {}", page[row][0], page[row][1], contours[c].source));
    }
  }
}

TEST(ConstraintPage, PushesGoAsFarAsItSays) {
  const auto page = page_table("pushes");
  ASSERT_EQ(page.size(), 1 + kTablePushes_n.size());
  for (std::size_t i = 0; i < kTablePushes_n.size(); ++i) {
    const auto now = push_row(kTablePushes_n[i], fight(kTablePushes_n[i], 1));
    ASSERT_EQ(page[i + 1].size(), now.size());
    for (std::size_t c = 0; c < now.size(); ++c) expect_cell(page[i + 1][c], now[c], now[0]);
  }
}

}  // namespace
}  // namespace telekerf::experiments
