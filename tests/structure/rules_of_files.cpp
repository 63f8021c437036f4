// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <regex>

#include "tests/structure/rules.h"

namespace telekerf::structure {
namespace {

constexpr std::size_t kMaxLines = 400;
constexpr std::size_t kMaxLinesToMotor = 210;

bool leads_to_a_motor(const std::string& path) {
  const std::string folder = folder_of(path);
  return folder == "master" || folder == "slave" || folder == "common/streaming" ||
         folder == "common/control";
}

/// Is a statement, as it stands between its neighbours, a function whose body stands elsewhere?
bool declares_function(std::string statement) {
  static const std::regex kArguments("<[^<>]*>"), kLabel(R"((public|private|protected)\s*:)"),
      kAlign(R"(alignas\([^)]*\))"), kBodyless(R"(=\s*(0|default|delete)\s*$)"), kPointer(R"(\(\*)"),
      kConstant(R"(\sk[A-Z]\w*\()"), kOther(R"(^\s*(using|friend|typedef|static_assert|template|concept)\b)");
  statement = std::regex_replace(std::regex_replace(statement, kLabel, ""), kAlign, "");
  if (std::regex_search(statement, kOther) || std::regex_search(statement, kBodyless) ||
      std::regex_search(statement, kPointer) || std::regex_search(statement, kConstant))
    return false;
  for (std::string shorter; (shorter = std::regex_replace(statement, kArguments, "")) != statement;)
    statement = shorter;
  const std::size_t parenthesis = statement.find('(');
  return parenthesis != statement.npos && statement.find('=') > parenthesis;
}

/// Does a header declare a function, in a namespace or a class, that it does not define?
bool declares_more_than_it_defines(std::string_view header) {
  static const std::regex kScope(R"((^|\s)(namespace|class|struct|union)\s[^()=]*$)");
  std::vector<bool> scopes;  // does a declaration count there?
  std::string statement;
  for (const char c : code_of(header)) {
    const bool counts = scopes.empty() || scopes.back();
    if (c == '{') {
      scopes.push_back(counts && std::regex_search(statement, kScope));
      statement.clear();
    } else if (c == '}') {
      if (!scopes.empty()) scopes.pop_back();
      statement.clear();
    } else if (c == ';') {
      if (counts && declares_function(statement)) return true;
      statement.clear();
    } else {
      statement += c;
    }
  }
  return false;
}

}  // namespace

Breaches long_files(const Repository& repository) {
  Breaches breaches;
  for (const auto& [path, text] : repository.files) {
    if (!is_source(path)) continue;
    const std::size_t most = leads_to_a_motor(path) ? kMaxLinesToMotor : kMaxLines;
    const auto lines = static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
    if (lines > most)
      breaches.push_back(path + " has " + std::to_string(lines) + " lines, more than " +
                         std::to_string(most));
  }
  return breaches;
}

Breaches unpaired_files(const Repository& repository) {
  Breaches breaches;
  for (const auto& [path, text] : repository.files) {
    if (!is_source(path) || path.starts_with("tests/")) continue;
    const std::string stem = path.substr(0, path.rfind('.'));
    if (path.ends_with(".cpp")) {
      if (!repository.holds(stem + ".h") && !is_program(text) && !stem.ends_with("_command"))
        breaches.push_back(path + " has no header of its name beside it");
    } else if (!repository.holds(stem + ".cpp") && name_of(path) != "commands.h" &&
               declares_more_than_it_defines(text)) {
      breaches.push_back(path + " declares what no source of its name beside it defines");
    }
  }
  return breaches;
}

Breaches missing_licence(const Repository& repository) {
  Breaches breaches;
  for (const auto& [path, text] : repository.files) {
    if (!is_source(path) && !path.ends_with(".idl") && !path.ends_with(".c")) continue;
    if (!text.starts_with("// SPDX-License-Identifier: Apache-2.0\n"))
      breaches.push_back(path + " does not begin with its licence");
  }
  return breaches;
}

}  // namespace telekerf::structure
