// SPDX-License-Identifier: Apache-2.0
#include "common/vision/vector/svg/cascade.h"

#include <fmt/format.h>
#include <tinyxml2.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <tuple>

#include "common/vision/vector/svg/xml.h"

namespace telekerf::vision {
namespace {

/// Written as attributes too.
constexpr std::array<std::string_view, 21> kAttributes{"display",
                                                       "visibility",
                                                       "opacity",
                                                       "fill",
                                                       "stroke",
                                                       "fill-opacity",
                                                       "stroke-opacity",
                                                       "stroke-width",
                                                       "color",
                                                       "clip-path",
                                                       "mask",
                                                       "marker",
                                                       "marker-start",
                                                       "marker-mid",
                                                       "marker-end",
                                                       "transform",
                                                       "transform-origin",
                                                       "transform-box",
                                                       "stroke-dasharray",
                                                       "clip-rule",
                                                       "overflow"};
/// In style alone; as attributes they are the elements' own, or nothing.
constexpr std::array<std::string_view, 19> kStyles{"x",
                                                   "y",
                                                   "width",
                                                   "height",
                                                   "cx",
                                                   "cy",
                                                   "r",
                                                   "rx",
                                                   "ry",
                                                   "d",
                                                   "translate",
                                                   "rotate",
                                                   "scale",
                                                   "offset-path",
                                                   "offset",
                                                   "zoom",
                                                   "all",
                                                   "clip",
                                                   "content-visibility"};

/// First words of what a display can be.
constexpr std::array<std::string_view, 22> kDisplays{
    "none",        "inline",       "block",       "inline-block", "contents",   "flex",
    "inline-flex", "grid",         "inline-grid", "flow-root",    "list-item",  "run-in",
    "table",       "inline-table", "ruby",        "table-row",    "table-cell", "compact",
    "marker",      "inherit",      "initial",     "unset"};

template <typename List>
bool among(const List& list, std::string_view name) {
  return std::find(list.begin(), list.end(), name) != list.end();
}

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kBlank = " \t\r\n\f";
  text.remove_prefix(std::min(text.size(), text.find_first_not_of(kBlank)));
  return text.substr(0, text.find_last_not_of(kBlank) + 1);
}

std::string lower(std::string_view text) {
  std::string out(text);
  std::transform(out.begin(), out.end(), out.begin(), [](unsigned char c) { return std::tolower(c); });
  return out;
}

/// Without comments and the marks that hide a sheet from old browsers.
std::string without_comments(std::string_view text) {
  std::string out;
  while (!text.empty()) {
    const auto open = text.find("/*");
    out += text.substr(0, open);
    if (open == std::string_view::npos) break;
    const auto close = text.find("*/", open + 2);
    out.push_back(' ');
    if (close == std::string_view::npos) break;
    text.remove_prefix(close + 2);
  }
  for (const std::string_view mark : {"<!--", "-->"}) {
    for (auto at = out.find(mark); at != std::string::npos; at = out.find(mark))
      out.replace(at, mark.size(), 1, ' ');
  }
  return out;
}

/// Up to one of `ends` that stands in no quotes or brackets.
std::size_t find_outside(std::string_view text, std::string_view ends) {
  char quote = 0;
  int brackets = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '\\') {
      ++i;
    } else if (quote != 0) {
      if (c == quote) quote = 0;
    } else if (c == '"' || c == '\'') {
      quote = c;
    } else if (brackets == 0 && ends.find(c) != std::string_view::npos) {
      return i;
    } else if (c == '(' || c == '[') {
      ++brackets;
    } else if ((c == ')' || c == ']') && brackets > 0) {
      --brackets;
    }
  }
  return text.size();
}

/// From behind a { to its }.
std::size_t find_close(std::string_view text) {
  int open = 1;
  for (std::size_t at = 0; at < text.size(); ++at) {
    at += find_outside(text.substr(at), "{}");
    if (at >= text.size()) break;
    open += text[at] == '{' ? 1 : -1;
    if (open == 0) return at;
  }
  return text.size();
}

}  // namespace

std::vector<Cascade::Declaration> Cascade::declarations_of(std::string_view text) {
  std::vector<Declaration> out;
  while (!text.empty()) {
    const std::size_t end = find_outside(text, ";");
    const std::string_view one = text.substr(0, end);
    text.remove_prefix(std::min(text.size(), end + 1));
    const auto colon = one.find(':');
    if (colon == std::string_view::npos) continue;
    Declaration d;
    d.name = lower(trimmed(one.substr(0, colon)));
    std::string_view value = trimmed(one.substr(colon + 1));
    if (const auto mark = value.rfind('!');
        mark != std::string_view::npos && lower(trimmed(value.substr(mark + 1))) == "important") {
      d.important = true;
      value = trimmed(value.substr(0, mark));
    }
    d.value = value;
    if (d.name == "display" && !among(kDisplays, lower(d.value))) continue;  // as if it were not there
    if (!d.value.empty() && (among(kAttributes, d.name) || among(kStyles, d.name)))
      out.push_back(std::move(d));
  }
  return out;
}

void Cascade::add_sheet(std::string_view text) { add_rules(without_comments(text), 0); }

