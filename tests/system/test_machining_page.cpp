// SPDX-License-Identifier: Apache-2.0
// docs/results/machining.md: one picture of its tables is machined again.
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "experiments/machining/contour_tables.h"
#include "tests/system/programs.h"
#include "tests/unit/page_cells.h"

namespace telekerf::integration {
namespace {

namespace fs = std::filesystem;

TEST(MachiningPage, AnOctagonComesToWhatItSays) {
  const fs::path out = Program::scratch() / "machining-page";
  Program run("telekerf-experiment", {"closed-contour", "--image", "octagon", "--out", out.string()});
  ASSERT_EQ(run.wait(std::chrono::seconds(150)), 0) << run.output();
  std::ifstream in(out / "result.json");
  const auto tables =
      experiments::contour_tables(nlohmann::ordered_json::array({nlohmann::ordered_json::parse(in)}));
  const fs::path page = fs::path(TELEKERF_SOURCE_DIR) / "docs/results/machining.md";

  const auto contours = reporting::read_table(page, "contours");
  const auto now = reporting::read_rows(tables[0].markdown);
  const auto row =
      std::find_if(contours.begin(), contours.end(), [](const auto& cells) { return cells[0] == "octagon"; });
  ASSERT_NE(row, contours.end());
  for (std::size_t c = 0; c < row->size(); ++c) expect_cell((*row)[c], now[1][c], contours[0][c]);

  const auto terms = reporting::read_table(page, "terms");
  const auto fresh = reporting::read_rows(tables[1].markdown);
  const auto column = std::find(terms[0].begin(), terms[0].end(), "octagon") - terms[0].begin();
  ASSERT_EQ(terms.size(), fresh.size());
  for (std::size_t r = 0; r < terms.size(); ++r)
    expect_cell(terms[r].at(static_cast<std::size_t>(column)), fresh[r][1], terms[r][0]);
}

TEST(MachiningPage, TheWholeWorkOfAnOctagonComesToWhatItSays) {
  const fs::path out = Program::scratch() / "machine-page";
  Program run("telekerf-experiment", {"machine", "--image", "octagon", "--out", out.string()});
  ASSERT_EQ(run.wait(std::chrono::seconds(150)), 0) << run.output();
  std::ifstream in(out / "result.json");
  const auto now = reporting::read_rows(
      experiments::machine_table(nlohmann::ordered_json::parse(in)["pictures"]).markdown);
  const auto page =
      reporting::read_table(fs::path(TELEKERF_SOURCE_DIR) / "docs/results/machining.md", "machine");
  ASSERT_EQ(page.size(), 14u) << "every shipped picture";
  const auto row =
      std::find_if(page.begin(), page.end(), [](const auto& cells) { return cells[0] == "octagon"; });
  ASSERT_NE(row, page.end());
  for (std::size_t c = 0; c < row->size(); ++c) expect_cell((*row)[c], now[1][c], page[0][c]);
}

}  // namespace
}  // namespace telekerf::integration
