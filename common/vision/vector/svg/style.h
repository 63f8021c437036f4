// SPDX-License-Identifier: Apache-2.0
// What an SVG element looks like, as far as it decides what is cut.
#pragma once

#include "common/vision/vector/drawn_lines.h"

namespace tinyxml2 {
class XMLElement;
}

namespace telekerf::vision {

/// By its own attributes; what hides it hides its children.
bool is_hidden(const tinyxml2::XMLElement& e);
/// Notes what changes the picture of an element that is followed all the same; what would move it fails the
/// drawing.
void note_effects(const tinyxml2::XMLElement& e, DrawnLines& out);
/// Notes the rules of a <style> element that would decide where and whether something is drawn.
void note_style_sheet(const tinyxml2::XMLElement& e, DrawnLines& out);

}  // namespace telekerf::vision
