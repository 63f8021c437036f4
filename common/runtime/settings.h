// SPDX-License-Identifier: Apache-2.0
// A setting is declared once and read two ways: as key `stream_hz` of a configuration file and as flag
// --stream-hz. Help, refusals, the reference page and shell completion come from the same declaration.
#pragma once

#include <concepts>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "common/runtime/config.h"
#include "common/runtime/enum_table.h"
#include "common/runtime/setting.h"

namespace telekerf {

namespace settings_detail {
template <typename T>
struct Plain {
  using Type = T;
};
template <typename T>
struct Plain<std::optional<T>> {
  using Type = T;
};
template <typename T>
using PlainType = typename Plain<T>::Type;
template <typename T>
concept Number = std::is_arithmetic_v<PlainType<T>> && !std::same_as<PlainType<T>, bool>;
}  // namespace settings_detail

/// The settings of one command: they live in plain structs (their values there are the defaults), and are
/// loaded from the file named by --config, then from the command line. A setting may be std::optional: it has
/// no default. Refusals name source, key, value and bound.
class Settings {
 public:
  template <settings_detail::Number T>
  Setting& add(const std::string& name, T& value, const Bounds& bounds, const std::string& sentence) {
    using Plain = settings_detail::PlainType<T>;
    Entry entry =
        described(name, std::integral<Plain> ? Setting::Type::kInteger : Setting::Type::kNumber, sentence);
    entry.setting.bounds = bounds;
    entry.get = [&value]() -> std::optional<ConfigValue> {
      const std::optional<Plain> now = value;
      if (!now) return std::nullopt;
      return static_cast<double>(*now);
    };
    entry.set = [&value](const ConfigValue& given) { value = static_cast<Plain>(std::get<double>(given)); };
    return enter(std::move(entry));
  }
  /// One of the table's words; the table must outlive the settings.
  template <typename T>
  Setting& add(const std::string& name, T& value, const EnumTable<settings_detail::PlainType<T>>& table,
               const std::string& sentence) {
    Entry entry = described(name, Setting::Type::kChoice, sentence);
    for (const auto& row : table)
      entry.setting.choices.push_back({std::string(row.word), std::string(row.sentence)});
    entry.get = [&value, table]() -> std::optional<ConfigValue> {
      const std::optional<settings_detail::PlainType<T>> now = value;
      if (!now) return std::nullopt;
      return std::string(table.word(*now));
    };
    entry.set = [&value, table](const ConfigValue& given) {
      value = *table.find(std::get<std::string>(given));
    };
    return enter(std::move(entry));
  }
  /// True when the flag is given; in a file true or false.
  Setting& add(const std::string& name, bool& value, const std::string& sentence);
  Setting& add(const std::string& name, std::string& value, const TextForm& form,
               const std::string& sentence);
  Setting& add(const std::string& name, std::vector<std::string>& value, const TextForm& form,
               const std::string& sentence);
  /// `count` numbers, 0: any number of them.
  Setting& add(const std::string& name, std::vector<double>& value, std::size_t count, const Bounds& bounds,
               const std::string& sentence);

  /// Before the names of all that is added from now on: two parts of one command may have settings of the
  /// same name.
  void prefix(const std::string& word) { prefix_ = word; }

  /// No effect unless (or if) another setting is one of the words ("0" of a number, "true" of a switch): then
  /// these are refused, if they are given and not the default. Where there is no such other setting, or none
  /// is given, they are read.
  void only_with(const std::vector<std::string>& names, const std::string& other,
                 const std::vector<std::string>& words);
  void not_with(const std::vector<std::string>& names, const std::string& other,
                const std::vector<std::string>& words);

  /// A key and flag of before: refused with the name of today, or with the program that has it now.
  void renamed(const std::string& old, const std::string& now);
  void moved(const std::string& old, const std::string& remedy);

  /// A file may serve a whole cell: of the tables [master], [slave], ... this one is read after the keys that
  /// stand above all tables, and those of the other programs are passed over.
  void table(const std::string& name) { table_ = name; }

  /// Throws StartupError.
  void load(const ConfigFile& file);
  /// The words after the program's (and command's) name. Throws StartupError.
  void load(std::span<const std::string> words);
  /// Throws StartupError if a setting that must be given has not been.
  void require_given() const;
  /// Throws StartupError if a setting is given that nothing reads beside the others.
  void refuse_without_effect() const;

  /// What --help lists, what --config reads, and all of it for programs.
  std::string help() const;
  std::string toml() const;
  std::string given_toml() const;  ///< of it what has been given
  nlohmann::ordered_json json() const;
  std::vector<Setting> declared() const;

 private:
  struct Entry {
    Setting setting;
    std::function<std::optional<ConfigValue>()> get;
    std::function<void(const ConfigValue&)> set;
    std::string given;  ///< by whom: the file's name or the command line
  };
  struct Gone {
    std::string name;
    std::string remedy;
  };
  static Entry described(const std::string& name, Setting::Type type, const std::string& sentence);
  Setting& enter(Entry entry);
  std::string take(Entry& entry, const ConfigValue& value, const std::string& source);
  /// The word that another setting has now; none: the command has no such setting, or it is not set.
  std::optional<std::string> word_of(const Setting& setting, const std::string& other) const;
  /// Words of the command line that belong to one setting.
  struct Given {
    Entry* entry;  ///< null: --config
    std::vector<std::string> words;
  };
  std::vector<Given> sorted(std::span<const std::string> words);
  void add_condition(const std::vector<std::string>& names, const Setting::Condition& condition);
  void load_keys(const ConfigFile& file, const std::string& table);
  Entry* find_flag(const std::string& flag);
  Entry& next_argument(const std::string& word);

  std::string prefix_;
  std::string table_;
  std::vector<Entry> entries_;
  std::vector<Gone> gone_;
};

}  // namespace telekerf
