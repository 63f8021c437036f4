// SPDX-License-Identifier: Apache-2.0
// The version of the programs.
#pragma once

namespace telekerf {

extern const char* const kVersion;

}  // namespace telekerf
