// SPDX-License-Identifier: Apache-2.0
#include "common/runtime/settings.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "common/runtime/resources.h"
#include "common/runtime/settings_text.h"
#include "common/runtime/startup_error.h"

namespace telekerf {
namespace {

using Type = Setting::Type;

constexpr const char* kCommandLine = "command line";

/// The whole of `text` as a number. "+1", "-.5" and "1e3" are some.
std::optional<double> number_in(std::string_view text) {
  if (text.size() > 1 && text.front() == '+' && text[1] != '-') text.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.begin(), text.end(), value);
  if (error != std::errc() || end != text.end()) return std::nullopt;
  return value;
}

/// Words of a command line as the type of the setting wants them; what is no number stays a text, and is
/// refused as one.
ConfigValue value_of(const Setting& setting, const std::vector<std::string>& words) {
  switch (setting.type) {
    case Type::kSwitch:
      if (words.front() == "true" || words.front() == "false") return words.front() == "true";
      break;
    case Type::kNumber:
    case Type::kInteger:
      if (const auto number = number_in(words.front())) return *number;
      break;
    case Type::kNumbers: {
      std::vector<double> numbers;
      for (const std::string& word : words) {
        std::istringstream parts(word);
        for (std::string part; std::getline(parts, part, ',');) {
          const auto number = number_in(part);
          if (!number) return part;
          numbers.push_back(*number);
        }
      }
      return numbers;
    }
    case Type::kTexts: {
      std::vector<std::string> texts;
      for (const std::string& word : words) {
        std::istringstream parts(word);
        for (std::string part; std::getline(parts, part, ',');) texts.push_back(part);
      }
      return texts;
    }
    default:
      break;
  }
  return words.front();
}

std::string complaint_about(const std::string& text, const TextForm& form) {
  if (form.complaint) return form.complaint(text);
  return *form.shipped ? complaint_about_resource(form.shipped, text, form.extension) : "";
}

bool quoted(Type type) { return type == Type::kText || type == Type::kChoice || type == Type::kTexts; }

}  // namespace

Settings::Entry Settings::described(const std::string& name, Type type, const std::string& sentence) {
  Entry entry;
  entry.setting.name = name;
  entry.setting.type = type;
  entry.setting.sentence = sentence;
  return entry;
}

Setting& Settings::enter(Entry entry) {
  entry.setting.name = prefix_ + entry.setting.name;
  entry.setting.prefix = prefix_;
  entry.setting.initial = entry.get();
  entries_.push_back(std::move(entry));
  return entries_.back().setting;
}

Setting& Settings::add(const std::string& name, bool& value, const std::string& sentence) {
  Entry entry = described(name, Type::kSwitch, sentence);
  entry.get = [&value] { return value; };
  entry.set = [&value](const ConfigValue& given) { value = std::get<bool>(given); };
  return enter(std::move(entry));
}

Setting& Settings::add(const std::string& name, std::string& value, const TextForm& form,
                       const std::string& sentence) {
  Entry entry = described(name, Type::kText, sentence);
  entry.setting.text = form;
  entry.get = [&value] { return value; };
  entry.set = [&value](const ConfigValue& given) { value = std::get<std::string>(given); };
  return enter(std::move(entry));
}

Setting& Settings::add(const std::string& name, std::vector<std::string>& value, const TextForm& form,
                       const std::string& sentence) {
  Entry entry = described(name, Type::kTexts, sentence);
  entry.setting.text = form;
  entry.get = [&value] { return value; };
  entry.set = [&value](const ConfigValue& given) { value = std::get<std::vector<std::string>>(given); };
  return enter(std::move(entry));
}

Setting& Settings::add(const std::string& name, std::vector<double>& value, std::size_t count,
                       const Bounds& bounds, const std::string& sentence) {
  Entry entry = described(name, Type::kNumbers, sentence);
  entry.setting.bounds = bounds;
  entry.setting.count = count;
  entry.get = [&value] { return value; };
  entry.set = [&value](const ConfigValue& given) { value = std::get<std::vector<double>>(given); };
  return enter(std::move(entry));
}

void Settings::only_with(const std::vector<std::string>& names, const std::string& other,
                         const std::vector<std::string>& words) {
  add_condition(names, {other, words, true});
}

void Settings::not_with(const std::vector<std::string>& names, const std::string& other,
                        const std::vector<std::string>& words) {
  add_condition(names, {other, words, false});
}

void Settings::add_condition(const std::vector<std::string>& names, const Setting::Condition& condition) {
  for (const std::string& name : names) {
    const auto entry = std::find_if(entries_.begin(), entries_.end(),
                                    [&](const Entry& e) { return e.setting.name == prefix_ + name; });
    if (entry == entries_.end()) throw std::logic_error("no setting " + prefix_ + name);
    entry->setting.conditions.push_back(condition);
  }
}

void Settings::renamed(const std::string& old, const std::string& now) {
  gone_.push_back({old, fmt::format("is {} now", now)});
}

