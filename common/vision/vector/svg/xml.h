// SPDX-License-Identifier: Apache-2.0
// What SVG asks of XML beyond its elements: entities and namespaces.
#pragma once

#include <string>
#include <string_view>
#include <tl/expected.hpp>

namespace tinyxml2 {
class XMLElement;
}

namespace telekerf::vision {

/// The text with the entities that its DOCTYPE declares put in their places; the error is one sentence: they
/// make it larger than `max_bytes`, or are in another file.
tl::expected<std::string, std::string> with_entities(std::string text, std::size_t max_bytes);

inline constexpr std::string_view kBlanks = " \t\r\n\f";
/// Takes them off the beginning.
void skip_blanks(std::string_view& text);

/// A name without its prefix.
std::string_view local_name(std::string_view name);
/// The local name of an element of SVG, whatever its prefix; empty: of another namespace. Without any
/// declaration an element without a prefix is SVG.
std::string_view svg_name(const tinyxml2::XMLElement& e);

/// Whether the conditions of an element are met: it may ask for extensions, of which none is known, or for
/// one of several languages, of which English is.
bool is_met(const tinyxml2::XMLElement& e);

}  // namespace telekerf::vision
