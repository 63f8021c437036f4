// SPDX-License-Identifier: Apache-2.0
// tl::expected where there is no libexpected-dev (Debian 13): the standard's own, of C++23. CMake puts this folder
// on the include path there, and nowhere else.
#pragma once

#include <expected>

namespace tl {

using std::expected;    // NOLINT
using std::unexpected;  // NOLINT

}  // namespace tl
