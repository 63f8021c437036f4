// SPDX-License-Identifier: Apache-2.0
#include "common/reporting/page_tables.h"

#include <fmt/format.h>

#include <fstream>
#include <sstream>
#include <utility>

#include "common/runtime/results.h"
#include "common/runtime/startup_error.h"

namespace telekerf::reporting {
namespace {

std::string text_of(const std::filesystem::path& page) {
  std::ifstream file(page);
  if (!file) throw input_error(fmt::format("{}: cannot be read", page.string()));
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

/// From behind the first comment's line to the second comment.
std::pair<std::size_t, std::size_t> place_of(const std::filesystem::path& page, const std::string& text,
                                             const std::string& name) {
  const std::string first = fmt::format("<!-- table {} -->\n", name);
  const std::string last = fmt::format("<!-- end of {} -->", name);
  const std::size_t begin = text.find(first);
  const std::size_t end = begin == text.npos ? text.npos : text.find(last, begin);
  if (end == text.npos) {
    throw input_error(fmt::format("{}: no place for the table '{}': it wants the lines '{}' and '{}'",
                                  page.string(), name, first.substr(0, first.size() - 1), last));
  }
  return {begin + first.size(), end};
}

std::string trimmed(const std::string& text) {
  const std::size_t begin = text.find_first_not_of(' ');
  return begin == text.npos ? "" : text.substr(begin, text.find_last_not_of(' ') + 1 - begin);
}

}  // namespace

std::string markdown_table(const TableRows& rows) {
  std::string text;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    text += "|";
    for (const std::string& cell : rows[i]) text += " " + cell + " |";
    text += "\n";
    if (i > 0) continue;
    text += "|";
    for (std::size_t column = 0; column < rows[0].size(); ++column) text += " --- |";
    text += "\n";
  }
  return text;
}

void write_tables(const std::filesystem::path& page, const std::vector<PageTable>& tables) {
  std::string text = text_of(page);
  for (const PageTable& table : tables) {
    const auto [begin, end] = place_of(page, text, table.name);
    text.replace(begin, end - begin, "\n" + table.markdown + "\n");
  }
  write_atomically(page, text);
}

TableRows read_table(const std::filesystem::path& page, const std::string& name) {
  const std::string text = text_of(page);
  const auto [begin, end] = place_of(page, text, name);
  return read_rows(text.substr(begin, end - begin));
}

TableRows read_rows(const std::string& markdown) {
  std::istringstream lines(markdown);
  TableRows rows;
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with("|") || line.starts_with("| ---")) continue;
    std::istringstream cells(line.substr(1));
    rows.emplace_back();
    for (std::string cell; std::getline(cells, cell, '|');) rows.back().push_back(trimmed(cell));
  }
  return rows;
}

}  // namespace telekerf::reporting
