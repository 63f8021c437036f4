// SPDX-License-Identifier: Apache-2.0
#include "experiments/report/stored_claims.h"

#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <set>
#include <string>

#include "common/runtime/startup_error.h"
#include "experiments/report/judgement.h"

namespace telekerf::experiments {
namespace {

using nlohmann::ordered_json;

class Reader {
 public:
  explicit Reader(std::filesystem::path file) : file_(std::move(file)) {}

  ordered_json read() {
    std::ifstream in(file_);
    if (!in)
      throw input_error("--against " + file_.parent_path().string() +
                        ": holds no claims.json; name the --out of another run");
    ordered_json json = ordered_json::parse(in, nullptr, false);
    if (!json.is_object()) refuse("is no JSON object");
    if (!json.value("seed", ordered_json()).is_number_unsigned())
      refuse(key_text("seed", json) + "must be a whole number, not negative");
    if (!json.value("quick", ordered_json()).is_boolean())
      refuse(key_text("quick", json) + "must be true or false");
    if (!json.value("claims", ordered_json()).is_array()) refuse(key_text("claims", json) + "must be a list");
    std::set<std::string> ids;
    for (std::size_t i = 0; i < json["claims"].size(); ++i) check(json["claims"][i], i, ids);
    return json;
  }

 private:
  static std::string key_text(const std::string& key, const ordered_json& of) {
    constexpr std::size_t kMost = 60;
    const auto found = of.find(key);
    std::string value = found == of.end() ? "missing" : found->dump();
    if (value.size() > kMost) value = value.substr(0, kMost) + "...";
    return key + " = " + value + ": ";
  }

  [[noreturn]] void refuse(const std::string& complaint) const {
    throw input_error(fmt::format("--against {}: {}; no run writes that: name the --out of another run",
                                  file_.string(), complaint));
  }

  void check(const ordered_json& claim, std::size_t place, std::set<std::string>& ids) const {
    if (!claim.is_object()) refuse(fmt::format("claims.{} is no object", place));
    const auto id = claim.find("id");
    if (id == claim.end() || !id->is_string() || id->get<std::string>().empty())
      refuse(fmt::format("claims.{}.{}must be a word", place, key_text("id", claim)));
    const std::string of = "claim " + id->get<std::string>() + ": ";
    if (!ids.insert(id->get<std::string>()).second) refuse(of + "stands there twice");
    const auto value = claim.find("value");
    const bool is_null = value != claim.end() && value->is_null();
    if (!is_null && (value == claim.end() || !value->is_number() || !std::isfinite(value->get<double>())))
      refuse(of + key_text("value", claim) + "must be a number or null");
    const auto verdict = claim.find("verdict");
    bool known = false;
    for (const Verdict one : {Verdict::kHeld, Verdict::kNotHeld, Verdict::kNotAssessed}) {
      if (verdict == claim.end() || *verdict != verdict_text(one)) continue;
      known = true;
      if (is_null != (one == Verdict::kNotAssessed))
        refuse(of + key_text("verdict", claim) +
               (is_null ? "must be \"not assessed\", there is no figure" : "does not go with a figure"));
    }
    if (!known)
      refuse(of + key_text("verdict", claim) + "must be \"held\", \"not held\" or \"not assessed\"");
  }

  std::filesystem::path file_;
};

}  // namespace

ordered_json stored_claims(const std::filesystem::path& folder) {
  return Reader(folder / "claims.json").read();
}

}  // namespace telekerf::experiments
