// SPDX-License-Identifier: Apache-2.0
// docs/results/codec.md: rates are measured again, of every kind of trace one, and of what the demo recorded.
#include <gtest/gtest.h>

#include <algorithm>

#include "experiments/codec/codec_rates.h"
#include "experiments/codec/codec_recordings.h"
#include "tests/unit/page_cells.h"

namespace telekerf::experiments {
namespace {

TEST(CodecPage, RatesAreWhatItSays) {
  const auto page = reporting::read_table(TELEKERF_CODEC_PAGE, "rates");
  const auto rows = rate_rows();
  ASSERT_EQ(page.size(), rows.size() + 1);
  auto traces = seeded_traces(20.0, 1000.0, 1);
  for (auto& recorded : recorded_traces(20.0, 1)) traces.push_back(std::move(recorded));
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (rows[i].block != 16 || (rows[i].factor != 1.0 && rows[i].trace != "force")) continue;
    const auto trace = std::find_if(traces.begin(), traces.end(),
                                    [&](const auto& t) { return t.trace.name == rows[i].trace; });
    ASSERT_NE(trace, traces.end()) << rows[i].trace;
    const auto now = rate_cells(*trace, rows[i]);
    ASSERT_EQ(page[i + 1].size(), now.size());
    for (std::size_t c = 0; c < now.size(); ++c) expect_cell(page[i + 1][c], now[c], now[0]);
  }
}

}  // namespace
}  // namespace telekerf::experiments
