// SPDX-License-Identifier: Apache-2.0
// TOML file -> plain structs: every key is read through a bound, unknown keys are refused by name.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "common/runtime/bounds.h"
#include "common/runtime/enum_table.h"

namespace telekerf {

/// A value as a file or a command line gives it; all numbers are doubles.
using ConfigValue = std::variant<bool, double, std::string, std::vector<double>, std::vector<std::string>>;

/// Reads one TOML file. Keys are dotted paths ("geometry.base_radius_m"). Every reader marks its key as
/// known; `refuse_unknown()` then names the first key that nobody asked for. All errors are StartupErrors
/// that name the file, key, value and bound.
class ConfigFile {
 public:
  explicit ConfigFile(const std::filesystem::path& file);
  /// Parses text instead of a file; `name` stands in messages.
  ConfigFile(const std::string& text, const std::string& name);
  ~ConfigFile();
  ConfigFile(ConfigFile&&) noexcept;
  ConfigFile& operator=(ConfigFile&&) noexcept;

  bool has(const std::string& key) const;
  /// Whatever stands there; none if nothing does, or something that no ConfigValue holds.
  std::optional<ConfigValue> value(const std::string& key) const;
  double number(const std::string& key, Bounds bounds = {}) const;
  double number_or(const std::string& key, double fallback, Bounds bounds = {}) const;
  std::int64_t integer(const std::string& key, Bounds bounds = {}) const;
  std::int64_t integer_or(const std::string& key, std::int64_t fallback, Bounds bounds = {}) const;
  bool boolean_or(const std::string& key, bool fallback) const;
  std::string text(const std::string& key) const;
  std::string text_or(const std::string& key, const std::string& fallback) const;
  /// One of `choices`, refused otherwise.
  std::string choice_or(const std::string& key, const std::string& fallback,
                        const std::vector<std::string>& choices) const;
  /// What one of the table's words stands for.
  template <typename Value>
  Value choice_or(const std::string& key, const Value& fallback, const EnumTable<Value>& table) const {
    std::vector<std::string> words;
    for (const auto& row : table) words.emplace_back(row.word);
    return *table.find(choice_or(key, std::string(table.word(fallback)), words));
  }
  /// Exactly `count` numbers (count 0: any number of them).
  std::vector<double> numbers(const std::string& key, std::size_t count, Bounds bounds = {}) const;
  /// Length of an array of tables ("stage" for [[stage]]); its members are read as "stage.0.key".
  std::size_t array_size(const std::string& key) const;

  /// A StartupError about a key's value, for checks across keys.
  [[noreturn]] void refuse(const std::string& key, const std::string& complaint) const;
  void refuse_unknown() const;
  /// Whatever stands in this table is for somebody else: it is no unknown key.
  void pass_over(const std::string& table) const;
  const std::string& name() const { return name_; }

 private:
  struct Document;
  std::unique_ptr<Document> document_;
  std::string name_;
};

}  // namespace telekerf
