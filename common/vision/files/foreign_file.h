// SPDX-License-Identifier: Apache-2.0
// What a file is that is neither picture nor drawing that can be read, by its first bytes.
#pragma once

#include <string>
#include <string_view>

namespace telekerf::vision {

/// What a file is, whatever its name says, and what to do: "a PDF document, which is not read; export it as
/// SVG, or as PNG". Empty: not known. `head`: the first bytes of the file, 64 do.
std::string what_a_file_is(std::string_view head);

/// The first lines of an ASCII DXF file: a group 0 SECTION, comments (999) before it or not.
bool looks_like_dxf(std::string_view head);

}  // namespace telekerf::vision
