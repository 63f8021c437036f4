// SPDX-License-Identifier: Apache-2.0
#include "experiments/machining/contour_tables.h"

#include <fmt/format.h>

#include <functional>

namespace telekerf::experiments {
namespace {

using nlohmann::ordered_json;
using reporting::TableRows;

std::string rms(const ordered_json& errors) { return fmt::format("{:.2f}", errors["rms"].get<double>()); }
std::string ratio(const ordered_json& value) { return fmt::format("{:.2f}", value.get<double>()); }

TableRows contour_rows(const ordered_json& pictures) {
  TableRows rows{{"picture", "length mm", "normal error rms / max um", "mean speed mm/s", "ripple %",
                  "motors, speed or acceleration at their limit"}};
  for (const auto& picture : pictures) {
    const auto& speed = picture["tangential_speed"];
    rows.push_back({picture["image"].get<std::string>(),
                    fmt::format("{:.1f}", picture["length_mm"].get<double>()),
                    fmt::format("{:.2f} / {:.1f}", picture["normal_error_um"]["rms"].get<double>(),
                                picture["normal_error_um"]["max"].get<double>()),
                    fmt::format("{:.2f}", speed["mean_mm_s"].get<double>()),
                    fmt::format("{:.2f}", speed["ripple_percent"].get<double>()),
                    fmt::format("{} ticks", picture["limit_violations"].get<int>())});
  }
  return rows;
}

TableRows term_rows(const ordered_json& pictures) {
  TableRows rows{{"normal error, rms um"}};
  for (const auto& picture : pictures) rows[0].push_back(picture["image"].get<std::string>());
  const auto add = [&](const std::string& label,
                       const std::function<std::string(const ordered_json&)>& cell) {
    rows.push_back({label});
    for (const auto& picture : pictures) rows.back().push_back(cell(picture));
  };
  add("contouring, as used", [](const ordered_json& p) { return rms(p["normal_error_um"]); });
  add("independent joints as in the thesis, the same gains along and the same observer",
      [](const ordered_json& p) { return rms(p["independent"]["normal_error_um"]); });
  add("ratio", [](const ordered_json& p) { return ratio(p["normal_error_ratio"]); });
  for (const auto& [key, label] : std::initializer_list<std::pair<const char*, const char*>>{
           {"independent_tuned",
            "contouring as used / independent, tuned, the same bandwidth along the path"},
           {"both_without_model", "without any model: contouring / independent"},
           {"both_with_model", "with all of the model: contouring / independent"},
           {"independent_assisted", "contouring as used / independent, assisted, twice the bandwidth"},
           {"independent_assisted_perfect_sensor", "the same, sensors without error"}}) {
    add(label, [key = key](const ordered_json& p) {
      const auto& term = p["equal_terms"][key];
      return rms(term["normal_error_um"]) + " / " + rms(term["independent_normal_error_um"]);
    });
    add(fmt::format("ratio, {}", key),
        [key = key](const ordered_json& p) { return ratio(p["equal_terms"][key]["normal_error_ratio"]); });
    add(fmt::format("{}, median / worst of five seeds", key), [key = key](const ordered_json& p) {
      const auto& term = p["equal_terms"][key];
      return ratio(term["normal_error_ratio_median"]) + " / " + ratio(term["normal_error_ratio_worst"]);
    });
  }
  return rows;
}

}  // namespace

std::vector<reporting::PageTable> contour_tables(const ordered_json& pictures) {
  return {{"contours", reporting::markdown_table(contour_rows(pictures))},
          {"terms", reporting::markdown_table(term_rows(pictures))}};
}

reporting::PageTable machine_table(const ordered_json& works) {
  TableRows rows{{"picture", "contours", "time (estimate) s", "normal error rms / max um",
                  "contour error max um", "closure gap um", "energy inside / outside J", "at a limit"}};
  for (const auto& work : works) {
    const auto number = [](const ordered_json& value, int digits) {
      return value.is_number() ? fmt::format("{:.{}f}", value.get<double>(), digits) : std::string("-");
    };
    const auto& burn = work["burn"];
    rows.push_back({work["image"].get<std::string>(),
                    fmt::format("{} of {}", work["contours_cut"].get<int>(), work["contours"].get<int>()),
                    fmt::format("{} ({})", number(work["time_s"], 2), number(work["time_estimate_s"], 2)),
                    fmt::format("{} / {}", number(work["normal_error_um"]["rms"], 2),
                                number(work["normal_error_um"]["max"], 1)),
                    number(work["contour_error_um"]["max"], 1), number(work["closure_gap_um"], 2),
                    fmt::format("{} / {:g}", number(burn["energy_inside_j"], 1),
                                burn["energy_outside_corridor_j"].get<double>()),
                    fmt::format("{} ticks", work["limit_violations"].get<int>())});
  }
  return {"machine", reporting::markdown_table(rows)};
}

}  // namespace telekerf::experiments
