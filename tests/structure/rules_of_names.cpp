// SPDX-License-Identifier: Apache-2.0
#include <map>
#include <regex>

#include "tests/structure/rules.h"

namespace telekerf::structure {
namespace {

/// `f(A a, B& b = 0)` -> `f(A,B&)`
std::string signature(const std::string& function) {
  static const std::regex kDefault(R"(\s*=[^,()]*)"), kName(R"(([\w>]\s+[&*]*|[&*]\s*)\b\w+\s*(?=[,)]))"),
      kSpace(R"(\s)");
  const std::string types = std::regex_replace(std::regex_replace(function, kDefault, ""), kName, "$1");
  return std::regex_replace(types, kSpace, "");
}

/// What a source defines beside its header's names: namespace and definition, as one text.
std::vector<std::string> private_definitions(std::string_view source) {
  static const std::regex kNamespace(R"(namespace(\s+[\w:]+)?\s*$)");
  static const std::regex kType(R"((?:^|\s)(?:struct|class|enum(?:\s+class)?|union)\s+(\w+)[^()=]*$)");
  static const std::regex kConstant(
      R"((?:^|\s)const(?:expr|init)?\s[^()]*?(k[A-Z]\w*)\s*(?:\[[^\]]*\])?\s*(?:=|$))");
  static const std::regex kFunction(R"((\w+\s*\(.*\))\s*(?:const|noexcept|\s|->[^=]*)*$)");
  std::vector<std::string> scopes;  // of a namespace: its name; of a body: "{"
  std::vector<std::string> found;
  std::string statement;
  const auto where = [&] {
    std::string path;
    for (const std::string& scope : scopes) path += scope + "::";
    return path;
  };
  const auto is_private = [&] {
    bool unnamed = false;
    for (const std::string& scope : scopes) {
      if (scope == "{") return false;
      unnamed = unnamed || scope.empty();
    }
    return unnamed;
  };
  const auto note = [&] {
    if (!is_private()) return;
    std::smatch match;
    // The arguments of templates tell them apart.
    if (statement.find("template") != statement.npos || statement.find("static_assert") != statement.npos)
      return;
    if (std::regex_search(statement, match, kType) || std::regex_search(statement, match, kConstant))
      found.push_back(where() + match.str(1));
    else if (std::regex_search(statement, match, kFunction))
      found.push_back(where() + signature(match.str(1)));
  };
  for (const char c : code_of(source)) {
    if (c == '{') {
      std::smatch match;
      if (std::regex_search(statement, match, kNamespace)) {
        const std::string name = match.str(1);
        scopes.push_back(name.substr(std::min(name.size(), name.find_first_not_of(" \n"))));
      } else {
        note();
        scopes.emplace_back("{");
      }
      statement.clear();
    } else if (c == '}') {
      if (!scopes.empty()) scopes.pop_back();
      statement.clear();
    } else if (c == ';') {
      if (statement.find('=') != statement.npos) note();  // a constant; a declaration alone may come twice
      statement.clear();
    } else {
      statement += c;
    }
  }
  return found;
}

/// The sources of each library, and of each program, that a build file may compile together, by their paths
/// from the top folder.
std::vector<std::vector<std::string>> libraries_of(const std::string& path, const std::string& text) {
  static const std::regex kLibrary(R"(telekerf_(?:library|program)\(([^)]*)\))"), kSource(R"([\w/.]+\.cpp)");
  std::vector<std::vector<std::string>> libraries;
  for (auto library = std::sregex_iterator(text.begin(), text.end(), kLibrary);
       library != std::sregex_iterator(); ++library) {
    const std::string arguments = library->str(1);
    const std::string name = arguments.substr(0, arguments.find_first_of(" \n"));
    if (text.find(name + " PROPERTIES UNITY_BUILD OFF") != text.npos) continue;
    auto& sources = libraries.emplace_back();
    for (auto source = std::sregex_iterator(arguments.begin(), arguments.end(), kSource);
         source != std::sregex_iterator(); ++source)
      sources.push_back(folder_of(path) + '/' + source->str());
  }
  return libraries;
}

}  // namespace

Breaches colliding_names(const Repository& repository) {
  Breaches breaches;
  for (const auto& [path, text] : repository.files) {
    if (name_of(path) != "CMakeLists.txt") continue;
    for (const auto& sources : libraries_of(path, text)) {
      std::map<std::string, std::string> first;  // definition -> source
      for (const std::string& source : sources) {
        if (!repository.holds(source)) continue;
        for (const std::string& definition : private_definitions(repository.files.at(source))) {
          const auto [place, fresh] = first.emplace(definition, source);
          if (!fresh && place->second != source)
            breaches.push_back(source + " and " + place->second + " of one library both define " +
                               definition);
        }
      }
    }
  }
  return breaches;
}

}  // namespace telekerf::structure
