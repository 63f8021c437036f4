// SPDX-License-Identifier: Apache-2.0
// Drawings that say their own size, as files -> polylines in metres.
#pragma once

#include <string>
#include <tl/expected.hpp>

#include "common/vision/vector/vector_drawing.h"

namespace telekerf::vision {

/// By the file's extension, .svg, .svgz or .dxf; every other file is none of these (`is_vector_file` says
/// so).
bool is_vector_file(const std::string& path);
tl::expected<VectorDrawing, std::string> read_vector_file(const std::string& path,
                                                          const VectorRequest& request = {},
                                                          const VectorLimits& limits = {});

}  // namespace telekerf::vision
