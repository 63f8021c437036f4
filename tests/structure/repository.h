// SPDX-License-Identifier: Apache-2.0
// The repository as the tests of its structure see it: paths and texts.
#pragma once

#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace telekerf::structure {

/// One `#include` that stays within the repository.
struct Include {
  std::string from, to;  ///< paths from the top folder
};

/// Files by their path from the top folder. The text is kept of sources, pages and build files only.
struct Repository {
  std::map<std::string, std::string> files;

  bool holds(const std::string& path) const { return files.contains(path); }
  bool holds_folder(const std::string& path) const;
};

/// Reads what lies below `root` but hidden folders, builds and results.
Repository read_repository(const std::filesystem::path& root);

bool is_source(std::string_view path);   ///< C++
bool is_program(std::string_view text);  ///< has a main
/// Without the folder.
std::string name_of(const std::string& path);
std::string folder_of(const std::string& path);

std::vector<std::string> lines_of(std::string_view text);
/// Code without comments, texts and directives.
std::string code_of(std::string_view text);
std::vector<Include> includes_of(const Repository& repository, const std::string& path);

/// A file's prose, line by line: comments of code and build files, a page as a whole.
std::vector<std::string> prose_of(const std::string& path, std::string_view text);

/// Arrows -> one cycle as "a -> b -> a"; empty if there is none.
std::string cycle_in(const std::map<std::string, std::set<std::string>>& arrows);

}  // namespace telekerf::structure
