// SPDX-License-Identifier: Apache-2.0
#include "tools/reference/settings_page.h"

#include <fmt/format.h>

#include "tools/reference/setting_words.h"

namespace telekerf::reference {
namespace {

using Json = nlohmann::ordered_json;

std::string in_cell(std::string text) {
  for (std::size_t at = 0; (at = text.find('|', at)) != text.npos; at += 2) text.insert(at, 1, '\\');
  return text;
}

std::string value_cell(const Json& s) {
  const std::string type = s["type"];
  if (type == "text") return fmt::format("`{}`", in_cell(s["form"]));
  if (type == "texts") return fmt::format("`{}`, several", in_cell(s["form"]));
  if (type == "numbers") return s.contains("count") ? fmt::format("{} numbers", s["count"].get<int>()) : type;
  if (type == "switch" || type == "choice") return type;
  return type + (s.contains("unit") ? fmt::format(", {}", s["unit"].get<std::string>()) : "");
}

std::string default_cell(const Json& s) {
  if (s.value("required", false)) return "must be given";
  const std::string value = default_of(s);
  return value.empty() || s["default"].is_number() ? value : fmt::format("`{}`", value);
}

std::string meaning_of(const Json& s) {
  std::string text = in_cell(s["sentence"]);
  if (!s.contains("choices")) return text;
  for (const Json& choice : s["choices"]) {
    const std::string sentence = choice["sentence"];
    text += fmt::format("<br>`{}`{}", choice["word"].get<std::string>(),
                        sentence.empty() ? "" : ": " + in_cell(sentence));
  }
  return text;
}

}  // namespace

std::string settings_page(const Json& programs) {
  std::string page =
      "# Settings\n\n"
      "Every flag of every program, and every key of the files that `--config FILE` reads: `--stream-hz` on "
      "the "
      "command line is\n`stream_hz` in a file. A file may hold any of a program's keys; the command line "
      "overrides it. `--print-config` writes the\nfile that `--config` reads. What lies outside its range is "
      "refused. `--help` and `--version` are everywhere.\n\n"
      "Written by `build/bin/telekerf-reference build/bin`; a test holds it against the programs.\n";
  for (const Json& program : programs) {
    page += fmt::format("\n## {}\n\n{}.\n", program["program"].get<std::string>(),
                        program["sentence"].get<std::string>());
    for (const Json& command : program["commands"]) {
      const std::string name = command["command"];
      if (!name.empty())
        page += fmt::format("\n### {} {}\n\n{}.\n", program["program"].get<std::string>(), name,
                            command["sentence"].get<std::string>());
      if (command["settings"].empty()) continue;
      page += "\n| flag | value | range | default | meaning |\n| --- | --- | --- | --- | --- |\n";
      for (const Json& s : command["settings"]) {
        page += fmt::format("| `{}` | {} | {} | {} | {} |\n",
                            s.contains("flag") ? s["flag"].get<std::string>() : s["name"].get<std::string>(),
                            value_cell(s), range_of(s), default_cell(s), meaning_of(s));
      }
    }
  }
  return page;
}

}  // namespace telekerf::reference
