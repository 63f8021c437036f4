// SPDX-License-Identifier: Apache-2.0
#include "slave/vision/contour_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "common/runtime/refusal.h"
#include "common/runtime/resources.h"
#include "common/vision/extract.h"
#include "common/vision/scaling.h"

namespace telekerf::vision {

ContourMessage find_contour(const ContourRequest& request) {
  const std::string file = find_resource("pictures", request.image, ".png").string();
  ExtractSettings settings;
  const auto mode = mode_of(request.mode);
  if (!mode) throw Refusal(fmt::format("mode = {}: must be auto, outline, stroke or thesis", request.mode));
  settings.mode = *mode;
  const auto picture = read_picture(file);
  if (!picture) throw Refusal(fmt::format("{}: {}", file, picture.error()));
  const auto found = extract(picture->image, settings);
  if (!found) throw Refusal(fmt::format("{}: {}", file, found.error()));

  const PixelContour& contour = found->contours.front();
  ScaleRequest scaling;
  scaling.picture_width_m = request.width_m;
  scaling.workspace_radius_m = request.workspace_radius_m;
  const Scale scale = scale_for(contour, found->picture_width_px, found->picture_height_px, scaling);
  const geometry::Polyline line = to_workpiece(contour, scale);
  double reach_m = 0.0;
  for (const auto& point : line.points_m) reach_m = std::max(reach_m, point.norm());
  if (reach_m > request.workspace_radius_m) {
    throw Refusal(
        fmt::format("{}: the contour reaches {:.1f} mm from its centre, but the slave's workspace only "
                    "{:.1f} mm; use a smaller --width-mm",
                    file, reach_m * 1e3, request.workspace_radius_m * 1e3));
  }
  ContourMessage message;
  message.id = 1;
  message.closed = line.closed;
  message.source = std::filesystem::path(file).filename().string();
  message.mode = name_of(found->mode);
  message.metres_per_pixel = scale.metres_per_pixel;
  message.deviation_m = contour.noise_px * scale.metres_per_pixel;
  message.points_m = line.points_m;
  return message;
}

}  // namespace telekerf::vision
