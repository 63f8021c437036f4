// SPDX-License-Identifier: Apache-2.0
#include "common/runtime/settings_text.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <nlohmann/json.hpp>

namespace telekerf {
namespace {

using Type = Setting::Type;

constexpr std::size_t kColumn = 30;  // where sentences begin
constexpr std::size_t kWidth = 110;

/// What is written after the flag.
std::string form_of(const Setting& s) {
  switch (s.type) {
    case Type::kSwitch:
      return "";
    case Type::kNumber:
      return "NUMBER";
    case Type::kInteger:
      return "INTEGER";
    case Type::kNumbers:
      return s.count == 0 ? "NUMBERS" : fmt::format("{} NUMBERS", s.count);
    case Type::kText:
      return s.text.form;
    case Type::kTexts:
      return s.text.form + "...";
    case Type::kChoice:
      break;
  }
  std::vector<std::string> words;
  for (const auto& choice : s.choices) words.push_back(choice.word);
  return fmt::format("{}", fmt::join(words, "|"));
}

std::string in_quotes(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    if (static_cast<unsigned char>(c) < 0x20) {
      out += fmt::format("\\u{:04x}", static_cast<unsigned char>(c));
    } else {
      out += c;
    }
  }
  return out + "\"";
}

/// As a TOML file has it.
std::string toml_of(const ConfigValue& value) {
  if (const bool* truth = std::get_if<bool>(&value)) return *truth ? "true" : "false";
  if (const double* number = std::get_if<double>(&value)) return fmt::format("{}", *number);
  if (const auto* text = std::get_if<std::string>(&value)) return in_quotes(*text);
  if (const auto* numbers = std::get_if<std::vector<double>>(&value))
    return fmt::format("[{}]", fmt::join(*numbers, ", "));
  std::vector<std::string> texts;
  for (const std::string& text : std::get<std::vector<std::string>>(value)) texts.push_back(in_quotes(text));
  return fmt::format("[{}]", fmt::join(texts, ", "));
}

bool is_empty(const ConfigValue& value) {
  const auto nothing = [](const auto* list) { return list != nullptr && list->empty(); };
  return nothing(std::get_if<std::string>(&value)) || nothing(std::get_if<std::vector<double>>(&value)) ||
         nothing(std::get_if<std::vector<std::string>>(&value));
}

/// "sentence (range) [default]".
std::string explained(const Setting& s) {
  std::string text = s.sentence;
  if (const std::string range = range_text(s.bounds); !range.empty()) text += fmt::format(" ({})", range);
  if (s.required || s.type == Type::kSwitch || !s.initial || is_empty(*s.initial)) return text;
  const auto* word = std::get_if<std::string>(&*s.initial);
  return text + fmt::format(" [{}]", word != nullptr ? *word : toml_of(*s.initial));
}

/// `text` from column kColumn on, `begun` columns of the first line being taken.
std::string wrapped(const std::string& text, std::size_t begun, std::size_t indent) {
  std::string out;
  std::size_t at = begun;
  if (at + 2 > indent) {
    out += '\n';
    at = 0;
  }
  out += std::string(indent - at, ' ');
  at = indent;
  for (std::size_t from = 0; from < text.size();) {
    const std::size_t end = std::min(text.find(' ', from), text.size());
    if (at > indent && at + 1 + (end - from) > kWidth) {
      out += '\n' + std::string(indent, ' ');
      at = indent;
    } else if (at > indent) {
      out += ' ';
      ++at;
    }
    out += text.substr(from, end - from);
    at += end - from;
    from = end + 1;
  }
  return out + '\n';
}

std::string line_of(const std::string& left, const std::string& right) {
  return left + wrapped(right, left.size(), kColumn);
}

}  // namespace

std::string help_text(const std::vector<Setting>& settings) {
  std::string text;
  for (const Setting& s : settings) {
    if (s.positional) text += line_of("  " + s.name, explained(s));
  }
  if (!text.empty()) text += '\n';
  for (const Setting& s : settings) {
    if (s.positional) continue;
    const std::string form = form_of(s);
    text += line_of("  " + s.flag() + (form.empty() ? "" : " " + form), explained(s));
    for (const auto& choice : s.choices) {
      if (!choice.sentence.empty())
        text += std::string(kColumn + 2, ' ') + choice.word +
                wrapped(choice.sentence, kColumn + 2 + choice.word.size(), kColumn + 24);
    }
  }
  return text;
}

std::string toml_text(const std::vector<Setting>& settings) {
  std::string text;
  for (const Setting& s : settings) {
    if (s.positional) continue;
    text += fmt::format("# {}", s.sentence);
    if (s.type == Type::kChoice) text += fmt::format(" ({})", form_of(s));
    if (s.type == Type::kText || s.type == Type::kTexts) text += fmt::format(" ({})", s.text.form);
    if (const std::string range = range_text(s.bounds); !range.empty()) text += fmt::format(" ({})", range);
    text += s.initial ? fmt::format("\n{} = {}\n", s.name, toml_of(*s.initial))
                      : fmt::format("\n# {} =\n", s.name);
  }
  return text;
}

nlohmann::ordered_json json_of(const std::vector<Setting>& settings) {
  static constexpr const char* kTypes[] = {"switch", "number",  "integer", "text",
                                           "choice", "numbers", "texts"};
  auto all = nlohmann::ordered_json::array();
  for (const Setting& s : settings) {
    nlohmann::ordered_json one{{"name", s.name}};
    if (!s.positional) one["flag"] = s.flag();
    one["type"] = kTypes[static_cast<int>(s.type)];
    if (s.type == Type::kNumber || s.type == Type::kInteger || s.type == Type::kNumbers) {
      if (s.bounds.min > -std::numeric_limits<double>::infinity()) one["min"] = s.bounds.min;
      if (s.bounds.max < std::numeric_limits<double>::infinity()) one["max"] = s.bounds.max;
      if (*s.bounds.unit) one["unit"] = s.bounds.unit;
    }
    if (s.type == Type::kText || s.type == Type::kTexts) {
      one["form"] = s.text.form;
      if (*s.text.shipped) {
        one["shipped"] = s.text.shipped;
        one["extension"] = s.text.extension;
      }
    }
    for (const auto& choice : s.choices)
      one["choices"].push_back({{"word", choice.word}, {"sentence", choice.sentence}});
    if (s.count != 0) one["count"] = s.count;
    if (s.required) one["required"] = true;
    if (s.initial) std::visit([&one](const auto& value) { one["default"] = value; }, *s.initial);
    one["sentence"] = s.sentence;
    all.push_back(std::move(one));
  }
  return all;
}

}  // namespace telekerf
