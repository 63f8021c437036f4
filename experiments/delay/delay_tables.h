// SPDX-License-Identifier: Apache-2.0
// The tables of docs/results/delay.md, made from the runs, and a cell's run made again from its place in
// them.
#pragma once

#include <string>
#include <vector>

#include "common/reporting/page_tables.h"
#include "experiments/delay/delay_runs.h"

namespace telekerf::experiments {

/// A column over round trip, jitter and loss.
struct Condition {
  double rtt_ms, jitter_ms, loss;
};
std::span<const Condition> table_conditions();

/// "0.71", "13.4", "204" or "unstable".
std::string cell(const DelayResult& result, double DelayResult::*what);

/// `tracking`, `prediction`, `tuning` and `profiles`.
std::vector<reporting::PageTable> delay_tables(const std::vector<Run>& runs);

/// Of a cell of `tuning` in the page's own words: the values in order, "12; 300".
std::vector<Tuned> parsed_tuning(const DelayTrial& trial, const std::string& cell);

}  // namespace telekerf::experiments
