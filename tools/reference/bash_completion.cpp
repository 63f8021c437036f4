// SPDX-License-Identifier: Apache-2.0
#include "tools/reference/bash_completion.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "common/runtime/resources.h"

namespace telekerf::reference {
namespace {

using Json = nlohmann::ordered_json;

/// Words that may stand for a value, and whether files (f) or folders (d) may.
std::string values_of(const Json& s) {
  std::vector<std::string> words;
  std::string paths;
  if (s["type"] == "switch") return "";
  if (s.contains("choices")) {
    for (const Json& choice : s["choices"]) words.push_back(choice["word"]);
  } else if (s.contains("form")) {
    const std::string form = s["form"];
    if (form.find('|') != form.npos) {
      for (std::size_t from = 0; from < form.size();) {
        const std::size_t end = std::min(form.find('|', from), form.size());
        const std::string word = form.substr(from, end - from);
        // Capitals are for the user to fill in.
        words.push_back(word.substr(0, word.find_first_of("ABCDEFGHIJKLMNOPQRSTUVWXYZ")));
        from = end + 1;
      }
    }
    if (form == "FILE" || s.contains("shipped")) paths = "-f";
    if (form == "FOLDER") paths = "-d";
    if (s.contains("shipped")) {
      const std::string kind = s["shipped"];
      for (const std::string& name : shipped_names(kind, s["extension"])) words.push_back(name);
    }
  }
  std::erase(words, "");
  return paths +
         (words.empty() ? "" : fmt::format("{}-W '{}'", paths.empty() ? "" : " ", fmt::join(words, " ")));
}

}  // namespace

std::string bash_completion(const Json& programs) {
  std::string flags, values, commands, names;
  for (const Json& program : programs) {
    const std::string name = program["program"];
    names += " " + name;
    std::string its_commands;
    for (const Json& command : program["commands"]) {
      const std::string where = fmt::format("{} {}", name, command["command"].get<std::string>());
      if (const std::string word = command["command"]; !word.empty()) its_commands += word + " ";
      std::string its_flags;
      for (const Json& s : command["settings"]) {
        const std::string key = s.contains("flag") ? s["flag"].get<std::string>() : "";
        if (!key.empty()) its_flags += key + " ";
        if (s["type"] != "switch")
          values += fmt::format("    '{} {}') echo \"{}\" ;;\n", where, key, values_of(s));
      }
      flags +=
          fmt::format("    '{}') echo '{}--config --print-config --help --version' ;;\n", where, its_flags);
    }
    if (!its_commands.empty()) commands += fmt::format("    {}) echo '{}' ;;\n", name, its_commands);
  }
  return "# SPDX-License-Identifier: Apache-2.0\n"
         "# Completes the options, choices and shipped names of every program.\n"
         "# Written by `build/bin/telekerf-reference build/bin`; a test holds it against the programs.\n"
         "# shellcheck shell=bash\n\n"
         "_telekerf_commands() {\n  case $1 in\n" +
         commands +
         "  esac\n}\n\n"
         "_telekerf_flags() {\n  case $1 in\n" +
         flags +
         "  esac\n}\n\n"
         "# What may follow a flag, as options of compgen; fails for what takes no value.\n"
         "_telekerf_values() {\n  case $1 in\n" +
         values +
         "    *' --config') echo '-f' ;;\n"
         "    *) return 1 ;;\n  esac\n}\n\n"
         "_telekerf() {\n"
         "  local program=${1##*/} word=$2 previous=$3 command='' commands how one\n"
         "  commands=$(_telekerf_commands \"$program\")\n"
         "  for one in \"${COMP_WORDS[@]:1:COMP_CWORD-1}\"; do\n"
         "    [[ \" $commands\" != *\" $one \"* ]] || { command=$one; break; }\n"
         "  done\n"
         "  COMPREPLY=()\n"
         "  if [[ $previous == --* ]] && how=$(_telekerf_values \"$program $command $previous\"); then\n"
         "    eval \"mapfile -t COMPREPLY < <(compgen $how -- \\\"\\$word\\\")\"\n"
         "  elif [[ -n $commands && -z $command && $word != -* ]]; then\n"
         "    mapfile -t COMPREPLY < <(compgen -W \"$commands\" -- \"$word\")\n"
         "  elif [[ $word == -* ]]; then\n"
         "    mapfile -t COMPREPLY < <(compgen -W \"$(_telekerf_flags \"$program $command\")\" -- "
         "\"$word\")\n"
         "  elif how=$(_telekerf_values \"$program $command \"); then\n"
         "    eval \"mapfile -t COMPREPLY < <(compgen $how -- \\\"\\$word\\\")\"\n"
         "  fi\n"
         "}\n"
         "complete -o filenames -F _telekerf" +
         names + "\n";
}

}  // namespace telekerf::reference
