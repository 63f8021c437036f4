// SPDX-License-Identifier: Apache-2.0
// Claims against what the experiments left: held, not held, or not assessed.
#pragma once

#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "common/reporting/page_tables.h"
#include "experiments/report/manifest.h"

namespace telekerf::experiments {

enum class Verdict : std::uint8_t { kHeld, kNotHeld, kNotAssessed };
std::string verdict_text(Verdict verdict);

struct Judged {
  Claim claim;
  std::optional<double> value;  ///< in the claim's unit
  Verdict verdict = Verdict::kNotAssessed;
  std::string why;  ///< it was not assessed
};

/// "known" of what is known to miss and does; of what no longer does, that and what to do; else empty.
std::string remark_of(const Judged& judged);

/// What stands at `/key/0/key=value&other=value/key`: in an array a step is a place, or the first element
/// whose members are these. A null on the way is where it ends: nothing was measured there. Null pointer: no
/// such thing stands there.
const nlohmann::ordered_json* node_at(const nlohmann::ordered_json& json, const std::string& pointer);

/// The number that stands there (true and false are 1 and 0); none: nothing does, or it is no number.
std::optional<double> select(const nlohmann::ordered_json& json, const std::string& pointer);

/// Results by experiments' names; what is not among them is not assessed.
using ResultsByName = std::map<std::string, nlohmann::ordered_json>;
std::vector<Judged> judge(const Manifest& manifest, const ResultsByName& results, bool quick);

/// Nothing missed but what is known to be missed.
bool all_held(const std::vector<Judged>& judged);

/// A figure as pages show it; "-" if there is none.
std::string value_text(const Judged& judged);

/// Rows of claims.json.
nlohmann::ordered_json claims_json(const std::vector<Judged>& judged);

/// What another claims.json has otherwise: a sentence a claim, and one for each that only the other has.
std::vector<std::string> differences(const std::vector<Judged>& judged, const nlohmann::ordered_json& other);

/// `headline` of the README, `claims` of docs/results/claims.md.
reporting::PageTable headline_table(const std::vector<Judged>& judged);
reporting::PageTable claims_table(const std::vector<Judged>& judged);

}  // namespace telekerf::experiments
