// SPDX-License-Identifier: Apache-2.0
// Writing to standard output and error of a process that must go on whoever reads them: a reader that is gone
// or a full disk is no reason to end with the beam on.
#pragma once

#include <cstdio>
#include <string_view>

namespace telekerf {

/// At once, as it stands. What cannot be written is lost.
void write_text(std::FILE* to, std::string_view text) noexcept;
/// The same, and ends the line.
void write_line(std::FILE* to, std::string_view text) noexcept;

}  // namespace telekerf
