// SPDX-License-Identifier: Apache-2.0
// What either motion does to picture and sharpness (thesis 7.2.2, figures 7.10 to 7.14).
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

namespace telekerf::experiments {

/// Normalised variance (eq. 155) over a raster of both axes.
struct SharpnessSurface {
  std::vector<double> magnification_m;
  std::vector<double> focus_m;
  std::vector<std::vector<double>> sharpness;  ///< [magnification][focus]
};
SharpnessSurface sharpness_surface(std::uint64_t seed, int magnifications, int focuses);

/// Writes figure-7.10.png and figure-7.11.png: one motor moves and the other stands still; figure-7.12.png,
/// whose CSV is the whole raster, figure-7.13.png, figure-7.14.png.
void draw_surface(std::uint64_t seed, const std::filesystem::path& folder);

}  // namespace telekerf::experiments
