// SPDX-License-Identifier: Apache-2.0
#include "tools/reference/man_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include "common/runtime/version.h"
#include "tools/reference/setting_words.h"

namespace telekerf::reference {
namespace {

using Json = nlohmann::ordered_json;

/// Plain text as roff has it.
std::string roff(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '\\') {
      out += "\\e";
    } else if (c == '-') {
      out += "\\-";
    } else if ((c == '.' || c == '\'') && (out.empty() || out.back() == '\n')) {
      out.append("\\&").push_back(c);
    } else {
      out += c;
    }
  }
  return out;
}

std::string option_of(const Json& s) {
  const std::string value = value_of(s);
  std::string text = fmt::format(".TP\n\\fB{}\\fR{}\n{}.", roff(s.value("flag", s["name"].get<std::string>())),
                                 value.empty() ? "" : fmt::format(" \\fI{}\\fR", roff(value)),
                                 roff(s["sentence"].get<std::string>()));
  if (const std::string range = range_of(s); !range.empty()) text += fmt::format(" From {}.", roff(range));
  if (const std::string usual = default_of(s); !usual.empty()) text += fmt::format(" Default: {}.", roff(usual));
  text += '\n';
  if (!s.contains("choices")) return text;
  for (const Json& choice : s["choices"]) {
    const std::string sentence = choice["sentence"];
    if (!sentence.empty())
      text += fmt::format(".RS\n\\fI{}\\fR: {}.\n.RE\n", roff(choice["word"]), roff(sentence));
  }
  return text;
}

std::string options_of(const Json& command) {
  std::string text;
  for (const Json& s : command["settings"]) text += option_of(s);
  return text;
}

}  // namespace

std::string man_page(const Json& program) {
  const std::string name = program["program"];
  std::string title = name;
  std::transform(title.begin(), title.end(), title.begin(), [](unsigned char c) { return std::toupper(c); });
  const bool several = program["commands"].size() != 1 || program["commands"][0]["command"] != "";
  std::string page = fmt::format(
      ".TH {} 1 \"\" \"Telekerf {}\" \"Telekerf\"\n.SH NAME\n{} \\- {}\n.SH SYNOPSIS\n.B {}\n{}[\\fIOPTIONS\\fR]\n",
      roff(title), kVersion, roff(name), roff(program["sentence"]), roff(name),
      several ? "\\fICOMMAND\\fR " : "");
  if (several) {
    page += ".SH COMMANDS\n";
    for (const Json& command : program["commands"])
      page += fmt::format(".SS \"{} {}\"\n{}.\n{}", roff(name), roff(command["command"]),
                          roff(command["sentence"]), options_of(command));
    page += ".SH OPTIONS\n";
  } else {
    page += ".SH OPTIONS\n" + options_of(program["commands"][0]);
  }
  return page +
         ".TP\n\\fB\\-\\-config\\fR \\fIFILE\\fR\nTOML file with any of these settings (names with underscores).\n"
         ".TP\n\\fB\\-\\-print\\-config\\fR\nWrites that file, with the settings as they are given here.\n"
         ".TP\n\\fB\\-\\-help\\fR, \\fB\\-\\-version\\fR\nSays what can be set, or which version this is.\n"
         ".SH EXIT STATUS\n0: done and good. 1: done, and the verdict is bad. 2: it cannot be done; one sentence on "
         "standard error says why.\n"
         ".SH FILES\n.TP\n.I /etc/telekerf/CELL.toml\nThe settings of the services of one cell.\n"
         ".SH SEE ALSO\n.BR telekerf\\-ctl (1),\n.BR telekerf\\-inspect (1),\n"
         ".I /usr/share/doc/telekerf/docs/index.md\n(package telekerf\\-doc)\n";
}

}  // namespace telekerf::reference
