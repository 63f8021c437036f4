// SPDX-License-Identifier: Apache-2.0
#include <regex>

#include "tests/structure/rules.h"

namespace telekerf::structure {
namespace {

bool is_page(const std::string& path) { return path.ends_with(".md"); }
bool is_build_file(const std::string& path) {
  return path.ends_with("CMakeLists.txt") || path.ends_with(".cmake");
}

/// Where a file may speak of others. Texts that a program prints count, those that a test makes up do not.
std::vector<std::string> speech_of(const std::string& path, const std::string& text) {
  if (path == "telekerf") return lines_of(text);
  if (is_page(path)) {
    // A change that a page shows names its files twice, below a/ and b/.
    std::vector<std::string> lines = lines_of(text);
    for (std::string& line : lines)
      if (line.starts_with("diff ") || line.starts_with("--- ") || line.starts_with("+++ ")) line.clear();
    return lines;
  }
  if (is_build_file(path)) {
    // What is looked for on the computer is not in the repository.
    std::vector<std::string> lines = lines_of(text);
    for (std::string& line : lines)
      if (line.find("find_path(") != line.npos) line.clear();
    return lines;
  }
  if (is_source(path) && !path.starts_with("tests/")) {
    std::vector<std::string> lines = lines_of(text);
    for (std::string& line : lines)
      if (line.starts_with("#include")) line.clear();
    return lines;
  }
  return prose_of(path, text);
}

std::set<std::string> matches_in(const std::string& line, const std::regex& what) {
  std::set<std::string> found;
  for (std::sregex_iterator at(line.begin(), line.end(), what), end; at != end; ++at) found.insert((*at)[1]);
  return found;
}

/// A name may count from the top folder, from the file's own, or be the end of a path.
bool is_known(const Repository& repository, const std::string& in, const std::string& name) {
  // A page that a program writes lies elsewhere.
  if (name.starts_with("../") && !is_page(in)) return is_known(repository, in, name.substr(3));
  const std::string beside =
      (std::filesystem::path(in).parent_path() / name).lexically_normal().generic_string();
  for (const std::string& path : {name, beside})
    if (repository.holds(path) || repository.holds_folder(path)) return true;
  for (const auto& [path, text] : repository.files)
    if (path.ends_with("/" + name) || path.find("/" + name + "/") != path.npos) return true;
  return false;
}

/// Names that a page gives to files that the reader makes.
bool is_the_readers(const std::string& name) { return name_of(name).starts_with("my_"); }

}  // namespace

Breaches dead_mentions(const Repository& repository) {
  // A file of a kind that only the repository has, or a path that begins with one of its folders.
  static const std::regex kFile(
      R"re((?:^|[^\w./<*-])((?:[\w-]+/|\.\./)*[\w.-]+\.(?:h|cpp|idl|md))(?![\w/]|[.]{3}))re");
  static const std::regex kPath(
      R"re((?:^|[^\w./$}<-])((?:common|master|slave|netem|tools|experiments|tests|docs|idl|examples)/[\w./-]*\w))re");
  static const std::regex kAddress(R"(https?://\S+)");
  Breaches breaches;
  for (const auto& [path, text] : repository.files) {
    int number = 0;
    for (const std::string& spoken : speech_of(path, text)) {
      ++number;
      const std::string line = std::regex_replace(spoken, kAddress, "");
      std::set<std::string> names = matches_in(line, kFile);
      names.merge(matches_in(line, kPath));
      for (const std::string& name : names)
        if (!is_the_readers(name) && !is_known(repository, path, name))
          breaches.push_back(path + ":" + std::to_string(number) + " names " + name + ", which is not there");
    }
  }
  return breaches;
}

Breaches dead_programs(const Repository& repository) {
  static const std::regex kMade(R"((?:telekerf_program|add_executable)\((telekerf-[a-z-]+))");
  static const std::regex kNamed(R"((?:^|[^\w-])(telekerf-[a-z]+(?:-[a-z]+)*))");
  static const std::regex kPackage(R"(Package: (telekerf-[a-z-]+))");
  std::set<std::string> programs{"telekerf-run"};  // a recording's format
  for (const auto& [path, text] : repository.files) {
    programs.insert(name_of(path));
    if (path == "debian/control") {
      for (const std::string& name : matches_in(text, kPackage)) programs.insert(name);
    }
    if (!is_build_file(path)) continue;
    for (const std::string& name : matches_in(text, kMade)) programs.insert(name);
  }
  Breaches breaches;
  for (const auto& [path, text] : repository.files) {
    int number = 0;
    for (const std::string& line : speech_of(path, text)) {
      ++number;
      for (const std::string& name : matches_in(line, kNamed))
        if (!programs.contains(name))
          breaches.push_back(path + ":" + std::to_string(number) + " names " + name +
                             ", which is no program");
    }
  }
  return breaches;
}

}  // namespace telekerf::structure
