// SPDX-License-Identifier: Apache-2.0
// Bytes of a file -> text in UTF-8.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <tl/expected.hpp>

namespace telekerf::vision {

/// Without a byte-order mark; UTF-16 of either order, with a mark or without, becomes UTF-8. Other encodings
/// stay as they are: their letters for numbers are the same.
std::string utf8_of(std::string_view bytes);

/// The contents of a gzip file; other bytes come back as they are. The error is one sentence: damaged, or
/// more than `max_bytes`.
tl::expected<std::string, std::string> unzipped(std::string bytes, std::size_t max_bytes);

}  // namespace telekerf::vision
