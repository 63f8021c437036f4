// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <optional>
#include <regex>
#include <sstream>

#include "tests/structure/rules.h"

namespace telekerf::structure {
namespace {

constexpr char kFiller = '\x01';  // stands for what is no prose, so that places stay what they are
constexpr char kMarked = '@';     // a number that names where it comes from

void fill(std::string& text, std::size_t at, std::size_t size) {
  for (std::size_t i = at; i < at + size; ++i)
    if (text[i] != '\n') text[i] = kFiller;
}

void fill_all(std::string& text, const std::regex& what) {
  const std::string before = text;
  for (std::sregex_iterator at(before.begin(), before.end(), what), end; at != end; ++at)
    fill(text, static_cast<std::size_t>(at->position()), static_cast<std::size_t>(at->length()));
}

/// From `begin` to the end of `end`, again and again.
void fill_between(std::string& text, const std::string& begin, const std::string& end) {
  for (std::size_t at = text.find(begin); at != text.npos; at = text.find(begin, at + 1)) {
    const std::size_t stop = text.find(end, at + begin.size());
    if (stop == text.npos) return;
    fill(text, at, stop + end.size() - at);
  }
}

using Cells = std::vector<std::string>;

std::string trimmed(const std::string& text) {
  const std::size_t from = text.find_first_not_of(" \n");
  return from == text.npos ? "" : text.substr(from, text.find_last_not_of(" \n") + 1 - from);
}

Cells split(const std::string& text, char between) {
  Cells out;
  std::istringstream in(text);
  for (std::string part; std::getline(in, part, between);) out.push_back(trimmed(part));
  return out;
}

/// The rows of a page's generated table, the head first.
std::vector<Cells> table_of(const std::string& page, const std::string& name) {
  const std::size_t from = page.find("<!-- table " + name + " -->");
  const std::size_t to = page.find("<!-- end of " + name + " -->");
  std::vector<Cells> rows;
  if (from == page.npos || to == page.npos) return rows;
  for (const std::string& line : lines_of(page.substr(from, to - from)))
    if (line.starts_with("| ") && !line.starts_with("| ---")) rows.push_back(split(line.substr(1), '|'));
  return rows;
}

/// Some number of the cell, rounded as `figure` is, is `figure`.
bool tells(const std::string& cell, std::string figure) {
  figure.erase(std::remove(figure.begin(), figure.end(), ','), figure.end());
  const std::size_t point = figure.find('.');
  const double half_digit =
      0.5 * std::pow(10.0, point == figure.npos ? 0.0 : -double(figure.size() - point - 1));
  static const std::regex kNumber(R"(-?\d+(?:\.\d+)?(?:e[-+]?\d+)?)");
  for (std::sregex_iterator at(cell.begin(), cell.end(), kNumber), end; at != end; ++at)
    if (std::abs(std::abs(std::stod(at->str())) - std::stod(figure)) <= 1.001 * half_digit) return true;
  return false;
}

/// The cell that a mark names: "claim ID", or "cell TABLE: ROW, ..., COLUMN" of the same page or of
/// "PAGE#TABLE" beside it. A row is named by its first cells.
std::optional<std::string> cell_of(const Repository& repository, const std::string& page,
                                   const std::string& mark) {
  std::string file = page, table;
  Cells row;
  std::string column;
  if (mark.starts_with("claim ")) {
    file = "docs/results/claims.md";
    table = "claims";
    row = {mark.substr(6)};
    column = "our figure";
  } else {
    const std::size_t colon = mark.find(": ");
    if (!mark.starts_with("cell ") || colon == mark.npos) return std::nullopt;
    table = mark.substr(5, colon - 5);
    if (const std::size_t hash = table.find('#'); hash != table.npos) {
      file = "docs/results/" + table.substr(0, hash);
      table = table.substr(hash + 1);
    }
    row = split(mark.substr(colon + 2), ';');
    if (row.size() < 2) return std::nullopt;
    column = row.back();
    row.pop_back();
  }
  if (!repository.holds(file)) return std::nullopt;
  const std::vector<Cells> rows = table_of(repository.files.at(file), table);
  if (rows.empty()) return std::nullopt;
  const auto place = std::find(rows[0].begin(), rows[0].end(), column);
  if (place == rows[0].end()) return std::nullopt;
  for (const Cells& cells : rows) {
    if (cells.size() != rows[0].size() || !std::equal(row.begin(), row.end(), cells.begin())) continue;
    std::string cell = cells[static_cast<std::size_t>(place - rows[0].begin())];
    // A claim's figure stands behind what it is.
    if (mark.starts_with("claim ")) cell = cell.substr(cell.rfind(": ") + 2);
    return cell;
  }
  return std::nullopt;
}

/// A row of the list of numbers that may be typed.
struct Typed {
  std::string page, kind, where;
};

std::vector<Typed> typed_of(const std::string& list, Breaches& breaches) {
  std::vector<Typed> out;
  for (const std::string& line : lines_of(list)) {
    if (line.empty() || line.starts_with("#")) continue;
    const std::size_t first = line.find(" | "), second = line.find(" | ", first + 3);
    if (first == line.npos || second == line.npos) {
      breaches.push_back("tests/structure/typed_numbers.txt: \"" + line + "\" is not PAGE | KIND | WHERE");
      continue;
    }
    out.push_back(
        {line.substr(0, first), line.substr(first + 3, second - first - 3), line.substr(second + 3)});
  }
  return out;
}

struct Stretch {
  std::size_t from = 0, to = 0;
};

/// A heading's section without those below it, or the text wherever it stands; newlines count as blanks.
std::vector<Stretch> stretches_of(const std::string& page, const std::string& where) {
  if (where.starts_with("#")) {
    const std::size_t from = ("\n" + page).find("\n" + where + "\n");
    if (from == page.npos) return {};
    return {{from, std::min(page.size(), page.find("\n#", from))}};
  }
  std::string flat = page;
  std::replace(flat.begin(), flat.end(), '\n', ' ');
  std::vector<Stretch> out;
  for (std::size_t at = flat.find(where); at != flat.npos; at = flat.find(where, at + 1))
    out.push_back({at, at + where.size()});
  return out;
}

/// The text from the heading above `at` to the next one.
std::string section_at(const std::string& page, std::size_t at) {
  const std::size_t above = page.rfind("\n#", at), below = page.find("\n#", at);
  const std::size_t from = above == page.npos ? 0 : above;
  return page.substr(from, below == page.npos ? page.npos : below - from);
}

bool has_test(const Repository& repository, const std::string& name) {
  return std::any_of(repository.files.begin(), repository.files.end(), [&](const auto& file) {
    return file.first.starts_with("tests/") && file.second.find(", " + name + ")") != file.second.npos;
  });
}

/// Why a row excuses nothing; empty: it does.
std::string fault_of(const Repository& repository, const Typed& row, const std::vector<Stretch>& at) {
  const std::string& page = repository.files.at(row.page);
  if (at.empty()) return "is not there";
  if (row.kind == "setting" || row.kind == "arithmetic") return "";
  if (row.kind.starts_with("test "))
    return has_test(repository, row.kind.substr(5))
               ? ""
               : "names the test " + row.kind.substr(5) + ", which is not there";
  if (row.kind == "clock" || row.kind == "long")
    return section_at(page, at.front().from).find("telekerf") != std::string::npos ||
                   section_at(page, at.front().from).find("bench_") != std::string::npos
               ? ""
               : "stands in a section that names no command";
  return "has the kind " + row.kind + ", which is none";
}

/// The page as prose: no code, no address, no generated table; numbers that say where they come from are
/// checked and marked.
std::string prose_with_marks(const Repository& repository, const std::string& path, Breaches& breaches) {
  static const std::regex kCode("`[^`\n]*`"), kTarget(R"(\]\([^)]*\))"), kComment("<!--[^>]*-->"),
      kTag("<[a-z][^>]*>");
  static const std::regex kMark(R"((\d[\d,]*(?:\.\d+)?)<!-- ((?:claim|cell) [^>]*) -->)");
  std::string text = repository.files.at(path);
  fill_between(text, "<!-- table ", "<!-- end of ");
  fill_between(text, "\n```", "\n```");
  fill_all(text, kCode);
  fill_all(text, kTarget);
  const std::string before = text;
  for (std::sregex_iterator at(before.begin(), before.end(), kMark), end; at != end; ++at) {
    std::string mark = (*at)[2];
    std::replace(mark.begin(), mark.end(), '\n', ' ');
    const auto cell = cell_of(repository, path, mark);
    if (!cell)
      breaches.push_back(path + " says " + (*at)[1].str() + " of " + mark + ", which is not there");
    else if (!tells(*cell, (*at)[1]))
      breaches.push_back(path + " says " + (*at)[1].str() + " of " + mark + ", where " + *cell + " stands");
    fill(text, static_cast<std::size_t>(at->position()), static_cast<std::size_t>(at->length()));
    text[static_cast<std::size_t>(at->position())] = kMarked;
  }
  fill_all(text, kComment);
  fill_all(text, kTag);
  return text;
}

}  // namespace

Breaches typed_numbers(const Repository& repository, const std::string& list) {
  // Numbers in a row share the unit of the last: "7.3, 177 and 2,600 um".
  static const std::string kNumber = R"((?:\d[\d,]*(?:\.\d+)?|@))";
  static const std::string kUnit =
      "(?:um|µm|mm|m|nm|mm/s|m/s2|m/s|ms|us|s|minutes?|seconds?|N/m|mN|N|mJ|J|%|rad/s|kHz|Hz|bits?|bytes(?:/"
      "s)?|octets|MiB|W|"
      "kg|px|pixels?|x|times|dB|ppm|depths? of field)";
  static const std::regex kFigure("(^|[^\\w.@,-])(" + kNumber +
                                  "(?:(?:,? and|,? or|,| to| /| of|-| x)?[\\s\x01]+" + kNumber + "|-" +
                                  kNumber + ")*)[\\s\x01]*" + kUnit + "(?![\\w/])");
  Breaches breaches;
  const std::vector<Typed> typed = typed_of(list, breaches);
  for (const Typed& row : typed)
    if (!repository.holds(row.page))
      breaches.push_back("tests/structure/typed_numbers.txt: " + row.page + " is not there");
  for (const auto& [path, text] : repository.files) {
    if (path != "README.md" && !(path.starts_with("docs/results/") && path.ends_with(".md"))) continue;
    const std::string prose = prose_with_marks(repository, path, breaches);
    std::vector<Stretch> excused;
    for (const Typed& row : typed) {
      if (row.page != path) continue;
      const std::vector<Stretch> at = stretches_of(text, row.where);
      const std::string fault = fault_of(repository, row, at);
      if (!fault.empty())
        breaches.push_back("tests/structure/typed_numbers.txt: \"" + row.where + "\" of " + path + " " +
                           fault);
      excused.insert(excused.end(), at.begin(), at.end());
    }
    for (std::sregex_iterator at(prose.begin(), prose.end(), kFigure), end; at != end; ++at) {
      const std::string numbers = (*at)[2];
      if (numbers.find_first_of("0123456789") == numbers.npos) continue;  // all of them are marked
      const auto from = static_cast<std::size_t>(at->position(2));
      const auto is_excused = std::any_of(excused.begin(), excused.end(), [&](const Stretch& stretch) {
        return stretch.from <= from && from < stretch.to;
      });
      if (is_excused) continue;
      std::string said = at->str(0);
      said.erase(std::remove(said.begin(), said.end(), kFiller), said.end());
      std::replace(said.begin(), said.end(), '\n', ' ');
      const auto line =
          1 + std::count(prose.begin(), prose.begin() + static_cast<std::ptrdiff_t>(from), '\n');
      breaches.push_back(
          path + ":" + std::to_string(line) + ": \"" + trimmed(said) +
          "\" is typed by hand: name the claim or the table's cell behind it, or give the reason in "
          "tests/structure/typed_numbers.txt");
    }
  }
  return breaches;
}

}  // namespace telekerf::structure
