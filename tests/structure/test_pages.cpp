// SPDX-License-Identifier: Apache-2.0
// What pages promise: their links lead somewhere, and the functions that they name are there.
#include <gtest/gtest.h>

#include <algorithm>
#include <regex>

#include "tests/structure/breaches.h"
#include "tests/structure/repository.h"

namespace telekerf::structure {
namespace {

namespace fs = std::filesystem;

/// "## What is measured, and how" -> "what-is-measured-and-how", as the forges make it.
std::string anchor_of(const std::string& heading) {
  std::string anchor;
  for (const char c : heading.substr(heading.find_first_not_of("# "))) {
    if (std::isalnum(static_cast<unsigned char>(c)) || c == '-' || c == '_')
      anchor += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    if (c == ' ') anchor += '-';
  }
  return anchor;
}

bool has_anchor(const std::string& page, const std::string& anchor) {
  const std::vector<std::string> lines = lines_of(page);
  return std::any_of(lines.begin(), lines.end(), [&](const std::string& line) {
    return line.starts_with("#") && anchor_of(line) == anchor;
  });
}

std::vector<std::string> dead_links(const Repository& repository) {
  static const std::regex kLink(R"(\]\(([^)\s]+)\))");
  std::vector<std::string> dead;
  for (const auto& [path, text] : repository.files) {
    if (!path.ends_with(".md")) continue;
    for (std::sregex_iterator at(text.begin(), text.end(), kLink), end; at != end; ++at) {
      const std::string link = (*at)[1];
      if (link.starts_with("http")) continue;
      const std::string name = link.substr(0, link.find('#'));
      const std::string to =
          name.empty() ? path : (fs::path(folder_of(path)) / name).lexically_normal().generic_string();
      const bool there = repository.holds(to) || repository.holds_folder(to);
      const std::size_t hash = link.find('#');
      if (!there || (hash != link.npos && !has_anchor(repository.files.at(to), link.substr(hash + 1))))
        dead.push_back(path + " leads to " + link);
    }
  }
  return dead;
}

/// `text` holds `words` as such, not as the end of a longer word.
bool says(const std::string& text, const std::string& words) {
  for (std::size_t at = text.find(words); at != text.npos; at = text.find(words, at + 1)) {
    const char before = at == 0 ? ' ' : text[at - 1];
    if (!std::isalnum(static_cast<unsigned char>(before)) && before != '_') return true;
  }
  return false;
}

bool defines(const std::string& text, const std::string& type) {
  for (const char* kind : {"class ", "struct "})
    for (const char* after : {" ", ";", "\n"})
      if (says(text, kind + type + after)) return true;
  return false;
}

/// `Type::function()` is there if one header holds both words; `function()` if any does.
std::vector<std::string> dead_functions(const Repository& repository, const std::string& page) {
  static const std::regex kFunction(R"(`(?:(\w+)::)?(\w+)\(\)`)");
  const std::string& text = repository.files.at(page);
  std::vector<std::string> dead;
  for (std::sregex_iterator at(text.begin(), text.end(), kFunction), end; at != end; ++at) {
    const std::string type = (*at)[1], function = (*at)[2];
    const bool there = std::any_of(repository.files.begin(), repository.files.end(), [&](const auto& file) {
      return file.first.ends_with(".h") && !file.first.starts_with("tests/") &&
             says(file.second, function + "(") && (type.empty() || defines(file.second, type));
    });
    if (!there) dead.push_back(page + " names " + (type.empty() ? "" : type + "::") + function);
  }
  return dead;
}

TEST(Pages, EveryLinkLeadsSomewhere) {
  const Repository repository = read_repository(TELEKERF_SOURCE_DIR);
  expect_none(dead_links(repository));
}

TEST(Pages, EveryFunctionThatTheyNameIsThere) {
  const Repository repository = read_repository(TELEKERF_SOURCE_DIR);
  for (const char* page : {"docs/code-flow.md", "docs/architecture.md", "docs/glossary.md"})
    expect_none(dead_functions(repository, page));
}

TEST(Pages, ADeadLinkAndADeadFunctionAreFound) {
  Repository repository;
  repository.files["docs/a.md"] =
      "[b](b.md) [c](c.md#here-it-is) [d](c.md#nowhere) `Thing::does()` `Thing::undoes()`";
  repository.files["docs/c.md"] = "## Here: it is";
  repository.files["thing.h"] = "class Thing {\n  void does();\n};";
  EXPECT_EQ(dead_links(repository),
            (std::vector<std::string>{"docs/a.md leads to b.md", "docs/a.md leads to c.md#nowhere"}));
  EXPECT_EQ(dead_functions(repository, "docs/a.md"),
            std::vector<std::string>{"docs/a.md names Thing::undoes"});
}

}  // namespace
}  // namespace telekerf::structure
