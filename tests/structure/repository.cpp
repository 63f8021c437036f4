// SPDX-License-Identifier: Apache-2.0
#include "tests/structure/repository.h"

#include <algorithm>
#include <fstream>
#include <functional>
#include <regex>
#include <sstream>

namespace telekerf::structure {
namespace fs = std::filesystem;
namespace {

bool has_text(const std::string& path) {
  static const std::set<std::string> kKinds{".h",   ".cpp",   ".c",    ".md", ".idl",
                                            ".txt", ".cmake", ".toml", ".py"};
  return kKinds.contains(fs::path(path).extension().string()) || path == "telekerf" ||
         path == "debian/control";
}

std::string text_of(const fs::path& file) {
  std::ifstream in(file);
  std::stringstream text;
  text << in.rdbuf();
  return text.str();
}

/// Where `mark` stands outside of a text.
std::size_t start_of_comment(const std::string& line, const std::string& mark) {
  bool within_text = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (line[i] == '"' && (i == 0 || line[i - 1] != '\\')) within_text = !within_text;
    if (!within_text && line.compare(i, mark.size(), mark) == 0) return i;
  }
  return line.npos;
}

}  // namespace

bool Repository::holds_folder(const std::string& path) const {
  const auto next = files.lower_bound(path + "/");
  return next != files.end() && next->first.starts_with(path + "/");
}

Repository read_repository(const fs::path& root) {
  Repository repository;
  for (auto at = fs::recursive_directory_iterator(root); at != fs::recursive_directory_iterator(); ++at) {
    const std::string name = at->path().filename().string();
    if (at->is_directory()) {
      const bool top = at.depth() == 0;
      if (name.starts_with('.') || (top && (name.starts_with("build") || name == "out")))
        at.disable_recursion_pending();
      continue;
    }
    const std::string path = at->path().lexically_relative(root).generic_string();
    repository.files[path] = has_text(path) ? text_of(at->path()) : "";
  }
  return repository;
}

bool is_source(std::string_view path) { return path.ends_with(".h") || path.ends_with(".cpp"); }

bool is_program(std::string_view text) {
  return text.starts_with("int main(") || text.find("\nint main(") != text.npos;
}

std::string name_of(const std::string& path) { return fs::path(path).filename().string(); }
std::string folder_of(const std::string& path) { return fs::path(path).parent_path().generic_string(); }

std::vector<std::string> lines_of(std::string_view text) {
  std::vector<std::string> lines;
  std::istringstream in{std::string(text)};
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

std::string code_of(std::string_view text) {
  static const std::regex kText(R"re("(\\.|[^"\\])*"|'(\\.|[^'\\])')re");
  std::string code;
  for (std::string line : lines_of(text)) {
    if (line.starts_with('#')) continue;
    line = std::regex_replace(line, kText, "0");
    code += line.substr(0, line.find("//")) + '\n';
  }
  return code;
}

std::vector<Include> includes_of(const Repository& repository, const std::string& path) {
  static const std::regex kInclude(R"(^\s*#\s*include\s*[<"]([^">]+)[">].*)");
  std::vector<Include> includes;
  for (const std::string& line : lines_of(repository.files.at(path))) {
    std::smatch found;
    if (line.find("include") == line.npos || !std::regex_match(line, found, kInclude)) continue;
    const std::string beside =
        (fs::path(path).parent_path() / found[1].str()).lexically_normal().generic_string();
    for (const std::string& to : {found[1].str(), beside}) {
      if (!repository.holds(to)) continue;
      includes.push_back({path, to});
      break;
    }
  }
  return includes;
}

std::vector<std::string> prose_of(const std::string& path, std::string_view text) {
  std::vector<std::string> lines = lines_of(text);
  if (path.ends_with(".md")) return lines;
  const bool code = is_source(path) || path.ends_with(".idl") || path.ends_with(".c");
  const std::string mark = code ? "//" : "#";
  for (std::string& line : lines) {
    const std::size_t start = start_of_comment(line, mark);
    line = start == line.npos ? "" : line.substr(start);
  }
  return lines;
}

std::string cycle_in(const std::map<std::string, std::set<std::string>>& arrows) {
  std::set<std::string> done;
  std::vector<std::string> trail;
  std::string found;
  const std::function<void(const std::string&)> visit = [&](const std::string& here) {
    if (!found.empty() || done.contains(here)) return;
    const auto again = std::find(trail.begin(), trail.end(), here);
    if (again != trail.end()) {
      for (auto step = again; step != trail.end(); ++step) found += *step + " -> ";
      found += here;
      return;
    }
    trail.push_back(here);
    if (const auto out = arrows.find(here); out != arrows.end())
      for (const std::string& next : out->second) visit(next);
    trail.pop_back();
    done.insert(here);
  };
  for (const auto& [from, to] : arrows) visit(from);
  return found;
}

}  // namespace telekerf::structure
