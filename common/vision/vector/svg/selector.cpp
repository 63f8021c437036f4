// SPDX-License-Identifier: Apache-2.0
#include "common/vision/vector/svg/selector.h"

#include <tinyxml2.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>

#include "common/vision/vector/svg/xml.h"

namespace telekerf::vision {
namespace {

using tinyxml2::XMLElement;

bool is_blank(char c) { return kBlanks.find(c) != std::string_view::npos; }

bool is_name_letter(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '-' || c == '_' ||
         static_cast<signed char>(c) < 0;
}

/// An identifier, its escapes resolved; empty where there is none.
std::string take_identifier(std::string_view& text) {
  std::string out;
  while (!text.empty() && (is_name_letter(text.front()) || text.front() == '\\')) {
    if (text.front() != '\\') {
      out.push_back(text.front());
      text.remove_prefix(1);
      continue;
    }
    text.remove_prefix(1);
    unsigned code = 0;
    const char* last = text.data() + std::min<std::size_t>(6, text.size());
    const auto [end, error] = std::from_chars(text.data(), last, code, 16);
    if (error != std::errc{}) {
      if (text.empty()) return {};
      out.push_back(text.front());
      text.remove_prefix(1);
      continue;
    }
    text.remove_prefix(static_cast<std::size_t>(end - text.data()));
    if (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
    out.push_back(code < 0x80 ? static_cast<char>(code) : '?');
  }
  return out;
}

std::optional<CompoundSelector::Attribute> take_attribute(std::string_view& text) {
  CompoundSelector::Attribute out;
  const auto close = text.find(']');
  if (close == std::string_view::npos) return std::nullopt;
  std::string_view inside = text.substr(0, close);
  text.remove_prefix(close + 1);
  skip_blanks(inside);
  out.name = take_identifier(inside);
  if (inside.starts_with('|')) {
    if (!inside.starts_with("|=")) {  // a prefix
      inside.remove_prefix(1);
      out.name.push_back(':');
      out.name += take_identifier(inside);
    }
  }
  skip_blanks(inside);
  if (out.name.empty()) return std::nullopt;
  if (inside.empty()) return out;
  if (inside.front() != '=') {
    out.how = inside.front();
    inside.remove_prefix(1);
    if (std::string_view("~|^$*").find(out.how) == std::string_view::npos) return std::nullopt;
  } else {
    out.how = '=';
  }
  if (!inside.starts_with('=')) return std::nullopt;
  inside.remove_prefix(1);
  skip_blanks(inside);
  while (!inside.empty() && is_blank(inside.back())) inside.remove_suffix(1);
  if (inside.size() >= 2 && (inside.front() == '"' || inside.front() == '\'')) {
    if (inside.back() != inside.front()) return std::nullopt;
    out.value = inside.substr(1, inside.size() - 2);
  } else {
    out.value = take_identifier(inside);
    if (!inside.empty()) return std::nullopt;
  }
  return out;
}

/// "odd", "3", "2n+1", "-n+3"
bool read_nth(std::string_view text, CompoundSelector::Pseudo& out) {
  std::string letters;
  for (const char c : text) {
    if (!is_blank(c)) letters.push_back(static_cast<char>(std::tolower(static_cast<unsigned char>(c))));
  }
  const std::string_view flat = letters == "odd"    ? "2n+1"
                                : letters == "even" ? "2n"
                                                    : std::string_view(letters);
  const auto number = [](std::string_view word, int& value) {
    if (word.starts_with('+')) word.remove_prefix(1);
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    return error == std::errc{} && end == word.data() + word.size();
  };
  const auto n = flat.find('n');
  if (n == std::string_view::npos) return number(flat, out.offset);
  const std::string_view step = flat.substr(0, n);
  out.offset = 0;
  if (step.empty() || step == "+") {
    out.step = 1;
  } else if (step == "-") {
    out.step = -1;
  } else if (!number(step, out.step)) {
    return false;
  }
  return n + 1 == flat.size() || number(flat.substr(n + 1), out.offset);
}

std::optional<CompoundSelector> take_compound(std::string_view& text, int& specificity, int depth);

std::optional<CompoundSelector::Pseudo> take_pseudo(std::string_view& text, int& specificity, int depth) {
  CompoundSelector::Pseudo out;
  out.name = take_identifier(text);
  std::transform(out.name.begin(), out.name.end(), out.name.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  std::string_view inside;
  if (text.starts_with('(')) {
    int open = 0;
    std::size_t close = 0;
    for (; close < text.size(); ++close) {
      if (text[close] == '(') ++open;
      if (text[close] == ')' && --open == 0) break;
    }
    if (close >= text.size()) return std::nullopt;
    inside = text.substr(1, close - 1);
    text.remove_prefix(close + 1);
  }
  constexpr std::array<std::string_view, 6> kPlain{"root",       "first-child",   "last-child",
                                                   "only-child", "first-of-type", "last-of-type"};
  constexpr std::array<std::string_view, 9> kNever{
      "hover", "active", "focus", "visited", "target", "focus-visible", "focus-within", "checked", "link"};
  const auto among = [&](const auto& words) {
    return std::find(words.begin(), words.end(), out.name) != words.end();
  };
  if (among(kPlain) || among(kNever)) {
    specificity += 100;
    return out;
  }
  if (out.name == "nth-child" || out.name == "nth-of-type") {
    specificity += 100;
    return read_nth(inside, out) ? std::optional(out) : std::nullopt;
  }
  if ((out.name != "not" && out.name != "is" && out.name != "where") || depth > 0) return std::nullopt;
  int most = 0;
  while (true) {
    skip_blanks(inside);
    int own = 0;
    auto compound = take_compound(inside, own, depth + 1);
    if (!compound) return std::nullopt;
    out.inside.push_back(std::move(*compound));
    most = std::max(most, own);
    skip_blanks(inside);
    if (inside.empty()) break;
    if (inside.front() != ',') return std::nullopt;
    inside.remove_prefix(1);
  }
  if (out.name != "where") specificity += most;
  return out;
}

std::optional<CompoundSelector> take_compound(std::string_view& text, int& specificity, int depth) {
  CompoundSelector out;
  bool any = false;
  if (text.starts_with('*')) {
    text.remove_prefix(1);
    any = true;
  } else if (auto type = take_identifier(text); !type.empty()) {
    out.type = std::move(type);
    specificity += 1;
    any = true;
  }
  if (text.starts_with('|')) {  // the word before was a namespace
    text.remove_prefix(1);
    if (!out.type.empty()) specificity -= 1;
    out.type = take_identifier(text);
    if (!out.type.empty()) specificity += 1;
    if (text.starts_with('*')) text.remove_prefix(1);
  }
  while (!text.empty()) {
    const char kind = text.front();
    if (kind != '#' && kind != '.' && kind != '[' && kind != ':') break;
    text.remove_prefix(1);
    any = true;
    if (kind == '#' || kind == '.') {
      std::string name = take_identifier(text);
      if (name.empty()) return std::nullopt;
      specificity += kind == '#' ? 10000 : 100;
      if (kind == '.') {
        out.classes.push_back(std::move(name));
      } else {
        out.two_ids = out.two_ids || (!out.id.empty() && out.id != name);
        out.id = std::move(name);
      }
    } else if (kind == '[') {
      auto attribute = take_attribute(text);
      if (!attribute) return std::nullopt;
      specificity += 100;
      out.attributes.push_back(std::move(*attribute));
    } else {
      auto pseudo = take_pseudo(text, specificity, depth);
      if (!pseudo) return std::nullopt;
      out.pseudos.push_back(std::move(*pseudo));
    }
  }
  return any ? std::optional(out) : std::nullopt;
}

const XMLElement* parent_of(const XMLElement& e) {
  return e.Parent() != nullptr ? e.Parent()->ToElement() : nullptr;
}

bool has_word(std::string_view words, std::string_view word) {
  while (true) {
    skip_blanks(words);
    if (words.empty()) return false;
    std::size_t end = 0;
    while (end < words.size() && !is_blank(words[end])) ++end;
    if (words.substr(0, end) == word) return true;
    words.remove_prefix(end);
  }
}

bool matches(const CompoundSelector::Attribute& a, const XMLElement& e) {
  const char* text = e.Attribute(a.name.c_str());
  if (text == nullptr) return false;
  const std::string_view value(text);
  switch (a.how) {
    case 0:
      return true;
    case '=':
      return value == a.value;
    case '~':
      return has_word(value, a.value);
    case '|':
      return value == a.value ||
             (value.starts_with(a.value) && value.substr(a.value.size()).starts_with('-'));
    case '^':
      return !a.value.empty() && value.starts_with(a.value);
    case '$':
      return !a.value.empty() && value.ends_with(a.value);
    default:
      return !a.value.empty() && value.find(a.value) != std::string_view::npos;
  }
}

bool matches(const CompoundSelector& c, const XMLElement& e);

bool matches(const CompoundSelector::Pseudo& p, const XMLElement& e) {
  if (p.name == "root") return parent_of(e) == nullptr;
  if (p.name == "not" || p.name == "is" || p.name == "where") {
    const bool any =
        std::any_of(p.inside.begin(), p.inside.end(), [&](const auto& c) { return matches(c, e); });
    return any != (p.name == "not");
  }
  const bool of_type = p.name.ends_with("of-type");
  const char* name = of_type ? e.Name() : nullptr;
  const bool first = e.PreviousSiblingElement(name) == nullptr;
  const bool last = e.NextSiblingElement(name) == nullptr;
  if (p.name.starts_with("first")) return first;
  if (p.name.starts_with("last")) return last;
  if (p.name.starts_with("only")) return first && last;
  if (!p.name.starts_with("nth")) return false;  // the mouse's
  int number = 1;
  for (auto* before = e.PreviousSiblingElement(name); before != nullptr && number < 1000000;
       before = before->PreviousSiblingElement(name))
    ++number;
  const int way = number - p.offset;
  return p.step == 0 ? way == 0 : way % p.step == 0 && way / p.step >= 0;
}

bool matches(const CompoundSelector& c, const XMLElement& e) {
  if (c.two_ids) return false;
  if (!c.type.empty() && local_name(e.Name()) != c.type) return false;
  if (!c.id.empty()) {
    const char* id = e.Attribute("id");
    if (id == nullptr || c.id != id) return false;
  }
  if (!c.classes.empty()) {
    const char* classes = e.Attribute("class");
    if (classes == nullptr) return false;
    for (const auto& word : c.classes) {
      if (!has_word(classes, word)) return false;
    }
  }
  return std::all_of(c.attributes.begin(), c.attributes.end(),
                     [&](const auto& a) { return matches(a, e); }) &&
         std::all_of(c.pseudos.begin(), c.pseudos.end(), [&](const auto& p) { return matches(p, e); });
}

/// The compounds before `count` in the tree around `e`, which the one behind them has matched.
bool rest_matches(const Selector& s, std::size_t count, const XMLElement& e) {
  if (count == 0) return true;
  const CompoundSelector& next = s.compounds[count - 1];
  const char combinator = s.compounds[count].combinator;
  const bool sideways = combinator == '+' || combinator == '~';
  const XMLElement* at = sideways ? e.PreviousSiblingElement() : parent_of(e);
  for (; at != nullptr; at = sideways ? at->PreviousSiblingElement() : parent_of(*at)) {
    if (matches(next, *at) && rest_matches(s, count - 1, *at)) return true;
    if (combinator == '>' || combinator == '+') return false;
  }
  return false;
}

}  // namespace

std::optional<Selector> selector_of(std::string_view text) {
  constexpr std::size_t kMaxCompounds = 8;
  Selector out;
  char combinator = ' ';
  skip_blanks(text);
  while (!text.empty()) {
    auto compound = take_compound(text, out.specificity, 0);
    if (!compound || out.compounds.size() == kMaxCompounds) return std::nullopt;
    compound->combinator = combinator;
    out.compounds.push_back(std::move(*compound));
    const bool blank = !text.empty() && is_blank(text.front());
    skip_blanks(text);
    if (text.empty()) return out;
    combinator = ' ';
    if (text.front() == '>' || text.front() == '+' || text.front() == '~') {
      combinator = text.front();
      text.remove_prefix(1);
      skip_blanks(text);
      if (text.empty()) return std::nullopt;
    } else if (!blank) {
      return std::nullopt;
    }
  }
  return std::nullopt;
}

bool matches(const Selector& s, const XMLElement& e) {
  return matches(s.compounds.back(), e) && rest_matches(s, s.compounds.size() - 1, e);
}

}  // namespace telekerf::vision
