// SPDX-License-Identifier: Apache-2.0
// One direction of a profile at one stage, gathered from the tables of its file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "common/runtime/config.h"
#include "common/runtime/enum_table.h"

namespace telekerf::netem {

inline constexpr double kMillisecond_s = 1e-3;
inline constexpr Bounds kDelay_ms{0.0, 60'000.0};
inline constexpr Bounds kProbability{0.0, 1.0};

/// A key is sought in several tables, the most special one first: stage.1.forward, stage.1.both,
/// stage.0.forward, stage.0.both, forward, both. What is out of bounds or of another type throws
/// StartupError.
class Section {
 public:
  /// The file must outlive the section. The tables' names have a dot at their end.
  Section(const ConfigFile& file, std::string common, std::string special)
      : file_(file), tables_{std::move(common), std::move(special)} {}
  /// Two more tables override what was there.
  void override_by(std::string common, std::string special) {
    tables_.push_back(std::move(common));
    tables_.push_back(std::move(special));
  }

  double number(const std::string& key, double fallback, Bounds bounds) const;
  /// 0 stands for none, so that a stage can take away what was there before it.
  double number_or_none(const std::string& key, Bounds bounds) const;
  std::int64_t integer(const std::string& key, std::int64_t fallback, Bounds bounds) const;
  bool boolean(const std::string& key, bool fallback) const;
  std::string text(const std::string& key, std::string fallback) const;
  std::vector<double> numbers(const std::string& key, Bounds bounds) const;
  /// What one of the table's words stands for.
  template <typename Value>
  Value choice(const std::string& key, Value fallback, const EnumTable<Value>& table) const {
    std::vector<std::string> words;
    for (const auto& row : table) words.emplace_back(row.word);
    return *table.find(word(key, std::string(table.word(fallback)), words));
  }

  /// How special the table is that holds the key (0: most); as many as there are tables if none does.
  std::size_t rank(const std::string& key) const;
  bool has(const std::string& key) const { return rank(key) < tables_.size(); }

  [[noreturn]] void refuse(const std::string& key, const std::string& complaint) const;
  /// `key` needs `selector` to be something else than it is. A stage that overrides the selector may leave
  /// the keys of the old choice standing in the tables below it.
  void refuse_misplaced(const std::string& key, const std::string& selector,
                        const std::string& complaint) const;

 private:
  /// Tables that hold the key, the most special one last. Each table is asked once: a file may have
  /// thousands of stages.
  const std::vector<std::size_t>& holders(const std::string& key) const;
  std::vector<std::string> names(const std::string& key) const;
  std::string word(const std::string& key, std::string fallback, const std::vector<std::string>& words) const;

  struct Holders {
    std::vector<std::size_t> tables;
    std::size_t asked = 0;
  };

  const ConfigFile& file_;
  std::vector<std::string> tables_;  ///< the most special one last
  mutable std::map<std::string, Holders> holders_;
};

}  // namespace telekerf::netem
