// SPDX-License-Identifier: Apache-2.0
#include "tools/reference/setting_words.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <vector>

namespace telekerf::reference {

using Json = nlohmann::ordered_json;

std::string value_of(const Json& setting) {
  const std::string type = setting["type"];
  if (type == "switch") return "";
  if (type == "text") return setting["form"];
  if (type == "texts") return fmt::format("{}...", setting["form"].get<std::string>());
  if (type == "numbers")
    return setting.contains("count") ? fmt::format("{} NUMBERS", setting["count"].get<int>()) : "NUMBERS";
  if (type == "choice") {
    std::vector<std::string> words;
    for (const Json& choice : setting["choices"]) words.push_back(choice["word"]);
    return fmt::format("{}", fmt::join(words, "|"));
  }
  const char* const number = type == "integer" ? "INTEGER" : "NUMBER";
  return setting.contains("unit") ? fmt::format("{}, {}", number, setting["unit"].get<std::string>()) : number;
}

std::string range_of(const Json& setting) {
  if (setting.contains("min") && setting.contains("max"))
    return fmt::format("{:g} to {:g}", setting["min"].get<double>(), setting["max"].get<double>());
  if (setting.contains("min")) return fmt::format("at least {:g}", setting["min"].get<double>());
  if (setting.contains("max")) return fmt::format("at most {:g}", setting["max"].get<double>());
  return "";
}

std::string default_of(const Json& setting) {
  if (setting.value("required", false) || !setting.contains("default") || setting["type"] == "switch") return "";
  const Json& value = setting["default"];
  if (value.empty() || value == "") return "";
  if (value.is_string()) return value;
  if (value.is_number()) return fmt::format("{}", value.get<double>());
  return value.dump();
}

}  // namespace telekerf::reference