void Settings::moved(const std::string& old, const std::string& remedy) { gone_.push_back({old, remedy}); }

/// Empty: taken. Otherwise what is wrong.
std::string Settings::take(Entry& entry, const ConfigValue& value, const std::string& source) {
  const Setting& s = entry.setting;
  // A file that --print-config wrote has the empty defaults as well.
  const bool may_be_empty = s.may_be_empty || (source != kCommandLine && s.initial == value);
  switch (s.type) {
    case Type::kSwitch:
      if (!std::holds_alternative<bool>(value)) return "must be true or false";
      break;
    case Type::kNumber:
    case Type::kInteger: {
      const double* number = std::get_if<double>(&value);
      if (number == nullptr) return "must be a number";
      if (const std::string wrong = complaint_about(*number, s.bounds); !wrong.empty()) return wrong;
      if (s.type == Type::kInteger && *number != std::floor(*number)) return "must be a whole number";
      break;
    }
    case Type::kNumbers: {
      const auto* numbers = std::get_if<std::vector<double>>(&value);
      if (numbers != nullptr && numbers->empty()) {
        if (!may_be_empty) return "must not be empty";
        break;
      }
      if (numbers == nullptr || (s.count != 0 && numbers->size() != s.count))
        return s.count == 0 ? "must be numbers" : fmt::format("must be {} numbers", s.count);
      for (const double number : *numbers) {
        if (const std::string wrong = complaint_about(number, s.bounds); !wrong.empty()) return wrong;
      }
      break;
    }
    case Type::kTexts:
      if (const auto* texts = std::get_if<std::vector<std::string>>(&value)) {
        const bool empty = texts->empty() || std::find(texts->begin(), texts->end(), "") != texts->end();
        if (empty && !may_be_empty) return "must not be empty";
        break;
      }
      return "must be a list of texts";
    case Type::kText:
    case Type::kChoice: {
      const auto* text = std::get_if<std::string>(&value);
      if (text == nullptr) return "must be a text in quotes";
      if (s.type == Type::kText) {
        if (text->empty() && may_be_empty) break;
        if (const std::string wrong = complaint_about(*text, s.text); !wrong.empty()) return wrong;
        if (text->empty() && !s.text.complaint) return "must not be empty";
        break;
      }
      std::vector<std::string> words;
      for (const auto& choice : s.choices) words.push_back(choice.word);
      if (std::find(words.begin(), words.end(), *text) == words.end())
        return fmt::format("must be one of {}", fmt::join(words, ", "));
      break;
    }
  }
  entry.set(value);
  entry.given = source;
  return "";
}

/// `table`: empty, or with its dot.
void Settings::load_keys(const ConfigFile& file, const std::string& table) {
  for (Entry& entry : entries_) {
    const std::string key = table + entry.setting.name;
    if (entry.setting.positional || !file.has(key)) continue;
    const Type type = entry.setting.type;
    // What no setting can be, a date for instance, is refused as another kind.
    ConfigValue value =
        file.value(key).value_or(type == Type::kNumbers ? ConfigValue(std::string()) : std::vector<double>{});
    // An empty list does not say of what.
    if (type == Type::kTexts && file.value(key) == ConfigValue(std::vector<double>{}))
      value = std::vector<std::string>{};
    const std::string wrong = take(entry, value, file.name());
    if (!wrong.empty()) file.refuse(key, wrong);
  }
  for (const Gone& gone : gone_) {
    if (file.has(table + gone.name)) file.refuse(table + gone.name, gone.remedy);
  }
  for (const Entry& entry : entries_) {
    if (!entry.setting.positional) (void)file.value(table + entry.setting.name);  // known here
  }
}

void Settings::load(const ConfigFile& file) {
  load_keys(file, "");
  if (!table_.empty()) {
    load_keys(file, table_ + ".");
    // The tables of the others in a cell's file.
    for (const char* const program : {"master", "slave", "vision", "console", "machine"}) {
      if (program != table_) file.pass_over(program);
    }
  }
  file.refuse_unknown();
}

Settings::Entry* Settings::find_flag(const std::string& flag) {
  for (Entry& entry : entries_) {
    if (!entry.setting.positional && entry.setting.flag() == flag) return &entry;
  }
  for (const Gone& gone : gone_) {
    Setting before;
    before.name = gone.name;
    if (before.flag() == flag) throw usage_error(fmt::format("{}: {} {}", kCommandLine, flag, gone.remedy));
  }
  return nullptr;
}

Settings::Entry& Settings::next_argument(const std::string& word) {
  for (Entry& entry : entries_) {
    if (entry.setting.positional && entry.given.empty()) return entry;
  }
  throw usage_error(fmt::format("{}: '{}' is not understood; see --help", kCommandLine, word));
}

