// SPDX-License-Identifier: Apache-2.0
#include "tools/reference/cell_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <sstream>
#include <vector>

#include "tools/reference/setting_words.h"

namespace telekerf::reference {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::array kServices{"telekerf-slave", "telekerf-vision", "telekerf-master", "telekerf-console"};
constexpr std::size_t kWidth = 110;

std::string as_comment(const std::string& text) {
  std::string out, line = "#";
  std::istringstream words(text);
  for (std::string word; words >> word;) {
    if (line.size() + 1 + word.size() > kWidth) {
      out.append(line).append("\n");
      line.assign(1, '#');
    }
    line.append(" ").append(word);
  }
  return fmt::format("{}{}\n", out, line);
}

const Json& settings_of(const Json& program) { return program["commands"][0]["settings"]; }

const Json* find(const Json& program, const std::string& name) {
  for (const Json& s : settings_of(program)) {
    if (s["name"] == name) return &s;
  }
  return nullptr;
}

/// Whether it says the same to every service.
bool is_shared(const std::vector<const Json*>& services, const Json& s) {
  const std::string name = s["name"];
  return name != "name" && std::all_of(services.begin(), services.end(), [&](const Json* program) {
           const Json* const theirs = find(*program, name);
           return theirs != nullptr && *theirs == s;
         });
}

std::string key_of(const Json& s) {
  std::string what = s["sentence"];
  if (const std::string value = value_of(s); !value.empty()) what += fmt::format(" ({})", value);
  if (const std::string range = range_of(s); !range.empty()) what += fmt::format(" ({})", range);
  std::string text = as_comment(what);
  if (s.contains("choices")) {
    for (const Json& choice : s["choices"]) {
      if (const std::string sentence = choice["sentence"]; !sentence.empty())
        text += as_comment(fmt::format("- {}: {}", choice["word"].get<std::string>(), sentence));
    }
  }
  // A key without a default has nothing to show.
  std::string usual;
  if (s.contains("default")) {
    const Json& value = s["default"];
    usual = value.is_number() ? fmt::format(" {}", value.get<double>()) : fmt::format(" {}", value.dump());
  }
  return fmt::format("{}#{} ={}\n\n", text, s["name"].get<std::string>(), usual);
}

}  // namespace

std::string cell_file(const Json& programs) {
  std::vector<const Json*> services;
  for (const char* const name : kServices) {
    for (const Json& program : programs) {
      if (program["program"] == name) services.push_back(&program);
    }
  }
  std::string text =
      "# Telekerf: the settings of one cell on this machine. The file's name is the cell's name; another cell has a\n"
      "# copy of this file under its own. Every line that begins with '#' and a key shows a default: take the '#' away\n"
      "# and change it. Both sites of a cell must agree on its name and its domain, and beyond this computer a cell is\n"
      "# heard only with keys (security) or where it is said that none are wanted (insecure).\n"
      "#\n"
      "#   at the workpiece:   systemctl enable --now telekerf-cell@cell-1.target\n"
      "#   at the operator:    systemctl enable --now telekerf-operator@cell-1.target\n"
      "#   who is there:       telekerf-ctl look --cell cell-1\n"
      "#   what they say:      journalctl -f -u 'telekerf-*@cell-1'\n\n"
      "# ---- every service of the cell\n\n";
  for (const Json& s : settings_of(*services.front())) {
    if (is_shared(services, s) && s["name"] != "cell") text += key_of(s);
  }
  for (const Json* const program : services) {
    const std::string name = (*program)["program"];
    text += fmt::format("# ---- {}: {}\n\n[{}]\n\n", name, (*program)["sentence"].get<std::string>(),
                        name.substr(name.find('-') + 1));
    for (const Json& s : settings_of(*program)) {
      if (!is_shared(services, s)) text += key_of(s);
    }
  }
  return text;
}

}  // namespace telekerf::reference
