// SPDX-License-Identifier: Apache-2.0
// Style sheets, style attributes and presentation attributes -> what holds for an element.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "common/vision/vector/svg/selector.h"

namespace telekerf::vision {

/// The properties of one element that decide where and whether it is drawn, as they are written.
using Properties = std::map<std::string, std::string, std::less<>>;

class Cascade {
 public:
  /// Rules of a style sheet, behind those of before.
  void add_sheet(std::string_view text);
  /// A rule that would decide where or whether something is drawn and cannot be followed; empty: none.
  const std::string& trouble() const { return trouble_; }

  /// The inline style before the sheets, these before the attributes; !important before all.
  Properties of(const tinyxml2::XMLElement& e) const;

 private:
  struct Declaration {
    std::string name;
    std::string value;
    bool important = false;
  };
  struct Rule {
    Selector selector;
    std::vector<Declaration> declarations;
  };
  static std::vector<Declaration> declarations_of(std::string_view text);
  void add_rules(std::string_view text, int depth);
  void add_rule(std::string_view prelude, std::string_view body);
  void add_at_rule(std::string_view prelude, std::string_view body, int depth);
  void complain(std::string_view prelude, std::string_view body);

  std::vector<Rule> rules_;
  std::map<std::string, std::vector<std::size_t>, std::less<>> by_key_;  ///< "#id", ".class", "type", "*"
  std::string trouble_;
};

}  // namespace telekerf::vision