std::vector<Settings::Given> Settings::sorted(std::span<const std::string> words) {
  const auto is_flag = [](const std::string& word) { return word.size() > 2 && word.starts_with("--"); };
  std::vector<Given> all;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const std::string& word = words[i];
    if (!is_flag(word)) {
      Entry& entry = next_argument(word);
      entry.given = kCommandLine;
      all.push_back({&entry, {word}});
      continue;
    }
    const std::size_t equals = word.find('=');
    const std::string flag = word.substr(0, equals);
    Given given{flag == "--config" ? nullptr : find_flag(flag), {}};
    if (given.entry == nullptr && flag != "--config")
      throw usage_error(fmt::format("{}: there is no {}; see --help", kCommandLine, flag));
    const Type type = given.entry == nullptr ? Type::kText : given.entry->setting.type;
    const bool several = type == Type::kNumbers || type == Type::kTexts;
    // A list ends where it is complete, so that an argument may follow it.
    const std::size_t most = !several                          ? 1
                             : given.entry->setting.count != 0 ? given.entry->setting.count
                                                               : words.size();
    if (equals != word.npos) {
      given.words.push_back(word.substr(equals + 1));
    } else if (type == Type::kSwitch) {
      given.words.emplace_back("true");
    } else {
      while (i + 1 < words.size() && !is_flag(words[i + 1]) && given.words.size() < most) {
        given.words.push_back(words[++i]);
        if (several && given.words.size() == 1 && words[i].find(',') != word.npos) break;  // X,Y
      }
    }
    if (given.words.empty() || (given.entry == nullptr && given.words.front().empty()))
      throw usage_error(fmt::format("{}: {} needs a value; see --help", kCommandLine, flag));
    // A list of any length may be given in parts.
    const auto before = std::find_if(all.begin(), all.end(), [&](const Given& g) {
      return several && g.entry == given.entry && given.entry->setting.count == 0;
    });
    if (before != all.end()) {
      before->words.insert(before->words.end(), given.words.begin(), given.words.end());
    } else {
      all.push_back(std::move(given));
    }
  }
  return all;
}

void Settings::load(std::span<const std::string> words) {
  const std::vector<Given> all = sorted(words);
  for (const Given& given : all) {
    if (given.entry == nullptr) load(ConfigFile(std::filesystem::path(given.words.front())));
  }
  for (const Given& given : all) {
    if (given.entry == nullptr) continue;
    const Setting& setting = given.entry->setting;
    const std::string wrong = take(*given.entry, value_of(setting, given.words), kCommandLine);
    if (wrong.empty()) continue;
    const std::string shown = fmt::format("{}", fmt::join(given.words, " "));
    throw usage_error(fmt::format("{}: {} = {}: {}", kCommandLine, setting.name,
                                  quoted(setting.type) || shown.empty() ? fmt::format("'{}'", shown) : shown,
                                  wrong));
  }
}

void Settings::require_given() const {
  for (const Entry& entry : entries_) {
    const Setting& s = entry.setting;
    if (!s.required || !entry.given.empty()) continue;
    throw usage_error(
        fmt::format("{}: {} is missing: {}", kCommandLine, s.positional ? s.name : s.flag(), s.sentence));
  }
}

std::optional<std::string> Settings::word_of(const Setting& setting, const std::string& other) const {
  for (const std::string& name : {setting.prefix + other, other}) {
    for (const Entry& entry : entries_) {
      if (entry.setting.name != name) continue;
      const auto now = entry.get();
      if (!now) return std::nullopt;
      if (const auto* number = std::get_if<double>(&*now)) return fmt::format("{:g}", *number);
      if (const auto* text = std::get_if<std::string>(&*now)) return *text;
      if (const auto* set = std::get_if<bool>(&*now)) return *set ? "true" : "false";
    }
  }
  return std::nullopt;
}

void Settings::refuse_without_effect() const {
  for (const Entry& entry : entries_) {
    const Setting& s = entry.setting;
    if (entry.given.empty() || entry.get() == s.initial) continue;
    for (const Setting::Condition& condition : s.conditions) {
      const auto word = word_of(s, condition.other);
      if (!word) continue;
      const bool found =
          std::find(condition.words.begin(), condition.words.end(), *word) != condition.words.end();
      if (found == condition.among) continue;
      throw usage_error(fmt::format(
          "{}: {} has no effect with {} = {}; {}", entry.given, s.name, condition.other, *word,
          condition.among ? fmt::format("it needs {}", fmt::join(condition.words, " or ")) : "leave it out"));
    }
  }
}

std::string Settings::help() const { return help_text(declared()); }

std::string Settings::toml() const {
  std::vector<Setting> now = declared();
  for (std::size_t i = 0; i < now.size(); ++i) now[i].initial = entries_[i].get();
  return toml_text(now);
}

std::string Settings::given_toml() const {
  std::vector<Setting> now;
  for (const Entry& entry : entries_) {
    if (entry.given.empty()) continue;
    now.push_back(entry.setting);
    now.back().initial = entry.get();
  }
  return toml_text(now);
}

nlohmann::ordered_json Settings::json() const { return json_of(declared()); }

std::vector<Setting> Settings::declared() const {
  std::vector<Setting> all;
  for (const Entry& entry : entries_) all.push_back(entry.setting);
  return all;
}

}  // namespace telekerf
