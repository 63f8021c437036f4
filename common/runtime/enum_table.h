// SPDX-License-Identifier: Apache-2.0
// What a user calls by a word: one row for each choice, beside the type that the words stand for.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string_view>

namespace telekerf {

/// A choice: its word on command lines, in files and reports; what it stands for (an enumerator, or a
/// function that makes the thing); what it is, one sentence for help and reference.
template <typename Value>
struct EnumRow {
  std::string_view word;
  Value value;
  std::string_view sentence = {};
};

/// The rows of one registry:
///     inline constexpr EnumRow<Law> kLawRows[] = {{"anchored", Law::kAnchored, "the slave ..."}, ...};
///     inline constexpr EnumTable<Law> kLaws(kLawRows);
/// A new choice is one row. `Settings::add` takes such a table; nothing else needs to know the words.
template <typename Value>
class EnumTable {
 public:
  template <std::size_t N>
  explicit constexpr EnumTable(const EnumRow<Value> (&rows)[N]) : rows_(rows) {}

  constexpr std::span<const EnumRow<Value>> rows() const { return rows_; }
  constexpr auto begin() const { return rows_.begin(); }
  constexpr auto end() const { return rows_.end(); }

  constexpr std::optional<Value> find(std::string_view word) const {
    for (const auto& row : rows_) {
      if (row.word == word) return row.value;
    }
    return std::nullopt;
  }

  /// "unknown" of a value that has no row. Where two words stand for one value: the first of them.
  constexpr std::string_view word(const Value& value) const {
    for (const auto& row : rows_) {
      if (row.value == value) return row.word;
    }
    return "unknown";
  }

 private:
  std::span<const EnumRow<Value>> rows_;
};

}  // namespace telekerf
