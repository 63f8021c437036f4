// SPDX-License-Identifier: Apache-2.0
// The selectors of a style sheet: which elements a rule is for.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace tinyxml2 {
class XMLElement;
}

namespace telekerf::vision {

/// What one element is asked for: "rect.cut#a[fill]:first-child".
struct CompoundSelector {
  struct Attribute {
    std::string name;
    char how = 0;  ///< 0: there, '=', '~', '|', '^', '$', '*'
    std::string value;
  };
  struct Pseudo {
    std::string name;
    std::vector<CompoundSelector> inside;  ///< of :not and :is
    int step = 0;                          ///< of nth-child: step n + offset
    int offset = 1;
  };
  char combinator = ' ';  ///< to the one before: ' ', '>', '+', '~'
  std::string type;       ///< empty: any
  std::string id;
  bool two_ids = false;  ///< different ones: nothing matches
  std::vector<std::string> classes;
  std::vector<Attribute> attributes;
  std::vector<Pseudo> pseudos;
};

/// Compounds from left to right; the last one is the element.
struct Selector {
  std::vector<CompoundSelector> compounds;
  int specificity = 0;
};

/// Nothing where it asks for something that is not known, or is damaged.
std::optional<Selector> selector_of(std::string_view text);
bool matches(const Selector& selector, const tinyxml2::XMLElement& e);

}  // namespace telekerf::vision
