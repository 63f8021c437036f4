// SPDX-License-Identifier: Apache-2.0
#include "experiments/report/judgement.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <sstream>

namespace telekerf::experiments {
namespace {

using nlohmann::ordered_json;

std::vector<std::string> parts_of(const std::string& text, char between) {
  std::vector<std::string> parts;
  std::istringstream in(text);
  for (std::string part; std::getline(in, part, between);) parts.push_back(part);
  return parts;
}

/// A member as it would be written in a pointer.
std::string word_of(const ordered_json& value) {
  return value.is_string()   ? value.get<std::string>()
         : value.is_number() ? fmt::format("{:g}", value.get<double>())
                             : value.dump();
}

bool fits(const ordered_json& element, const std::string& wanted) {
  const auto members = parts_of(wanted, '&');
  return std::all_of(members.begin(), members.end(), [&](const std::string& member) {
    const std::size_t equals = member.find('=');
    const auto found = element.find(member.substr(0, equals));
    return found != element.end() && word_of(*found) == member.substr(equals + 1);
  });
}

const ordered_json* step_into(const ordered_json& json, const std::string& step) {
  if (json.is_object()) {
    const auto found = json.find(step);
    return found == json.end() ? nullptr : &*found;
  }
  if (!json.is_array()) return nullptr;
  if (step.find('=') != step.npos) {
    const auto wanted = [&](const ordered_json& e) { return e.is_object() && fits(e, step); };
    const auto found = std::find_if(json.begin(), json.end(), wanted);
    // Of two that fit nobody knows which is meant.
    if (found == json.end() || std::find_if(std::next(found), json.end(), wanted) != json.end())
      return nullptr;
    return &*found;
  }
  std::size_t place = 0;
  const auto read = std::from_chars(step.data(), step.data() + step.size(), place);
  return read.ec == std::errc() && read.ptr == step.data() + step.size() && place < json.size() ? &json[place]
                                                                                                : nullptr;
}

bool holds(const Claim& claim, double value) {
  switch (claim.relation) {
    case Relation::kWithin:
      return std::abs(value - claim.bound) <= claim.tolerance;
    case Relation::kAtMost:
      return value <= claim.bound;
    case Relation::kAtLeast:
      return value >= claim.bound;
  }
  return false;
}

/// A cell holds no "|", and is not empty.
std::string cell(std::string text) {
  if (text.empty()) return "-";
  std::replace(text.begin(), text.end(), '|', '/');
  return text;
}

std::string figure(const Judged& row) {
  const std::string& unit = row.claim.unit;
  return value_text(row) + (row.value && !unit.empty() ? " " + unit : "");
}

}  // namespace

std::string verdict_text(Verdict verdict) {
  switch (verdict) {
    case Verdict::kHeld:
      return "held";
    case Verdict::kNotHeld:
      return "not held";
    case Verdict::kNotAssessed:
      return "not assessed";
  }
  return "";
}

std::string remark_of(const Judged& judged) {
  if (!judged.claim.negative || judged.verdict == Verdict::kNotAssessed) return "";
  return judged.verdict == Verdict::kNotHeld
             ? "known"
             : "held now, though the manifest says that it is known not to be: take its negative = true away";
}

const ordered_json* node_at(const ordered_json& json, const std::string& pointer) {
  const ordered_json* at = &json;
  for (const std::string& step : parts_of(pointer, '/')) {
    if (step.empty()) continue;
    at = step_into(*at, step);
    if (at == nullptr || at->is_null()) break;
  }
  return at;
}

std::optional<double> select(const ordered_json& json, const std::string& pointer) {
  const ordered_json* at = node_at(json, pointer);
  if (at == nullptr) return std::nullopt;
  if (at->is_boolean()) return at->get<bool>() ? 1.0 : 0.0;
  if (!at->is_number()) return std::nullopt;
  const double value = at->get<double>();
  return std::isfinite(value) ? std::optional(value) : std::nullopt;
}

std::vector<Judged> judge(const Manifest& manifest, const ResultsByName& results, bool quick) {
  std::vector<Judged> out;
  for (const Claim& claim : manifest.claims) {
    Judged row{.claim = claim, .value = {}, .why = {}};
    const auto result = results.find(claim.experiment);
    if (result == results.end()) {
      row.why = "the experiment was not run";
    } else if (quick && !claim.quick) {
      row.why = "wants the full run";
    } else if (const auto value = select(result->second, claim.pointer)) {
      row.value = claim.factor * *value;
      row.verdict = holds(claim, *row.value) ? Verdict::kHeld : Verdict::kNotHeld;
    } else {
      row.why = "the run measured nothing there, or more than one thing: " + claim.pointer;
    }
    out.push_back(row);
  }
  return out;
}

bool all_held(const std::vector<Judged>& judged) {
  return std::none_of(judged.begin(), judged.end(), [](const Judged& row) {
    return row.verdict == Verdict::kNotHeld && !row.claim.negative;
  });
}

std::string value_text(const Judged& judged) {
  if (!judged.value) return "-";
  // What misses its bound by little must not read as if it met it.
  std::string text;
  for (int digits = 3; digits <= 9; ++digits) {
    text = fmt::format("{:.{}g}", *judged.value, digits);
    if (holds(judged.claim, std::stod(text)) == holds(judged.claim, *judged.value)) break;
  }
  return text;
}

ordered_json claims_json(const std::vector<Judged>& judged) {
  ordered_json out = ordered_json::array();
  for (const Judged& row : judged) {
    out.push_back({{"id", row.claim.id},
                   {"experiment", row.claim.experiment},
                   {"value", row.value ? ordered_json(*row.value) : ordered_json()},
                   {"unit", row.claim.unit},
                   {"bound", bound_text(row.claim)},
                   {"verdict", verdict_text(row.verdict)}});
    if (!row.why.empty()) out.back()["why"] = row.why;
    if (const std::string remark = remark_of(row); !remark.empty()) out.back()["remark"] = remark;
  }
  return out;
}

std::vector<std::string> differences(const std::vector<Judged>& judged, const ordered_json& other) {
  std::vector<std::string> out;
  for (const Judged& row : judged) {
    const auto before = std::find_if(
        other.begin(), other.end(), [&](const ordered_json& o) { return o.value("id", "") == row.claim.id; });
    if (before == other.end()) {
      out.push_back(row.claim.id + ": new");
      continue;
    }
    const auto was = select(*before, "/value");
    const auto said = before->find("verdict");
    const std::string verdict = said != before->end() && said->is_string() ? said->get<std::string>() : "";
    std::string what;
    if (was.has_value() != row.value.has_value()) {
      what = fmt::format("{} -> {}", was ? fmt::format("{:.6g}", *was) : "-",
                         row.value ? fmt::format("{:.6g}", *row.value) : "-");
    } else if (was && *was != *row.value) {
      what = fmt::format("{:.6g} -> {:.6g} {}", *was, *row.value, row.claim.unit);
      if (*was != 0.0) what += fmt::format(" ({:+.3g} %)", 100.0 * (*row.value / *was - 1.0));
    }
    if (verdict != verdict_text(row.verdict))
      what += fmt::format("{}{} -> {}", what.empty() ? "" : ", ", verdict, verdict_text(row.verdict));
    if (!what.empty()) out.push_back(row.claim.id + ": " + what);
  }
  for (const auto& before : other) {
    const std::string id = before.value("id", "");
    const auto is_it = [&](const Judged& row) { return row.claim.id == id; };
    if (std::none_of(judged.begin(), judged.end(), is_it)) out.push_back(id + ": gone");
  }
  return out;
}

reporting::PageTable headline_table(const std::vector<Judged>& judged) {
  reporting::TableRows rows{{"thesis", "what it says", "printed there", "our figure", "may be", "verdict"}};
  for (const Judged& row : judged) {
    if (!row.claim.headline) continue;
    rows.push_back({cell(row.claim.reference), cell(row.claim.statement), cell(printed_text(row.claim)),
                    cell(row.claim.quantity + ": " + figure(row)), cell(bound_text(row.claim)),
                    verdict_text(row.verdict)});
  }
  return {"headline", reporting::markdown_table(rows)};
}

reporting::PageTable claims_table(const std::vector<Judged>& judged) {
  reporting::TableRows rows{
      {"claim", "thesis", "what is said", "printed there", "our figure", "may be", "verdict", "experiment"}};
  for (const Judged& row : judged)
    rows.push_back({row.claim.id, cell(row.claim.reference), cell(row.claim.statement),
                    cell(printed_text(row.claim)), cell(row.claim.quantity + ": " + figure(row)),
                    cell(bound_text(row.claim)), verdict_text(row.verdict), row.claim.experiment});
  return {"claims", reporting::markdown_table(rows)};
}

}  // namespace telekerf::experiments
