// SPDX-License-Identifier: Apache-2.0
#include "common/vision/vector/svg/xml.h"

#include <fmt/format.h>
#include <tinyxml2.h>

#include <algorithm>
#include <map>

namespace telekerf::vision {
namespace {

std::string_view take_word(std::string_view& text) {
  skip_blanks(text);
  const std::string_view word = text.substr(0, text.find_first_of(" \t\r\n>[]"));
  text.remove_prefix(word.size());
  return word;
}

}  // namespace

void skip_blanks(std::string_view& text) {
  text.remove_prefix(std::min(text.size(), text.find_first_not_of(kBlanks)));
}

tl::expected<std::string, std::string> with_entities(std::string text, std::size_t max_bytes) {
  const auto doctype = text.find("<!DOCTYPE");
  const auto open = doctype == std::string::npos ? doctype : text.find_first_of("[>", doctype);
  if (open == std::string::npos || text[open] != '[') return text;
  // The subset ends at a ] that no quotes hold.
  char quote = 0;
  std::size_t close = open;
  for (; close < text.size() && (quote != 0 || text[close] != ']'); ++close) {
    const char c = text[close];
    if (quote != 0 ? c == quote : c == '"' || c == '\'') quote = quote != 0 ? 0 : c;
  }
  const auto end = text.find('>', std::min(close, text.size()));
  if (end == std::string::npos) return text;  // its XML is damaged: the parser says where
  std::map<std::string, std::string, std::less<>> entities;
  std::string_view subset(text.data() + open, close - open);
  for (auto at = subset.find("<!ENTITY"); at != std::string_view::npos; at = subset.find("<!ENTITY")) {
    subset.remove_prefix(at + 8);
    const std::string name(take_word(subset));
    skip_blanks(subset);
    if (subset.empty() || (subset.front() != '"' && subset.front() != '\'')) {
      if (name != "%" && text.find("&" + name + ";") != std::string::npos)
        return tl::unexpected(fmt::format("entity \"{:.40}\" is not in this file", name));
      continue;
    }
    const auto last = subset.find(subset.front(), 1);
    if (last == std::string_view::npos) break;
    entities.emplace(name, subset.substr(1, last - 1));
  }
  // Lines are kept, so that what is said of a line is true.
  std::string out = text.substr(0, doctype);
  out.append(static_cast<std::size_t>(std::count(text.begin() + static_cast<std::ptrdiff_t>(doctype),
                                                 text.begin() + static_cast<std::ptrdiff_t>(end), '\n')),
             '\n');
  for (std::size_t at = end + 1; at < text.size();) {
    const auto next = std::min(text.find('&', at), text.size());
    out.append(text, at, next - at);
    at = next;
    if (at == text.size()) break;
    const auto semicolon = text.find(';', at);
    const auto found = semicolon == std::string::npos || semicolon - at > 64
                           ? entities.end()
                           : entities.find(std::string_view(text).substr(at + 1, semicolon - at - 1));
    if (found == entities.end()) {
      out.push_back(text[at++]);
      continue;
    }
    out += found->second;
    at = semicolon + 1;
    if (out.size() > max_bytes)
      return tl::unexpected(fmt::format("its entities make it larger than {} MB", max_bytes / 1000000));
  }
  return out;
}

std::string_view local_name(std::string_view name) {
  const auto colon = name.rfind(':');
  return colon == std::string_view::npos ? name : name.substr(colon + 1);
}

std::string_view svg_name(const tinyxml2::XMLElement& e) {
  const std::string_view whole(e.Name());
  const std::string_view name = local_name(whole);
  const std::string_view prefix = whole.substr(0, whole.size() - name.size());
  const std::string declaration =
      prefix.empty() ? "xmlns" : fmt::format("xmlns:{}", prefix.substr(0, prefix.size() - 1));
  const tinyxml2::XMLElement* root = &e;
  for (const tinyxml2::XMLElement* around = &e; around != nullptr;
       around = around->Parent() != nullptr ? around->Parent()->ToElement() : nullptr) {
    root = around;
    const char* space = around->Attribute(declaration.c_str());
    if (space != nullptr)
      return std::string_view(space) == "http://www.w3.org/2000/svg" ? name : std::string_view();
  }
  const bool all_prefixed = std::string_view(root->Name()).find(':') != std::string_view::npos;
  return prefix == "svg:" || (prefix.empty() && !all_prefixed) ? name : std::string_view();
}

bool is_met(const tinyxml2::XMLElement& e) {
  if (e.Attribute("requiredExtensions") != nullptr) return false;
  const char* languages = e.Attribute("systemLanguage");
  if (languages == nullptr) return true;
  std::string list = ",";
  for (; *languages != 0; ++languages) {
    if (*languages != ' ') list += static_cast<char>(*languages | 0x20);  // lower case; a comma stays one
  }
  list += ',';
  return list.find(",en,") != std::string::npos || list.find(",en-") != std::string::npos;
}

}  // namespace telekerf::vision
