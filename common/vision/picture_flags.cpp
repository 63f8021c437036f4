// SPDX-License-Identifier: Apache-2.0
#include "common/vision/picture_flags.h"

#include <fmt/format.h>

#include "common/runtime/startup_error.h"

namespace telekerf::vision {
namespace {

std::vector<Vec2> points_of(const char* flag, const std::vector<double>& numbers) {
  if (numbers.size() % 2 != 0) {
    throw usage_error(
        fmt::format("--{}: {} numbers are given; it takes X,Y or X,Y,X,Y and so on, two for a point", flag,
                    numbers.size()));
  }
  std::vector<Vec2> out;
  for (std::size_t i = 0; i < numbers.size(); i += 2) out.emplace_back(numbers[i], numbers[i + 1]);
  return out;
}

}  // namespace

void PictureFlags::add_parameters(Settings& settings) {
  const Bounds pixels{.min = 0, .max = 1e6, .unit = "pixels"};
  settings.add("at", at, 0, pixels,
               "X,Y: a pixel of the thing to be cut; more points X,Y,X,Y for more of it, or more things");
  settings.add("not", away, 0, pixels, "X,Y: a pixel that is none of it; more points likewise");
  settings.add("box", box, 4, pixels, "X,Y,WIDTH,HEIGHT: the thing to be cut lies within");
  settings.add("paper", paper, kPapers, "the sheet in the picture that says how large it is and how it lies");
  settings.add(
      "smallest_mm", smallest_mm, {.min = 1e-3, .max = 1e4, .unit = "mm"},
      "size of the smallest contour of a picture that counts; without it a twentieth of the largest");
  settings.add(
      "level", level, kLevels,
      "where borders lie on the way from background to drawing; without it half way, or where the picture is "
      "explained best");
}

void PictureFlags::apply_to(LoadRequest& request) const {
  request.pointing.at = points_of("at", at);
  request.pointing.away = points_of("not", away);
  if (!box.empty()) request.pointing.box = Eigen::Vector4d(box[0], box[1], box[2], box[3]);
  request.paper = paper;
  request.extraction.level = level;
  if (smallest_mm) request.smallest_m = 1e-3 * *smallest_mm;
  if (!away.empty() && !request.pointing.any())
    throw usage_error(
        "--not says what is none of the thing; --at X,Y or --box X,Y,WIDTH,HEIGHT must say where it is");
}

}  // namespace telekerf::vision