void Cascade::complain(std::string_view prelude, std::string_view body) {
  std::string flat(body);  // also what rules within it declare
  std::replace_if(
      flat.begin(), flat.end(), [](char c) { return c == '{' || c == '}'; }, ';');
  if (!trouble_.empty() || declarations_of(flat).empty()) return;
  std::string shown(trimmed(prelude).substr(0, 60));
  std::replace_if(
      shown.begin(), shown.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
  trouble_ = fmt::format(
      "the style sheet's rule \"{}\" decides what is shown and cannot be followed; write it as attributes of "
      "the "
      "elements",
      shown);
}

void Cascade::add_rules(std::string_view text, int depth) {
  while (!trimmed(text).empty()) {
    const std::size_t end = find_outside(text, "{;");
    const std::string_view prelude = text.substr(0, end);
    if (end >= text.size() || text[end] == ';') {
      if (lower(trimmed(prelude)).starts_with("@import") && trouble_.empty())
        trouble_ =
            "the style sheet imports another one (@import), which is not read; put its rules into the file";
      text.remove_prefix(std::min(text.size(), end + 1));
      continue;
    }
    text.remove_prefix(end + 1);
    const std::size_t close = find_close(text);
    const std::string_view body = text.substr(0, close);
    text.remove_prefix(std::min(text.size(), close + 1));
    trimmed(prelude).starts_with('@') ? add_at_rule(prelude, body, depth) : add_rule(prelude, body);
  }
}

void Cascade::add_at_rule(std::string_view prelude, std::string_view body, int depth) {
  const std::string words = lower(trimmed(prelude));
  for (const std::string_view silent :
       {"@font-face", "@page", "@counter-style", "@property", "@font-feature-values"}) {
    if (words.starts_with(silent)) return;
  }
  const bool plain = words == "@media all" || words == "@media screen" || words == "@media screen, print" ||
                     words == "@media print, screen" || words == "@media all, screen";
  if (plain && depth < 4) return add_rules(body, depth + 1);
  if (words == "@media print") return;
  std::string_view rest = body;  // each rule within it may matter
  while (!rest.empty() && trouble_.empty()) {
    const std::size_t open = find_outside(rest, "{");
    if (open >= rest.size()) break;
    rest.remove_prefix(open + 1);
    const std::size_t close = find_close(rest);
    complain(prelude, rest.substr(0, close));
    rest.remove_prefix(std::min(rest.size(), close + 1));
  }
}

void Cascade::add_rule(std::string_view prelude, std::string_view body) {
  if (body.find('{') != std::string_view::npos) return complain(prelude, body);
  std::vector<Declaration> declarations = declarations_of(body);
  if (declarations.empty()) return;
  for (std::string_view rest = prelude; !rest.empty();) {
    const std::size_t end = find_outside(rest, ",");
    auto selector = selector_of(rest.substr(0, end));
    rest.remove_prefix(std::min(rest.size(), end + 1));
    if (!selector) return complain(prelude, body);
    const CompoundSelector& last = selector->compounds.back();
    const std::string key = !last.id.empty()        ? fmt::format("#{}", last.id)
                            : !last.classes.empty() ? fmt::format(".{}", last.classes.front())
                            : !last.type.empty()    ? last.type
                                                    : std::string(1, '*');
    by_key_[key].push_back(rules_.size());
    rules_.push_back({std::move(*selector), declarations});
  }
}

Properties Cascade::of(const tinyxml2::XMLElement& e) const {
  Properties out;
  std::string inline_style;
  for (auto* a = e.FirstAttribute(); a != nullptr; a = a->Next()) {
    const std::string_view name(a->Name());
    if (name == "style") inline_style = a->Value();
    if (among(kAttributes, name)) out[std::string(name)] = std::string(trimmed(a->Value()));
  }
  std::vector<std::tuple<int, std::size_t>> found;  // specificity, place
  const auto look = [&](std::string_view key) {
    const auto at = by_key_.find(key);
    if (at == by_key_.end()) return;
    for (const std::size_t k : at->second) {
      if (matches(rules_[k].selector, e)) found.emplace_back(rules_[k].selector.specificity, k);
    }
  };
  if (!rules_.empty()) {
    look("*");
    look(local_name(e.Name()));
    if (const char* id = e.Attribute("id")) look(fmt::format("#{}", id));
    if (const char* classes = e.Attribute("class")) {
      for (std::string_view rest = trimmed(classes); !rest.empty();) {
        const std::string_view word = rest.substr(0, rest.find_first_of(" \t\r\n\f"));
        look(fmt::format(".{}", word));
        rest = trimmed(rest.substr(word.size()));
      }
    }
    std::sort(found.begin(), found.end());
  }
  const std::vector<Declaration> own =
      inline_style.empty() ? std::vector<Declaration>{} : declarations_of(without_comments(inline_style));
  for (const bool important : {false, true}) {
    for (const auto& [specificity, k] : found) {
      for (const Declaration& d : rules_[k].declarations) {
        if (d.important == important) out[d.name] = d.value;
      }
    }
    for (const Declaration& d : own) {
      if (d.important == important) out[d.name] = d.value;
    }
  }
  return out;
}

}  // namespace telekerf::vision
