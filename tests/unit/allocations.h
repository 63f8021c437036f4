// SPDX-License-Identifier: Apache-2.0
// Counts heap allocations of the whole program, those inside libraries included (sanitizer builds count
// nothing).
#pragma once

#include <cstdint>

namespace telekerf::testing {

/// Calls of malloc and operator new so far; constant 0 in a sanitizer build, which brings its own malloc.
std::uint64_t allocations() noexcept;
/// The same, of this thread.
std::uint64_t allocations_here() noexcept;

}  // namespace telekerf::testing
