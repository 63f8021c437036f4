// SPDX-License-Identifier: Apache-2.0
// Figures of claims in the prose of pages: `0.68<!-- claim ID -->`, written anew by every full run.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "experiments/report/judgement.h"

namespace telekerf::experiments {

/// The page with the number before each mark replaced by the claim's figure, to as many decimals as the page
/// gives. Claims without a figure leave the page's.
std::string with_figures(const std::string& page, const std::vector<Judged>& judged);

/// Throws StartupError if `source` holds no README.md and docs/results/claims.md.
void require_pages(const std::filesystem::path& source);

/// README.md and docs/results/*.md below `source`: the tables `headline` and `claims`, and every marked
/// figure. Throws StartupError that names the file.
void write_pages(const std::filesystem::path& source, const std::vector<Judged>& judged);

}  // namespace telekerf::experiments
